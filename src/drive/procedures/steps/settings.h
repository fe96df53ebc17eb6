// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Reads what the drive is set to and compares it with what the profile expects and the axis
/// counts on; a difference fails, and names object, number and remedy. Learns how long the brake
/// takes. What `lacks` of the axis names is neither read nor compared.
class SettingsStep {
 public:
  explicit SettingsStep(const DriveProfile& profile) : profile_(&profile) {}
  Outcome advance(const Context& context);

 private:
  struct Setting {
    const ObjectSpec* object = nullptr;
    std::optional<std::int64_t> number;  ///< nothing: it could not be read
  };
  void plan(const AxisConfig& axis);
  void add(const AxisConfig& axis, const std::string& object);
  bool take(const Context& context, std::string& problem);
  std::optional<std::int64_t> find(const std::string& object) const;
  std::string compare(const AxisConfig& axis) const;
  std::string compareCounts(const AxisConfig& axis) const;
  std::string learnBrake(AxisCore& axis) const;

  const DriveProfile* profile_;
  bool planned_ = false;
  std::vector<Setting> settings_;
  std::size_t next_ = 0;
  fieldbus::Ticket ticket_;
};

}  // namespace cia402::drive
