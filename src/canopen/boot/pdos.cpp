// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// PDO by PDO: first those that nobody configured are found disabled, then the configured ones.
#include <algorithm>
#include <array>
#include <cstdio>

#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "canopen/pdo/configurator.h"

namespace cia402::canopen {
namespace {

constexpr std::uint8_t kHalfBits = 16;
constexpr unsigned kProbedPdos = 4;  // of each direction, looked at though not configured

std::vector<PdoConfig> withUnlistedDisabled(const std::vector<PdoConfig>& wanted) {
  std::vector<PdoConfig> all;
  for (const PdoDirection direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    for (unsigned number = 1; number <= kProbedPdos; ++number) {
      const bool listed = std::any_of(wanted.begin(), wanted.end(), [&](const PdoConfig& pdo) {
        return pdo.direction == direction && pdo.number == number;
      });
      if (listed) continue;
      PdoConfig unlisted;
      unlisted.direction = direction;
      unlisted.number = number;
      unlisted.enabled = false;
      all.push_back(std::move(unlisted));
    }
  }
  all.insert(all.end(), wanted.begin(), wanted.end());
  return all;
}

/// With the widths that the drive at hand has its floats in.
PdoConfig halved(PdoConfig pdo, const HalfFloats& halves) {
  for (PdoEntry& entry : pdo.entries) {
    if (halves.has(entry.object)) entry.bits = kHalfBits;
  }
  return pdo;
}

/// What the drive holds in more bits travels in so many.
void widen(PdoConfig& pdo, const std::vector<LearnedWidth>& widths) {
  for (PdoEntry& entry : pdo.entries) {
    for (const LearnedWidth& width : widths) {
      if (entry.object == width.object) entry.bits = static_cast<std::uint8_t>(8 * width.actual);
    }
  }
}

class Pdos : public BootStep {
 public:
  explicit Pdos(const NodeConfig& config) : pdos_(withUnlistedDisabled(config.pdos)) {}

  bool begin(BootContext& boot, Time) override {
    if (boot.found.unchanged || item_ >= pdos_.size()) return false;
    widen(pdos_[item_], boot.found.widths);
    const PdoConfig wanted = halved(pdos_[item_], boot.sdo.halfFloats());
    PdoConfigurator::Options options;
    options.count_may_be_read_only = boot.config.map_count_may_be_read_only;
    options.fixed_entries = boot.config.fixed_map_entries;
    options.may_be_missing = !wanted.enabled;
    options.if_there = boot.ifThere();
    pdo_.emplace(boot.sdo, wanted, options);
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (const auto resting = patience_.rest(boot, now)) return *resting;
    const std::string before = pdo_->step();
    const PdoConfigurator::Status status = pdo_->advance();
    boot.step = pdo_->step();
    switch (status) {
      case PdoConfigurator::Status::running:
        if (boot.step != before) boot.submit(now);
        return Progress::waiting;
      case PdoConfigurator::Status::done:
        adoptCobId(boot);
        leaveOut(boot);
        if (pdo_->changed()) patience_.renew();
        ++item_;
        return Progress::again;
      case PdoConfigurator::Status::failed:
        break;
    }
    if (patience_.grant(boot, pdo_->abortCode(), now)) return Progress::waiting;
    if (pdos_[item_].enabled || pdo_->timedOut()) {
      return boot.fail(
          pdo_->timedOut() ? BootFailure::timed_out : BootFailure::refused,
          "boot failed: " + pdo_->error() + (pdo_->timedOut() ? boot.muteText() : std::string()));
    }
    boot.notes.push_back("a PDO that is not configured could not be disabled: " + pdo_->error());
    ++item_;
    return Progress::again;
  }

 private:
  void leaveOut(BootContext& boot) const {
    const PdoConfig& pdo = pdos_[item_];
    for (const PdoEntry& entry : pdo_->leftOut()) {
      boot.found.left_out.push_back({pdo.direction, pdo.number, entry.object});
      const std::string object = objectText(entry.object, entry.name);
      if (entry.if_room) {
        boot.remarks.push_back("the drive does not take " + object + " into a TPDO");
      } else {
        boot.found.lacking.push_back(object);
      }
    }
  }

  void adoptCobId(BootContext& boot) const {
    const std::optional<std::uint16_t> cob_id = pdo_->adoptedCobId();
    if (!cob_id) return;
    const PdoConfig& pdo = pdos_[item_];
    boot.found.cob_ids.push_back({pdo.direction, pdo.number, *cob_id});
    if (pdo.cob_id == 0) return;  // asked for
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(),
                  "%s %u has the COB-ID 0x%03X that the drive insists on, instead of 0x%03X",
                  pdo.direction == PdoDirection::tpdo ? "TPDO" : "RPDO", pdo.number,
                  unsigned{*cob_id}, unsigned{pdo.cob_id});
    boot.notes.emplace_back(text.data());
  }

  std::vector<PdoConfig> pdos_;
  std::size_t item_ = 0;
  std::optional<PdoConfigurator> pdo_;
  StatePatience patience_;
};

}  // namespace

BootStepPointer makePdos(const NodeConfig& config) { return std::make_unique<Pdos>(config); }

}  // namespace cia402::canopen
