// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "cia402_driver/common/time.h"
#include "sim/drive/values.h"

namespace cia402::sim {

/// The past errors of an axis where the maker keeps them: one is selected, and its code and time
/// are shown. They stay without power.
class AlarmMemory {
 public:
  static constexpr std::size_t kMost = 20;

  /// All must outlive it. @param more MonitorsDefinition::at_alarm
  using Pairs = std::vector<std::pair<ObjectId, ObjectId>>;
  AlarmMemory(DriveValues& values, ObjectDictionary& dictionary, const Pairs& more)
      : values_(values), dictionary_(dictionary), more_(more) {}
  /// Power-on: times count from now.
  void start(Time now);
  /// An error comes. @param details error_details of it
  void add(std::int64_t details, Time now);
  /// Another one is selected.
  void show();

 private:
  struct Alarm {
    std::int64_t code = 0;
    double time = 0.0;                ///< s
    std::vector<std::uint64_t> more;  ///< numbers of the objects that are kept with it
  };
  std::uint64_t shownBy(ObjectId id);

  DriveValues& values_;
  ObjectDictionary& dictionary_;
  const Pairs& more_;
  Time started_{};
  std::array<Alarm, kMost> alarms_;  ///< the newest first
};

}  // namespace cia402::sim
