// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "can/frame.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// Identifier of SYNC (CiA 301, 7.2.5), default of 1005h.
inline constexpr std::uint32_t kSyncCobId = 0x080;

/// Produces SYNC messages (CiA 301, 7.2.5), with a counter where 1019h asks for one.
class SyncProducer {
 public:
  /// @param overflow value of 1019h: 0 for SYNC without data; otherwise the highest counter value,
  /// 2..240, after which it starts at 1 again.
  explicit SyncProducer(std::uint8_t overflow) : overflow_(overflow) {}

  /// The next SYNC message.
  can::Frame next();
  /// The next counter is 1 again (CiA 301, 7.2.5.3.1: after reset communication).
  void restart() { counter_ = 0; }

 private:
  std::uint8_t overflow_;
  std::uint8_t counter_ = 0;
};

/// Watches the SYNC of another device: whether it comes, how regularly, and in which form.
class SyncConsumer {
 public:
  /// Whether SYNC comes.
  enum class State : std::uint8_t {
    waiting,  ///< none came yet
    running,
    lost,  ///< kLostAfter in a row did not come
  };
  static constexpr int kLostAfter = 3;        ///< SYNCs in a row that may not be missing
  static constexpr int kWindow = 16;          ///< intervals that period() is the mean of
  static constexpr int kOddForms = 3;         ///< SYNCs in a row of a wrong form that are no chance
  static constexpr double kTolerance = 0.05;  ///< share by which the period may be wrong
  static constexpr double kOneMissing = 1.5;  ///< a longer interval (periods) lacks a SYNC

  /// @param period expected, > 0. @param overflow expected counter: 0 none, else 2..240 (1019h).
  SyncConsumer(Duration period, std::uint8_t overflow) : period_(period), overflow_(overflow) {}

  /// What a SYNC tells by its form and time.
  struct Observation {
    bool regular = false;      ///< `deviation` is known: the SYNC before came, too
    Duration deviation{};      ///< from the interval that was expected
    bool returned = false;     ///< it was lost, or this is the first
    std::uint64_t missed = 0;  ///< SYNCs that should have come before it
  };
  /// @param stamp when it was on the wire.
  Observation receive(const can::Frame& frame, Time stamp);
  /// @return true once, when SYNC was lost.
  bool tick(Time now);
  /// When tick() is due: half a period after the SYNC that would be one too many to miss.
  Time deadline() const {
    return state_ == State::running ? last_ + kLostAfter * period_ + period_ / 2 : kNever;
  }

  State state() const { return state_; }
  /// Mean of the last kWindow intervals, without those that lack a SYNC unless most of them do;
  /// zero before there were so many.
  Duration period() const { return measured_; }
  /// The measured period is another one than expected, by more than kTolerance.
  bool periodWrong() const;
  /// The last SYNCs had no counter where one is expected, or the other way round.
  bool formWrong() const { return odd_forms_ >= kOddForms; }
  std::uint64_t received() const { return received_; }
  std::uint64_t missed() const { return missed_; }  ///< by gaps between those that came
  std::uint64_t counterErrors() const { return counter_errors_; }
  Time last() const { return last_; }

 private:
  void measure(Duration interval, bool lacks_sync);
  void restartMeasuring();
  void checkForm(const can::Frame& frame);

  Duration period_;
  std::uint8_t overflow_;
  State state_ = State::waiting;
  Time last_{};
  Duration measured_{0}, sum_{0}, sum_of_short_{0};
  int intervals_ = 0, short_intervals_ = 0;
  int odd_forms_ = 0;
  std::uint8_t counter_ = 0;
  std::uint64_t received_ = 0, missed_ = 0, counter_errors_ = 0;
};

}  // namespace cia402::canopen
