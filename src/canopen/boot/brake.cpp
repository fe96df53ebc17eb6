// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that still turns its motor as a driver has told it that is gone: it is stopped before all
// else. Where its stop would only let the motor go, another mode takes the motor over at its
// velocity first, in which the stop ramps.
#include <algorithm>
#include <utility>
#include <vector>

#include "canopen/boot/steps.h"

namespace cia402::canopen {
namespace {

constexpr Duration kAnswer = std::chrono::milliseconds(300);  // it may as well be off
constexpr int kRetries = 2;                                   // once it is known to be there
constexpr Duration kQuick = std::chrono::milliseconds(100);   // for one that answers in half of it
constexpr int kQuickRetries = 5;                              // in as long as the others' two
constexpr Duration kPatience = std::chrono::milliseconds(100);  // for the mode to be shown
constexpr Duration kRamp = std::chrono::seconds(2);             // for the motors to rest
constexpr Duration kSign = std::chrono::milliseconds(50);       // of one that was silent
constexpr Duration kInterval = std::chrono::milliseconds(10);   // of questions meanwhile
// CiA 402-2, state coding
constexpr std::uint32_t kStateMask = 0x6F, kOperationEnabled = 0x27, kQuickStopActive = 0x07;
constexpr std::uint32_t kFaultMask = 0x4F, kFaultReactionActive = 0x0F;
// What an RPDO has left in the drive takes effect with the next SYNC, and is not to undo this.
constexpr int kSyncs = 2;

/// Ends with the NMT command that this boot would have begun with. What is refused or not answered
/// leaves the motor to the stop that each boot writes.
class Brake : public BootStep {
 public:
  /// @param identified it is known to be there, and of which maker it is
  explicit Brake(bool identified) : identified_(identified), known_(identified) {}

  bool begin(BootContext& boot, Time now) override {
    const bool due = identified_ ? !boot.found.braked : boot.braking;
    if (!due && !begun_) return false;
    boot.deadline = kNever;
    if (!std::exchange(begun_, true) && !identified_) fresh_from_ = now + kSyncs * boot.sync_period;
    options_ = boot.config.sdo;
    options_.retries = boot.found.braked ? retries() : 0;
    options_.timeout = std::min(options_.timeout, quick_ || asked_again_ > 0 ? kQuick : kAnswer);
    if (boot.stopped_before && !identified_) item_ = boot.config.brakes.size();
    if (item_ < boot.config.brakes.size()) return readStatus(boot, item_, Phase::state, now);
    if (!turning_.empty() && (stop(boot, now) || rest(boot, now))) return true;
    if (identified_) return false;
    if (stopUnasked(boot, now)) return true;
    end(boot, now);
    return false;
  }

  Progress check(BootContext& boot, Time now) override {
    if (phase_ == Phase::wait) return readVelocity(boot, now);
    if (phase_ == Phase::unasked) return awaitSign(boot, now);
    if (!boot.answered()) return Progress::waiting;
    if (phase_ == Phase::stop) return Progress::again;
    const bool usable =
        boot.ok() && !boot.ticket->data().empty() && boot.ticket->data().size() <= 8;
    if (phase_ == Phase::rest) return usable ? watch(boot, now) : leave();
    if (!usable && asksAgain(boot)) return Progress::again;
    if (usable && follow(boot, now)) return Progress::waiting;
    ++item_;
    return Progress::again;
  }

 private:
  enum class Phase {
    state,
    vendor,
    mode,
    wait,
    velocity,
    target,
    command,
    shown,
    stop,
    rest,
    unasked
  };

  static bool isThere(const BootFindings& found) {
    return found.tpdo_heard || (found.heartbeat_heard && !isMute(found));
  }
  static bool isMute(const BootFindings& found) {
    return found.heartbeat_heard && found.heartbeat_state == NmtState::stopped;
  }

  /// It is there, as its heartbeat or a TPDO says: the question, or its answer, was lost.
  bool asksAgain(const BootContext& boot) {
    const bool lost = boot.ticket->failure() == fieldbus::Transfer::Failure::timed_out;
    const bool there = isThere(boot.found) || (boot.found.appeared && !isMute(boot.found));
    return phase_ == Phase::state && lost && there && asked_again_++ < kQuickRetries;
  }

  /// One that answered nothing may be there since a moment ago: it is told once to stop, and has
  /// time to do that before a reset would make it forget the request.
  bool stopUnasked(BootContext& boot, Time now) {
    const bool known = !boot.config.vendor_id || boot.vendor_known;
    const bool in_vain = !boot.found.braked && !boot.stopped_before && !isThere(boot.found);
    if (!in_vain || !known || boot.config.brakes.empty()) return false;
    if (!std::exchange(boot.stops_unasked, false)) return false;
    for (const StartupWrite& write : boot.config.writes) {
      if (write.always) boot.sdo.post(write.object, write.data);
    }
    phase_ = Phase::unasked;
    boot.deadline = now + kSign;
    return true;
  }
  Progress awaitSign(BootContext& boot, Time now) {
    const bool there = isThere(boot.found);
    if (!there && now < boot.deadline) return Progress::waiting;
    if (there) item_ = 0;
    return Progress::again;
  }

  /// Of all axes. @return false: nothing is left of it
  bool stop(BootContext& boot, Time now) {
    const std::vector<StartupWrite>& writes = boot.config.writes;
    while (stop_ < writes.size() && !writes[stop_].always) ++stop_;
    if (stop_ >= writes.size()) return false;
    phase_ = Phase::stop;
    write(boot, writes[stop_].object, writes[stop_].data, writes[stop_].name.c_str(), now);
    ++stop_;
    return true;
  }

  /// Until the ramp is over nothing else is written, and no other mode travels.
  bool rest(BootContext& boot, Time now) {
    if (rests_until_ == Time{}) rests_until_ = now + kRamp;
    if (now >= rests_until_) return false;
    next_question_ = now + kInterval;
    return readStatus(boot, turning_.back(), Phase::rest, now);
  }
  Progress watch(BootContext& boot, Time now) {
    if (enabled(statusword(boot)) && !stopped_again_ && now >= fresh_from_) {
      stopped_again_ = true;
      stop_ = 0;
      return Progress::again;
    }
    if (!powered(statusword(boot))) return leave();
    if (now >= next_question_) return Progress::again;
    boot.deadline = next_question_;
    return Progress::waiting;
  }
  /// The last of those that turn: it rests, or tells nothing.
  Progress leave() {
    turning_.pop_back();
    return Progress::again;
  }

  static void end(BootContext& boot, Time now) {
    boot.braking = false;
    if (boot.reset_when_braked) {
      boot.reset_command = NmtCommand::reset_communication;
      boot.command(boot.reset_command, now);
      boot.awaitReset(now);
    } else {
      boot.command(NmtCommand::enter_pre_operational, now);
    }
  }

  const BootBrake& brake(const BootContext& boot) const { return boot.config.brakes[item_]; }
  void read(BootContext& boot, ObjectId object, const char* name, Time now) {
    boot.read(object, name, now, options_);
  }
  void write(BootContext& boot, ObjectId object, Bytes data, const char* name, Time now) {
    boot.write(object, std::move(data), name, now, options_);
  }
  bool readStatus(BootContext& boot, std::size_t of, Phase phase, Time now) {
    phase_ = phase;
    read(boot, boot.config.brakes[of].statusword, "statusword", now);
    return true;
  }
  static std::uint64_t statusword(const BootContext& boot) {
    return fieldbus::toUnsigned(boot.ticket->data());
  }
  static bool enabled(std::uint64_t statusword) {
    return (statusword & kStateMask) == kOperationEnabled;
  }
  static bool powered(std::uint64_t statusword) {
    return enabled(statusword) || (statusword & kStateMask) == kQuickStopActive ||
           (statusword & kFaultMask) == kFaultReactionActive;
  }
  Progress readVelocity(BootContext& boot, Time now) {
    if (now < fresh_from_) return Progress::waiting;
    boot.deadline = kNever;
    phase_ = Phase::velocity;
    read(boot, brake(boot).velocity, "velocity", now);
    return Progress::waiting;
  }
  static int modeIn(const Bytes& data) { return static_cast<std::int8_t>(data.front()); }

  /// @return false: nothing more is to be done before the stop
  bool follow(BootContext& boot, Time now) {
    const Bytes& data = boot.ticket->data();
    switch (phase_) {
      case Phase::state:
        boot.found.braked = true;
        quick_ = now - boot.asked <= kQuick / 2;
        if (quick_) options_.timeout = std::min(options_.timeout, kQuick);
        enabled_ = enabled(statusword(boot));
        if (!powered(statusword(boot))) return false;
        options_.retries = retries();
        known_ = known_ || boot.vendor_known;
        if (!boot.config.vendor_id || known_) return isTurning(boot, now);
        phase_ = Phase::vendor;
        read(boot, {0x1018, 1}, "vendor id", now);
        return true;
      case Phase::vendor:  // nothing is written to the drive of another maker
        known_ = fieldbus::toUnsigned(data) == *boot.config.vendor_id;
        return known_ && isTurning(boot, now);
      case Phase::mode: {
        const std::vector<int>& pushing = brake(boot).pushing;
        if (std::find(pushing.begin(), pushing.end(), modeIn(data)) == pushing.end()) return false;
        mode_bytes_ = static_cast<unsigned>(data.size());
        phase_ = Phase::wait;
        boot.deadline = std::max(now, fresh_from_);
        return true;
      }
      case Phase::velocity:
        phase_ = Phase::target;
        write(boot, brake(boot).target, data, "target of the mode that brakes", now);
        return true;
      case Phase::target:
        phase_ = Phase::command;
        deadline_ = now + kPatience;
        write(boot, brake(boot).mode,
              fieldbus::toBytes(static_cast<std::uint64_t>(brake(boot).brake), mode_bytes_),
              "mode that brakes", now);
        return true;
      case Phase::command:
        phase_ = Phase::shown;
        break;
      case Phase::shown:
        if (modeIn(data) == brake(boot).brake || now >= deadline_) return false;
        break;
      case Phase::wait:
      case Phase::stop:
      case Phase::rest:
      case Phase::unasked:
        return false;
    }
    read(boot, brake(boot).shown_mode, "mode display", now);
    return true;
  }

  bool isTurning(BootContext& boot, Time now) {
    turning_.push_back(item_);
    if (brake(boot).pushing.empty() || !enabled_) return false;
    phase_ = Phase::mode;
    read(boot, brake(boot).shown_mode, "mode display", now);
    return true;
  }

  int retries() const { return quick_ ? kQuickRetries : kRetries; }

  std::size_t item_ = 0, stop_ = 0;
  int asked_again_ = 0;               ///< for a state, of all axes
  std::vector<std::size_t> turning_;  ///< of BootBrakes: their motors have power
  bool quick_ = false;                ///< it has answered soon
  const bool identified_;
  bool begun_ = false;
  bool known_;
  bool enabled_ = false;  ///< `item_` is
  bool stopped_again_ = false;
  Phase phase_ = Phase::state;
  SdoOptions options_;
  unsigned mode_bytes_ = 1;
  Time fresh_from_{}, deadline_{}, rests_until_{}, next_question_{};
};

}  // namespace

BootStepPointer makeBrake(bool identified) { return std::make_unique<Brake>(identified); }

}  // namespace cia402::canopen
