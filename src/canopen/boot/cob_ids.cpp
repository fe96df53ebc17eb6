// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Identifiers of SYNC and EMCY as the predefined connection set has them: a drive that makes SYNC
// itself, or whose emergencies go elsewhere, would upset the bus or keep its faults to itself.
#include <algorithm>
#include <array>

#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

struct CobId {
  ObjectId object;
  const char* name;
  std::uint32_t switch_bit;  ///< must be put to `off` before the identifier may change
  bool off;
  std::uint32_t base;  ///< the identifier wanted
  bool plus_node;
};
constexpr std::array<CobId, 2> kCobIds{{
    {{0x1005, 0}, "COB-ID SYNC", 0x40000000, false, 0x80, false},  // bit 30: makes SYNC; 7.5.2.5
    {{0x1014, 0}, "COB-ID EMCY", 0x80000000, true, 0x80, true},    // bit 31: makes none; 7.5.2.15
}};
constexpr std::uint32_t kIdentifier = 0x3FFFFFFF;  // with the bit for 29-bit identifiers

class CobIds : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (boot.found.unchanged || item_ >= kCobIds.size()) return false;
    phase_ = Phase::reading;
    boot.read(row().object, row().name, now, boot.ifThere());
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (const auto resting = patience_.rest(boot, now)) return *resting;
    if (!boot.answered()) return Progress::waiting;
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    const bool settled = !boot.ok() || step(boot, now);
    if (!settled) return Progress::waiting;
    // What cannot be read is as the standard predefines it.
    if (!boot.ok() && phase_ != Phase::reading) {
      if (patience_.grant(boot, boot.ticket->abortCode(), now)) return Progress::waiting;
      return kept(boot);
    }
    ++item_;
    patience_.renew();
    return Progress::again;
  }

 private:
  enum class Phase { reading, switching_off, setting };

  const CobId& row() const { return kCobIds[item_]; }
  std::uint32_t wanted(const BootContext& boot) const {
    return row().base + (row().plus_node ? boot.config.node_id : 0U);
  }
  bool isOff() const { return ((value_ & row().switch_bit) != 0) == row().off; }
  bool isRight(const BootContext& boot) const {
    // EMCY is to be sent, SYNC is not, unless one of the drives is to make it.
    const bool in_use = row().plus_node ? !isOff() : isOff() || boot.external_sync;
    return in_use && (value_ & kIdentifier) == wanted(boot);
  }

  /// @return true if the object is as wanted.
  bool step(BootContext& boot, Time now) {
    switch (phase_) {
      case Phase::reading:
        value_ = boot.value();
        break;
      case Phase::switching_off:
        value_ ^= row().switch_bit;
        break;
      case Phase::setting:
        return true;
    }
    if (isRight(boot)) return true;
    phase_ = isOff() ? Phase::setting : Phase::switching_off;
    const std::uint32_t next = isOff() ? wanted(boot) : value_ ^ row().switch_bit;
    boot.write(row().object, toBytes(next, 4), row().name, now);
    return false;
  }

  /// The drive refuses to change it.
  Progress kept(BootContext& boot) {
    const std::string is = objectText(row().object, row().name) + " is " + hexText(value_, 8);
    const auto& pdos = boot.config.pdos;
    const bool needs_sync = std::any_of(pdos.begin(), pdos.end(), [](const PdoConfig& pdo) {
      return pdo.enabled && pdo.transmission <= 240;
    });
    if (row().plus_node) {
      boot.noteTransfer("its emergencies go unheard (" + is + ")");
    } else if (!isOff()) {
      return refuse(boot, "the drive makes SYNC itself (" + is + "), as the master does");
    } else if (needs_sync) {
      return refuse(boot, "the drive waits for another SYNC (" + is + ") than the master sends");
    }
    ++item_;
    return Progress::again;
  }

  static Progress refuse(BootContext& boot, const std::string& why) {
    return boot.fail(BootFailure::refused, "boot failed: " + why +
                                               ", and refuses to change that: " + boot.step + ": " +
                                               boot.ticket->reason());
  }

  Phase phase_ = Phase::reading;
  std::size_t item_ = 0;
  std::uint32_t value_ = 0;
  StatePatience patience_;
};

}  // namespace

BootStepPointer makeCobIds() { return std::make_unique<CobIds>(); }

}  // namespace cia402::canopen
