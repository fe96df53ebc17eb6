// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cia402_driver/common/time.h"
#include "fieldbus/object.h"

namespace cia402::fieldbus {

/// A value in a device's process image: a raw little-endian number as wide as its mapping entry.
struct ProcessValue {
  std::uint64_t raw = 0;  ///< zero-extended
  Time stamp{};           ///< when the frame that brought it was on the wire
  bool valid = false;     ///< false until the first reception since boot
  bool fresh = false;     ///< valid, and what brings it comes as it should
};

/// What no frame brings.
inline constexpr ProcessValue kNoValue{};

/// Index into a device's process image; kNoSlot if the object is not mapped.
using Slot = std::uint16_t;
inline constexpr Slot kNoSlot = 0xFFFF;

/// The values that travel cyclically between the driver and one device, both ways. An axis knows
/// this side of it only; how the values are packed into frames is the bus' own. Built once, then
/// free of allocation.
class ProcessImage {
 public:
  Slot inputSlot(ObjectId object) const;   ///< object that the device sends, or kNoSlot
  Slot outputSlot(ObjectId object) const;  ///< object that the device gets, or kNoSlot
  /// Stays where it is as long as the device does.
  const ProcessValue& input(Slot slot) const { return inputs_[slot]; }
  void setOutput(Slot slot, std::uint64_t raw) { outputs_[slot] = raw; }
  std::uint64_t output(Slot slot) const { return outputs_[slot]; }

  /// Has the value come, and in time? A slot of an object that is not mapped is not fresh.
  bool fresh(Slot slot) const { return slot != kNoSlot && inputs_[slot].fresh; }
  /// The value of an input is unknown until it comes again. @pre slot is that of an input
  void forget(Slot slot) { inputs_[slot].valid = inputs_[slot].fresh = false; }
  /// Does the value come at a known rate, whether it changes or not? @pre slot is that of an input
  bool regular(Slot slot) const { return deliveries_[slot].regular; }
  /// The longest time between two receptions of a value that comes regularly; of another one, the
  /// time for which its change may be withheld (inhibit time).
  /// @param cycle period of the bus' cycle  @pre slot is that of an input
  Duration interval(Slot slot, Duration cycle) const {
    const Delivery& delivery = deliveries_[slot];
    return delivery.cycles != 0 ? delivery.cycles * cycle : delivery.interval;
  }
  /// The device has been configured without it.
  bool inputLeftOut(Slot slot) const { return inputs_left_out_[slot]; }
  bool outputLeftOut(Slot slot) const { return outputs_left_out_[slot]; }
  /// Which of the frames, or parts of one, that leave in a cycle carries an output.
  std::size_t carrierOf(Slot slot) const { return carriers_[slot]; }
  /// How often what carries an output has left so far. @pre slot is that of an output
  std::uint64_t sent(Slot slot) const { return sent_[carriers_[slot]]; }
  /// What carries an output leaves with the next cycle though nothing in it has changed, for an
  /// output that must not be lost. @pre slot is that of an output
  virtual void sendAgain(Slot slot) = 0;

 protected:
  // For the bus that the values travel on.
  ProcessImage() = default;
  ~ProcessImage() = default;
  ProcessImage(const ProcessImage&) = default;
  ProcessImage& operator=(const ProcessImage&) = default;
  ProcessImage(ProcessImage&&) noexcept = default;
  ProcessImage& operator=(ProcessImage&&) noexcept = default;

  /// How an input comes.
  struct Delivery {
    bool regular = false;
    std::uint16_t cycles = 0;  ///< from one to the next; 0: not by the cycle
    Duration interval{0};      ///< instead of these
  };
  /// Adds an object unless it is there. @return its slot
  Slot addInput(ObjectId object);
  Slot addOutput(ObjectId object);
  void setDelivery(Slot slot, const Delivery& delivery) { deliveries_[slot] = delivery; }
  /// Output `slot` leaves with carrier number `carrier`.
  void setCarrier(Slot slot, std::size_t carrier);
  void leaveOutInput(Slot slot, bool left_out) { inputs_left_out_[slot] = left_out; }
  void leaveOutOutput(Slot slot, bool left_out) { outputs_left_out_[slot] = left_out; }

  void take(Slot slot, std::uint64_t raw, Time stamp) { inputs_[slot] = {raw, stamp, true, true}; }
  /// All inputs by their slots, for a bus that takes several at once.
  ProcessValue* inputs() { return inputs_.data(); }
  void outdate(Slot slot) { inputs_[slot].fresh = false; }
  void countSent(std::size_t carrier) { ++sent_[carrier]; }
  /// Every input is unknown and every output 0, so that no set-point or controlword of before is
  /// ever sent again.
  void clear();

 private:
  std::vector<ProcessValue> inputs_;
  std::vector<std::uint64_t> outputs_, sent_;
  std::vector<Delivery> deliveries_;
  std::vector<std::size_t> carriers_;  ///< of each output, index in sent_
  std::vector<bool> inputs_left_out_, outputs_left_out_;
  std::vector<ObjectId> input_objects_, output_objects_;
};

}  // namespace cia402::fieldbus
