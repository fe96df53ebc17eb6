// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drive/procedures/procedure.h"

namespace cia402::drive {

/// Reads what the drive is set to and says, and compares it with the profile's checks and with what
/// the axis counts on; a difference fails, and names object, number and remedy, unless it is one
/// that is only warned of, or one that is written. Before enabling it learns how long the brake
/// takes, too. What `lacks` of the axis names is neither read nor compared.
class SettingsStep {
 public:
  SettingsStep(const DriveProfile& profile, SettingCheck::Before before)
      : profile_(&profile), before_(before) {}
  Outcome advance(const Context& context);

 private:
  struct Setting {
    const ObjectSpec* object = nullptr;
    std::optional<std::int64_t> number;  ///< nothing: it could not be read
    bool needed = true;                  ///< what it is decides, and is not only told
  };
  struct Difference {
    const SettingCheck* check = nullptr;
    std::string text;  ///< with remedy
  };
  bool enabling() const { return before_ == SettingCheck::Before::enabling; }
  void plan(const AxisConfig& axis);
  void add(const AxisConfig& axis, const std::string& object, bool needed = true);
  void compareReadBack(AxisCore& axis) const;
  std::size_t indexOf(const std::string& object) const;
  std::optional<std::int64_t> numberOf(const std::string& object) const;

  Outcome transfer(const Context& context);
  bool ask(const Context& context);
  bool mayBeAbsent(const fieldbus::Transfer& answer) const;
  std::string take(const Context& context, const fieldbus::Transfer& answer);
  std::vector<Difference> differences() const;
  std::optional<Difference> compare(const SettingCheck& check) const;
  std::optional<Difference> compareAmongThem(const SettingCheck& check) const;
  std::string keptBy(AxisCore& axis, const SettingCheck& check) const;
  void losePosition(const Context& context);
  bool settled(const Context& context);
  bool mayWrite(AxisCore& axis, const SettingCheck& check) const;
  bool planWrites(AxisCore& axis);
  void planCounts(AxisCore& axis);
  Outcome judge(const Context& context);
  std::string refusal(const Context& context) const;
  std::string compareCounts(const AxisConfig& axis) const;
  std::string compareTorque(const AxisConfig& axis) const;
  /// @param time the longest that the profile allows for, then what the drive says
  std::string learnTime(const AxisConfig& axis, const std::string& name, Duration& time) const;
  std::string learnTimes(AxisCore& axis) const;

  const DriveProfile* profile_;
  SettingCheck::Before before_;
  bool planned_ = false;
  std::vector<const SettingCheck*> checks_;  ///< that count for the axis
  std::vector<Setting> settings_;
  std::vector<const SettingCheck*> writes_;  ///< whose number is written
  std::array<SettingCheck, 2> counts_;       ///< two of these, by the rule of counts
  std::vector<std::size_t> reads_;           ///< of settings_, what is read
  std::size_t written_ = 0, read_ = 0;       ///< of these
  std::string absent_;                       ///< what could not be compared, the drive has it not
  std::size_t warned_ = 0;                   ///< differences that only warn, told so far
  std::optional<Time> warned_at_;
  fieldbus::Ticket ticket_;
  std::optional<Time> settles_;  ///< new coordinates, until then
};

}  // namespace cia402::drive
