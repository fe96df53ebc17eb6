// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Leaves out what an earlier boot has configured, where the user asks for that and the drive can
// prove that it still holds it.
#include <algorithm>

#include "canopen/boot/signature.h"
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"

namespace cia402::canopen {
namespace {

constexpr ObjectId kDate{0x1020, 1}, kTime{0x1020, 2};  // CiA 301, 7.5.2.23
constexpr const char* kDateName = "configuration date";
constexpr const char* kTimeName = "configuration time";
constexpr std::uint32_t kCobIdMask = 0x9FFFFFFF;  // bit 30 (RTR) is the drive's choice
constexpr std::uint32_t kAll = 0xFFFFFFFF;

/// An object that shows cheaply whether the drive lost its configuration but kept 1020h.
struct Sample {
  ObjectId object;
  const char* name;
  std::uint32_t value, mask;
};

std::vector<Sample> samples(const NodeConfig& config) {
  std::vector<Sample> all;
  if (config.sync_period_us) {
    all.push_back({{0x1006, 0}, "communication cycle period", *config.sync_period_us, kAll});
  }
  for (const PdoConfig& pdo : config.pdos) {
    if (!pdo.enabled) continue;
    const bool tpdo = pdo.direction == PdoDirection::tpdo;
    const auto communication =
        static_cast<std::uint16_t>((tpdo ? 0x1800U : 0x1400U) + pdo.number - 1);
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200U);
    all.push_back({{communication, 1}, "COB-ID of a PDO", pdo.cob_id, kCobIdMask});
    all.push_back({{communication, 2}, "transmission type of a PDO", pdo.transmission, kAll});
    all.push_back({{mapping, 0},
                   "number of mapped objects",
                   static_cast<std::uint32_t>(pdo.entries.size()),
                   kAll});
  }
  return all;
}

/// Reads 1020h and the samples; where anything speaks against it, 1020h is put to 0 before the
/// configuration begins, so that a boot that is cut short leaves no false proof behind.
class UnchangedCheck : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (boot.config.boot.check == ConfigurationCheck::none) return false;
    switch (phase_) {
      case Phase::date:
        wanted_ = configurationSignature(boot.config, *boot.found.identity, boot.external_sync);
        samples_ = samples(boot.config);
        boot.read(kDate, kDateName, now);
        return true;
      case Phase::time:
        boot.read(kTime, kTimeName, now);
        return true;
      case Phase::sample:
        if (item_ < samples_.size()) {
          boot.read(samples_[item_].object, samples_[item_].name, now);
          return true;
        }
        boot.found.unchanged = true;
        boot.remarks.emplace_back(
            "its configuration is unchanged (1020h) and was not written again");
        return false;
      case Phase::void_date:
        boot.write(kDate, toBytes(0, 4), kDateName, now);
        return true;
      case Phase::void_time:
        boot.write(kTime, toBytes(0, 4), kTimeName, now);
        return true;
    }
    return false;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    switch (phase_) {
      case Phase::date:
        return takeDate(boot);
      case Phase::time:
        return takeTime(boot);
      case Phase::sample:
        return takeSample(boot);
      case Phase::void_date:
        phase_ = Phase::void_time;
        return Progress::again;
      case Phase::void_time:
        break;
    }
    return Progress::next;
  }

 private:
  enum class Phase { date, time, sample, void_date, void_time };

  Progress takeDate(BootContext& boot) {
    if (!boot.ok()) {
      boot.noteTransfer("its configuration cannot be proved unchanged and is written at each boot");
      return Progress::next;
    }
    boot.found.has_signature = true;
    date_ = boot.value();
    phase_ = Phase::time;
    return Progress::again;
  }

  Progress takeTime(BootContext& boot) {
    const std::uint32_t time = boot.ok() ? boot.value() : 0;
    if (date_ == 0 && time == 0) return Progress::next;
    const bool same = date_ == wanted_.date && time == wanted_.time;
    phase_ = Phase::void_date;
    if (!same || boot.must_configure) return Progress::again;
    phase_ = Phase::sample;
    const auto& pdos = boot.config.pdos;
    if (std::any_of(pdos.begin(), pdos.end(),
                    [](const PdoConfig& pdo) { return pdo.enabled && pdo.cob_id == 0; })) {
      boot.remarks.emplace_back(
          "its PDOs are asked for at each boot, as their COB-IDs are its own");
      phase_ = Phase::void_date;
      return Progress::again;
    }
    if (boot.found.error_control_differed) {
      return configureAfterAll(boot, "its error control objects were not as configured");
    }
    return Progress::again;
  }

  Progress takeSample(BootContext& boot) {
    const Sample& sample = samples_[item_++];
    if (boot.ok() && (boot.value() & sample.mask) == sample.value) return Progress::again;
    const std::string is = boot.ok() ? "is " + valueText(boot.ticket->data())
                                     : "cannot be read (" + boot.ticket->reason() + ")";
    return configureAfterAll(boot, objectText(sample.object, sample.name) + " " + is);
  }

  Progress configureAfterAll(BootContext& boot, const std::string& why) {
    boot.notes.push_back("1020h says that its configuration is unchanged, but " + why +
                         ": it lost its configuration and kept 1020h, and is configured again; "
                         "save its parameters (1010h), or leave out `configuration_check`");
    phase_ = Phase::void_date;
    return Progress::again;
  }

  Phase phase_ = Phase::date;
  ConfigurationSignature wanted_;
  std::vector<Sample> samples_;
  std::size_t item_ = 0;
  std::uint32_t date_ = 0;
};

/// Leaves the proof behind, once everything is configured.
class Signature : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    boot.must_configure = false;
    if (!boot.found.has_signature || boot.found.unchanged || item_ > 1) return false;
    const ConfigurationSignature signature =
        configurationSignature(boot.config, *boot.found.identity, boot.external_sync);
    boot.write(item_ == 0 ? kDate : kTime, toBytes(item_ == 0 ? signature.date : signature.time, 4),
               item_ == 0 ? kDateName : kTimeName, now);
    return true;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    ++item_;
    if (boot.ok()) return Progress::again;
    if (!boot.refused()) return boot.failTransfer();
    boot.noteTransfer("its configuration will be written again at the next boot");
    return Progress::next;
  }

 private:
  unsigned item_ = 0;
};

}  // namespace

BootStepPointer makeUnchangedCheck() { return std::make_unique<UnchangedCheck>(); }
BootStepPointer makeSignature() { return std::make_unique<Signature>(); }

}  // namespace cia402::canopen
