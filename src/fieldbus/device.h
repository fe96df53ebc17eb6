// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cia402_driver/common/time.h"
#include "fieldbus/emergency.h"
#include "fieldbus/object_access.h"
#include "fieldbus/process_image.h"
#include "fieldbus/terms.h"

namespace cia402::fieldbus {

/// Health of a device as the driver sees it.
enum class Health : std::uint8_t {
  absent,   ///< never heard of, or boot timed out
  booting,  ///< identified and configured at the moment; bootStep() says how far
  ready,    ///< configured and started (operational)
  failed,   ///< boot failed, or commanded out of operation; problem() says why; boot() tries again
  lost,     ///< what shows that it is there is missing
};
/// "absent", "booting", ...: the enumerators' own names.
const char* toString(Health health);
/// Nobody answers.
constexpr bool isAway(Health health) { return health == Health::absent || health == Health::lost; }

/// How long a device may take.
struct DeviceTimes {
  Duration boot{std::chrono::seconds(5)};  ///< from a reset until it answers
  AccessOptions access;                    ///< of transfers that are asked for without options
  /// The longest that such a transfer takes.
  Duration transfer() const { return (access.retries + 1) * access.timeout; }
};

/// What an axis needs of the device that it sits in, and all that it knows of it: an axis does not
/// ask which bus this is. Owned by the bus' master; one thread.
class Device {
 public:
  virtual ~Device() = default;

  Health health() const { return front_->health; }
  bool ready() const { return front_->health == Health::ready; }
  /// Starts of the device seen since the driver started. A change tells that the device lost its
  /// configuration.
  std::uint32_t bootUps() const { return front_->boot_ups; }
  /// Grows with everything that is new of the device but what its process data bring.
  std::uint32_t changes() const { return front_->changes; }
  ProcessImage& image() { return *front_->process; }
  const ProcessImage& image() const { return *front_->process; }

  /// Step of the boot procedure in words: "reading 1018:01 vendor id", "waiting for boot-up".
  virtual const std::string& bootStep() const = 0;
  /// Why the boot failed or the device was lost, and what to do; empty when healthy.
  virtual const std::string& problem() const = 0;
  virtual DeviceTimes times() const = 0;
  virtual const std::optional<Emergency>& lastEmergency() const = 0;
  /// Without signs of life of this driver it stops by itself, as found at the present or last boot.
  virtual bool noticesLostMaster() const = 0;
  /// Its boot comes first to motors that somebody else may have left turning, and is not done with
  /// them. Not while it is not known whether it is there at all, but for the first question.
  virtual bool seesToMotors() const = 0;
  /// It is away, and the configuration says that it may be.
  virtual bool excused() const = 0;

  /// To be used at once, not kept: the device looks at its transfers' deadlines anew after each
  /// call.
  virtual ObjectAccess& objects() = 0;

  /// (Re)starts the boot procedure: identify, configure, start. @param reset the device's
  /// communication first
  virtual void boot(Time now, bool reset) = 0;
  /// Has the device start anew, so that parameters that it holds in its memory take effect.
  virtual void restart(Time now) = 0;
  /// What of that cannot be done, and what the user has to do instead: "only its communication was
  /// reset (nmt_reset_node of the profile): switch it off and on"; empty: nothing.
  virtual std::string restartGap() const = 0;
  /// Takes a device that is ready out of operation and, after `stopped`, into it again. It stays
  /// ready, with the configuration that it has; where it does not start again within kStartPatience
  /// it is booted.
  virtual void stopAndStart(Duration stopped, Time now) = 0;
  /// That is under way.
  virtual bool paused() const = 0;
  static constexpr Duration kStartPatience{std::chrono::seconds(1)};

  // In words, made on demand:
  virtual const Terms& terms() const = 0;
  /// Why the device cannot be asked for `what`, e.g. "6041:00 statusword", as it is now, and what
  /// to do; empty if it can.
  virtual std::string askingRefusal(const std::string& what) const = 0;
  /// What of the inputs is overdue: "TPDO 1 (COB-ID 0x183) did not come for 11 cycles"; empty if
  /// nothing is.
  virtual std::string overdueText() const = 0;
  /// The same without numbers that grow, and with what comes but cannot be used: "TPDO 1 (COB-ID
  /// 0x183) does not come"; empty if nothing is.
  virtual std::string missingText() const = 0;
  /// What carries an output: "RPDO 1 (COB-ID 0x203)".
  virtual std::string carrierText(Slot output) const = 0;

 protected:
  /// What every cycle looks at; where it lies the device knows.
  struct Front {
    Health health = Health::absent;
    std::uint32_t boot_ups = 0, changes = 1;
    ProcessImage* process = nullptr;
  };
  explicit Device(const Front& front) : front_(&front) {}
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;

 private:
  const Front* front_;
};

}  // namespace cia402::fieldbus
