// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "cia402_driver/common/result.h"
#include "drive/axis/config.h"
#include "drive/axis/notices.h"
#include "drive/axis/set_point.h"
#include "drive/axis/state_machine.h"
#include "drive/modes/stream.h"
#include "fieldbus/device.h"

namespace cia402::drive {

/// Long operations of an axis; each an explicit state machine with a deadline.
enum class ProcedureKind : std::uint8_t {
  none,
  enable,           ///< into operation with target := actual; releases a halt if enabled already
  disable,          ///< power stage off; a moving axis is quick-stopped first
  home,             ///< by the drive or by declaring; ends enabled in the mode from before
  clear_faults,     ///< one edge of the fault reset bit; the axis stays disabled
  recover,          ///< boot the device if needed, clear faults, enable; leaves enabled axes alone
  quick_stop,       ///< ends disabled, or holding where the drive does (605Ah, quick_stop_holds)
  halt,             ///< stop and stay enabled until `enable` releases it
  set_mode,         ///< disabled, or enabled at standstill
  set_position,     ///< declare the present position; an offset in software, at standstill
  save_parameters,  ///< 1010h, while disabled
  restore_parameters,  ///< 1011h, while disabled; resets the device, which is configured again
};
const char* toString(ProcedureKind kind);
/// Does it bring the axis to rest, so that it may interrupt another one?
constexpr bool stops(ProcedureKind kind) {
  return kind == ProcedureKind::disable || kind == ProcedureKind::quick_stop ||
         kind == ProcedureKind::halt;
}
/// Does it switch the power stage on, or may it?
constexpr bool enables(ProcedureKind kind) {
  return kind == ProcedureKind::enable || kind == ProcedureKind::home ||
         kind == ProcedureKind::recover || kind == ProcedureKind::set_mode;
}

/// What a procedure is doing, for diagnostics, service answers and action feedback alike.
struct ProcedureStatus {
  ProcedureKind kind = ProcedureKind::none;
  std::uint32_t id = 0;  ///< grows with every procedure started on the axis
  bool running = false;
  bool success = false;     ///< valid once not running
  std::string step;         ///< "switching on"
  std::string waiting_for;  ///< "statusword to show operation enabled"
  std::string message;      ///< the result as a sentence, once not running
  bool remark = false;      ///< a success of which the message says more than that it is done
  Time started{}, deadline{};
};

/// What is asked of an axis.
struct ProcedureRequest {
  ProcedureKind kind = ProcedureKind::none;
  std::string mode;        ///< set_mode: canonical name
  double position = 0.0;   ///< set_position: joint value the present position shall have
  bool confirmed = false;  ///< restore_parameters: what is lost by it is known
};

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What of an axis' state is one of few or yes and no, and changes seldom. Whoever tells of changes
/// compares all of it in every cycle, so it is two words without a gap.
struct AxisCondition {
  State state = State::unknown;
  fieldbus::Health health = fieldbus::Health::absent;
  std::uint16_t statusword = 0;
  std::uint16_t error_code = 0;  ///< of the fault, the warning, an emergency not ended; 0: none
  std::int16_t mode_value = 0;   ///< 6061h
  bool feedback_valid = false;
  bool homed = false;
  bool target_reached = false;
  bool warning = false;
  bool internal_limit = false;
  bool halted = false;            ///< enabled, and takes no command until `enable` releases it
  bool ready_for_motion = false;  ///< operation enabled, mode active, brake released, no procedure
  bool digital_inputs_valid = false;  ///< false: not received, or not in time
};
static_assert(sizeof(AxisCondition) == 16 &&
                  std::has_unique_object_representations_v<AxisCondition>,
              "whatever it holds is compared");
inline bool operator==(const AxisCondition& a, const AxisCondition& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
inline bool operator!=(const AxisCondition& a, const AxisCondition& b) { return !(a == b); }

/// Feedback and condition of an axis after the last update. Plain values, cheap to copy; texts are
/// made on demand by Axis.
struct AxisState : AxisCondition {
  Time stamp{};                       ///< when the feedback was on the wire
  double position = kUnknown;         ///< rad or m
  double velocity = kUnknown;         ///< rad/s or m/s
  double effort = kUnknown;           ///< N m or N
  double following_error = kUnknown;  ///< commanded minus measured position, rad or m
  const ModeSpec* mode = nullptr;     ///< active mode, nullptr while unknown
  std::uint32_t zero_changes = 0;    ///< grows when positions get another zero: older ones are void
  std::uint32_t digital_inputs = 0;  ///< 60FDh

  /// When each value was on the wire, or its answer taken; of a value that is unknown it says
  /// nothing.
  struct Stamps {
    Time velocity{}, effort{}, following_error{}, mode{}, digital_inputs{};
  } stamps;
};

/// A value of the drive that its profile names to be shown (`signals`): inputs, probes, voltages,
/// temperatures.
struct ShownSignal {
  const ObjectSpec* object = nullptr;  ///< nullptr: the drive has no such object
  bool known = false;                  ///< false: it has not come, or is too old
  std::uint64_t raw = 0;               ///< as it is on the wire, zero-extended
  Time stamp{};                        ///< when it was on the wire, or its answer taken
};

/// One CiA 402 axis in a device: decodes feedback, drives the state machine, runs procedures,
/// encodes set-points. Sans-IO; after construction the cyclic calls do not allocate (procedures
/// may, when a step ends).
class Axis {
 public:
  /// @throws std::invalid_argument if the configuration lacks what it was validated for.
  Axis(AxisConfig config, fieldbus::Device& device);
  ~Axis();
  Axis(Axis&&) noexcept;

  const AxisConfig& config() const;
  fieldbus::Device& device();
  const AxisState& state() const { return *shown_.state; }
  const ProcedureStatus& procedure() const { return *shown_.procedure; }
  /// The one before; ended, e.g. because disable, quick_stop or halt pre-empted it.
  const ProcedureStatus& previousProcedure() const;

  /// Decodes the device's process image. Call after the inputs of a cycle have come.
  void readFeedback(Time now);
  /// Somebody is about to look at values that are only shown (the following error, the profile's
  /// `signals`): where they do not come in the cycle, each look has them read once more.
  void look();
  /// Those of the profile's `signals`, in its order. Allocates.
  std::vector<ShownSignal> signals(Time now) const;
  /// Advances state machine and procedures. Call after readFeedback() and in each cycle; also when
  /// an answer came beside the cycle, to hurry procedures along.
  void update(Time now);
  /// Encodes controlword and targets into the process image. Call before the outputs of a cycle
  /// leave.
  void writeCommands(Time now);

  /// The joint's position in rad or m by an object other than the actual position that counts as it
  /// does, e.g. one that a touch probe has stored; of a joint that turns without end the place
  /// nearest to where it is. NaN where it cannot be converted.
  double positionBy(const ObjectSpec& object, std::uint64_t raw) const;

  /// The newest feedback is as new as it can be; false: some that was due has failed to come.
  bool heardLately(Time now) const;
  /// Is not known to stand. Without feedback one that stood without power still does.
  bool mayMove() const;
  /// Somebody else may have left it turning, and its device's boot is to stop it first of all.
  bool beingFound() const;
  /// Starts a procedure. disable, quick_stop and halt pre-empt a running one; anything else is
  /// refused with a sentence while one runs or where the axis cannot do it.
  Result<std::uint32_t> start(const ProcedureRequest& request, Time now);
  /// Why start() would refuse now, in words; empty if it would not.
  std::string refusal(const ProcedureRequest& request) const;
  /// Ends a running procedure safely (homing: halt), e.g. the action was cancelled.
  void cancel(const std::string& reason, Time now);

  /// Why an object that shifts the drive's coordinates or holds its calibration must not be written
  /// now: the axis is not known to be switched off and to stand. Empty: it may.
  std::string calibrationRefusal() const;
  /// Such a write begins: until endCalibration() the axis takes no procedure but those that stop.
  /// @param what is written, for messages. @param moves_zero it may
  void beginCalibration(std::string what, bool moves_zero = true);
  /// The drive has taken the write, or may have: the axis is not homed any more, positions count
  /// from the drive's own zero.
  /// @param device it concerns the whole device, and with it all axes in it
  void loseZero(bool device = false);
  /// What was measured before counts in other coordinates: waits for the drive to tell anew.
  void measureAnew(bool device = false);
  void endCalibration();
  /// Somebody had an object written, which save_parameters may have to write again.
  void noteWritten(fieldbus::ObjectId object);

  /// Takes over what of another configuration an axis takes in motion, see tune(AxisConfig&), or
  /// also what it takes at rest, see adopt(AxisConfig&). In motion nothing allocates.
  /// @pre at rest it is disabled, or its device away; what belongs into the device, but for limits
  /// of position, is there already
  void adopt(const AxisConfig& next, bool at_rest);

  /// A streamed command for the active mode, in joint units (rad, m, per s, N m, N): led there
  /// within the joint's limits. A velocity or effort that is not renewed within command_timeout
  /// ends.
  /// @return why it is refused, in words
  Result<void> command(double value, Time now);
  /// Why command() would refuse that value now, or lead the joint elsewhere as it is beyond a
  /// limit, in words; empty if it is followed as it is.
  std::string commandRefusal(double value) const;
  /// Set-point of the active mode for this cycle, in joint units (rad, m, per s, N m, N). Only
  /// taken while ready_for_motion. What moves must be given anew in every cycle: it is brought to
  /// rest where it is not (SetPoint). @return false (nothing changes) for NaN, out of limits or not
  /// ready.
  [[nodiscard]] bool setTarget(double value);
  double target() const { return setPoint().value(); }
  /// What was sent last, and how it moves.
  const SetPoint& setPoint() const { return *shown_.set_point; }
  /// What one unit of the measured position is, rad or m.
  double positionResolution() const;
  /// Brings the set-points to rest, by a ramp where they move, and ends a stream of commands. A
  /// goal that the drive goes to by itself ends as by a halt, see endsGoal(). Nothing if they do
  /// not move. @param over a ramp of positions is not harder than it takes to come to rest in that
  /// time, or in front of a limit; zero: as hard as it may be, also one that goes on more gently
  void stopSetPoint(Duration over = Duration::zero());
  /// A goal that the drive goes to by itself is being ended by stopSetPoint(): its drive brakes, or
  /// does not have the place where it stands for a goal yet.
  bool endsGoal() const;
  /// A set-point is being handed over to a drive that takes them one by one: it may yet set off, or
  /// go on faster.
  bool handsOver() const;
  /// Somebody gives the set-points of every cycle from now on by setTarget(), and streams are
  /// refused.
  /// @param who for messages, the name of a group; must outlive that. nullptr: nobody any more
  void follow(const std::string* who);
  /// Who does; nullptr: nobody.
  const std::string* leader() const;
  /// What became of the commands that were streamed.
  const Stream& stream() const { return *shown_.stream; }
  /// Cycles were missed before this one. Valid from update() to writeCommands().
  bool late() const;
  /// Why setTarget would refuse now, in words; empty if it would not.
  std::string motionRefusal() const;
  /// Why the axis takes no command, and the call that helps: "elbow is halted: enable"; empty if it
  /// does. A procedure that runs is left out of account.
  std::string obstacle() const;
  /// The mode that it is commanded to be in, by its canonical name.
  const std::string& modeName() const;

  /// What is sent in the cycle does not reach the drive, or is not taken: a drive that may be
  /// enabled is quick-stopped beside the cycle and stays disabled; a procedure that would enable it
  /// is ended.
  /// @param why in words
  void stopBesideCycle(const std::string& why);

  /// Another axis in the same device; must outlive this.
  void addNeighbour(Axis& other);
  /// Why nothing may be done to the device that its other axes would feel; empty if it may.
  std::string deviceRefusal() const;
  /// "; in the same drive: right (operation enabled)", to be put behind what was done to the
  /// device; empty if no other axis is in it.
  std::string neighbourText() const;

  /// Events of the device, from its master.
  /// @param excuse where this program itself is the cause of what the drive reports, as it was
  /// late: in words. The axis goes on then, unless the drive stops by itself.
  void onEmergency(const fieldbus::Emergency& emergency, Time now, const std::string& excuse = {});
  void onHealthChange();
  /// Nothing reaches the drive any more, for the reason `why` ("can0 is bus-off"): an axis in
  /// motion or enabled gets a quick stop as the first thing once the bus is back, and stays
  /// disabled; a procedure that would enable it is ended.
  void onBusLost(const std::string& why);

  /// The present fault in words with cause and remedy; empty if none.
  std::string faultText() const;
  /// The drive has been asked for more about it: faultText() is about to change.
  bool faultTextAwaited() const;

  /// Why the drive's state or position is unknown though its device is ready, in words that stay
  /// the same as long as the reason does; empty if both are known. Between a boot and the first
  /// inputs it is not empty either.
  std::string unknownText() const;

  /// The last thing the axis did by itself (left operation, quick-stopped without feedback, dropped
  /// a set-point, lost its device), as a sentence; noticeCount() grows with each.
  const std::string& notice() const { return notice(noticeCount()).text; }
  /// The one of this number. @param number above noticeCount() - Notices::kKept
  const Notice& notice(std::uint32_t number) const;
  std::uint32_t noticeCount() const { return *shown_.notices; }

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  struct Shown {
    const AxisState* state;
    const ProcedureStatus* procedure;
    const std::uint32_t* notices;
    const SetPoint* set_point;
    const Stream* stream;
  } shown_;  // of impl_, for every cycle asks for it
};

}  // namespace cia402::drive
