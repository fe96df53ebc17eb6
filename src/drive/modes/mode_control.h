// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

#include "drive/axis/feedback.h"
#include "drive/modes/set_point_offsets.h"
#include "drive/modes/stream.h"

namespace cia402::drive {

/// What one mode of operation makes of set-points: which it takes, what is neutral in it, and how
/// they reach the drive. There is one for each kind of mode, made by makeModeControl().
class ModeControl {
 public:
  /// What a mode works with; all of it outlives the mode.
  struct Context {
    AxisBasis& axis;
    const Coordinates& coordinates;
    const Feedback& feedback;
    SetPoint& sent;  ///< of the axis, whatever its mode
  };

  ModeControl(const ModeChannel& channel, const Context& context);
  virtual ~ModeControl() = default;
  ModeControl(const ModeControl&) = delete;
  ModeControl& operator=(const ModeControl&) = delete;

  const ModeChannel& channel() const { return *channel_; }
  const ModeSpec& spec() const { return *channel_->spec; }
  SetPointKind kind() const { return kind_; }

  /// The joint's zero is another, or the mode is entered.
  virtual void place() {}
  /// The raw number of a set-point in joint units. @return false if the object cannot hold it
  bool encode(double value, std::uint64_t& raw) const { return conversion_.toDevice(value, raw); }
  /// "target_torque (6071:00), which takes 0.000 to 3.840", in joint units.
  std::string targetText() const;
  /// Set-points are positions: they count from the joint's zero, which must be known.
  bool positions() const { return kind_ == SetPointKind::stream || goals(); }
  /// They are goals: the drive goes to each by itself, and may take them one by one.
  bool goals() const { return kind_ == SetPointKind::goal; }
  /// Is within the limits of the joint? @param value in joint units, finite
  virtual bool accepts(double value) const = 0;
  /// Of efforts: none is accepted, as the axis comes to a limit of position, or goes on beyond one.
  virtual bool stopsAtLimit() const { return false; }
  /// But for those that slow it down, where nothing else does.
  virtual bool maySlow(double /*value*/) const { return false; }
  /// What is sent of an effort that was accepted.
  virtual double guarded(double value) const { return value; }
  /// With which the mode begins without moving anything, in joint units.
  virtual double neutral() const { return 0.0; }
  /// The same as a raw number. @return false if it is unknown
  virtual bool neutralRaw(std::uint64_t& raw) const {
    raw = 0;
    return true;
  }

  // A stream of commands (Axis::command()), which the mode leads within the limits of the joint.
  /// Begins from what was sent last, with the command that there is. @param at of the stream's
  /// clock
  virtual void beginStream(const Stream& /*stream*/, Time /*at*/) {}
  /// There is room for a further command; not where each has to wait for the one before.
  virtual bool takesMore() const { return true; }
  /// A new command is there, finite.
  virtual void takeCommand(Stream& /*stream*/) {}
  /// @return the set-point of this cycle; nothing: none is given. @pre there is a command
  virtual std::optional<double> follow(Stream& stream, Time now) = 0;

  /// At least one cycle was missed. @return whether what is commanded cannot be gone on with: it
  /// ends, and the axis is brought to rest from where it is
  virtual bool late(Time now);
  /// handOver() is to be asked in each cycle.
  bool handsOver() const { return hands_over_; }

  /// A cycle out of operation, where handsOver(): what is sent beside the target is neutral.
  virtual void rest() { offsets_.clear(); }

  // What follows is empty but where handsOver(); cycles ask for it there only.
  /// Begins anew with a neutral target, or the mode is left.
  virtual void reset(std::uint64_t /*raw*/) { offsets_.clear(); }
  /// The set-point is another now. @param twice see SetPointHandshake::offer()
  virtual void offer(std::uint64_t /*raw*/, bool /*twice*/) {}
  /// A set-point was accepted that has the number `raw`, which is the one before, `same`.
  virtual void accepted(std::uint64_t /*raw*/, bool /*same*/) {}
  /// One cycle; before its set-point is made.
  virtual void prepare(Time /*now*/) {}
  /// One cycle. @param raw the set-point, replaced by what the target object is to hold
  /// @return what the drive did not answer to in time, so that the set-point is dropped; else
  /// nullptr
  virtual const char* handOver(std::uint64_t& /*raw*/, Time /*now*/) {
    offsets_.set(sent().velocity());
    return nullptr;
  }
  /// Target reached still speaks of the set-point before.
  virtual bool handingOver() const { return false; }
  /// Bits of the controlword in operation.
  virtual unsigned bits() const { return spec().controlword_bits; }

  // What follows is empty but where the drive goes to a position by itself.
  /// The drive has not come to where it was sent.
  virtual bool goalAhead() const { return false; }
  /// The axis was halted while its set-points end: the drive must get a place to stop at.
  virtual void beginHalt() {}
  virtual void endHalt() {}
  /// A cycle was late while the axis was being halted so.
  virtual void lateInHalt(Time /*now*/) {}
  /// What looks like standstill, after a halt, may be where the drive turns back.
  virtual bool mayTurnBack(Time /*now*/, Time /*seen_moving*/) const { return false; }
  /// How long a drive may take to come back from a target that it had not reached, once that was
  /// taken back. @param away from where it stands, rad or m
  virtual Duration wayBack(double /*away*/) const { return Duration::zero(); }

 protected:
  AxisBasis& axis() const { return context_.axis; }
  const AxisState& state() const { return context_.axis.state; }
  const motion::JointLimits& limits() const { return context_.axis.config.limits; }
  const Coordinates& coordinates() const { return context_.coordinates; }
  const Feedback& feedback() const { return context_.feedback; }
  SetPoint& sent() const { return context_.sent; }
  void convertBy(const Conversion& conversion) { conversion_ = conversion; }
  void handOverEachCycle() { hands_over_ = true; }
  /// Beyond a limit of position a velocity or effort may only get less or lead back.
  bool leadsInside(double value) const;

 private:
  const ModeChannel* channel_;
  Context context_;
  SetPointKind kind_;
  bool hands_over_;
  Conversion conversion_;
  SetPointOffsets offsets_;
};

/// What the drive makes of the set-points of a mode.
SetPointKind kindOf(const ModeSpec& mode);
/// The control of a mode, by its kind. @param channel must outlive it
std::unique_ptr<ModeControl> makeModeControl(const ModeChannel& channel,
                                             const ModeControl::Context& context);

}  // namespace cia402::drive
