// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "bus/axis_reporter.h"
#include "bus/axis_words.h"
#include "bus/bus_side.h"
#include "bus/event.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// What people are told of an axis as it happens, and what is shown of it in words: only what
/// changes is told.
class AxisNews {
 public:
  /// @param axis index in the configuration, @param who "shoulder (node 3)".
  /// @param patience a device that is ready may tell nothing for so long.
  AxisNews(std::size_t axis, std::string who, Duration patience, EventSink& events)
      : index_(axis), who_(std::move(who)), patience_(patience), events_(&events) {}

  const AxisWords& words() const { return words_; }
  /// Shows something; nothing happens where it is shown already.
  template <std::size_t N>
  void say(FixedText<N> AxisWords::*what, std::string_view text) {
    words_.say(what, text);
  }
  /// Why the device of the axis cannot be reached, for people: the reason for all that follows,
  /// shown until the device is ready. Empty: nothing is known.
  void setCause(std::string cause) { cause_ = std::move(cause); }
  const std::string& cause() const { return cause_; }

  /// Once a cycle, the last of it, and when the axis has given notice beside it: tells what is new.
  void watch(drive::Axis& axis, AxisReporter& reporter, const BusSide& bus, Time now) {
    if (dried_up_ != axis.stream().dried_up) tellStream(axis, now);
    if (differs(axis)) {
      tellNews(axis, reporter, bus, now);
    } else if (now >= checked_ + kInterval) {
      checkAgain(axis, reporter, bus, now);
    }
  }
  /// The axis has got a fault whose history nobody has asked for yet.
  bool faultUnexplained() const { return fault_unexplained_; }
  void explainFault() { fault_unexplained_ = false; }

 private:
  static constexpr Duration kInterval = std::chrono::milliseconds(100);

  bool differs(const drive::Axis& axis) {
    const drive::AxisCondition& shown = axis.state();
    if (told_ != shown && differs(shown)) return true;
    return procedure_ != axis.procedure().id || running_ != axis.procedure().running ||
           notices_ != axis.noticeCount();
  }
  bool differs(const drive::AxisCondition& shown);
  void note(const drive::Axis& axis, Time now);
  [[gnu::cold]] void checkAgain(drive::Axis& axis, AxisReporter& reporter, const BusSide& bus,
                                Time now);
  bool isUnwell(const drive::Axis& axis) const;
  [[gnu::cold]] void tellNews(drive::Axis& axis, AxisReporter& reporter, const BusSide& bus,
                              Time now);
  bool tellNotices(const drive::Axis& axis, bool aloud, const std::string& problem, Time now);
  void tellProblem(drive::Axis& axis, AxisReporter& reporter, Time now);
  [[gnu::cold]] void tellStream(const drive::Axis& axis, Time now);
  std::string unknownProblem(const drive::Axis& axis, Time now);

  // Of the axis, as it was told last:
  drive::AxisCondition told_;
  bool running_ = false;
  std::uint32_t procedure_ = 0, notices_ = 0;
  bool dried_up_ = false;  // its stream of set-points
  bool fault_unexplained_ = false;
  Time checked_{};
  Time unknown_since_ = kNever;  // its state or position
  std::size_t index_;
  std::string who_, cause_;
  Duration patience_;
  EventSink* events_;
  AxisWords words_;
};

}  // namespace cia402::bus
