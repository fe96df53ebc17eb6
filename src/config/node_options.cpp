// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The keys of an axis that say how its node is supervised and booted.
#include <array>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using canopen::ErrorControl;

const std::vector<std::string> kKinds{"none", "heartbeat", "guarding"};
constexpr std::int64_t kMillisecond = 1000000;  // ns

/// A time that an object of 16 bits holds in milliseconds.
std::optional<Duration> readMilliseconds(yaml::Section& section, const std::string& key) {
  double seconds = 0.0;
  if (!section.read(key, seconds, yaml::Range{0.001, 65.535, false})) return std::nullopt;
  const Duration time = fromSeconds(seconds);
  if (time.count() % kMillisecond == 0) return time;
  section.get(key)->problem("must be a whole number of milliseconds, as the drive counts in them");
  return std::nullopt;
}

void readErrorControl(const yaml::Value& value, canopen::ErrorControlOptions& options) {
  std::optional<std::size_t> kind;
  if (value.isMap()) {
    yaml::Section section(value);
    const auto name = section.get("kind");
    kind = name ? name->oneOf(kKinds) : std::nullopt;
    options.period = readMilliseconds(section, "period");
    options.timeout = readMilliseconds(section, "timeout");
    options.master_timeout = readMilliseconds(section, "master_timeout");
    section.finish();
  } else {
    kind = value.oneOf(kKinds);
  }
  if (kind) options.kind = static_cast<ErrorControl>(*kind);
}

unsigned daysOf(unsigned month, unsigned year) {
  constexpr std::array<unsigned, 12> kDays{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return month == 2 && leap ? 29 : kDays[month - 1];
}

/// Days since 1984-01-01; nothing for a day that does not exist or lies before 1984-01-02.
std::optional<std::uint32_t> daysSince1984(unsigned year, unsigned month, unsigned day) {
  constexpr unsigned kFirst = 1984;
  const bool exists = year >= kFirst && month >= 1 && month <= 12 && day >= 1;
  if (!exists || day > daysOf(month, year)) return std::nullopt;
  std::uint32_t days = day - 1;
  for (unsigned y = kFirst; y < year; ++y) days += daysOf(2, y) == 29 ? 366 : 365;
  for (unsigned m = 1; m < month; ++m) days += daysOf(m, year);
  return days == 0 ? std::nullopt : std::optional<std::uint32_t>(days);
}

/// Days since 1984-01-01 and ms of the day, as in 1020h, of "2026-11-21" or "2026-11-21T15:30:00".
bool readDate(const std::string& text, canopen::BootPolicy& policy) {
  unsigned year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
  int used = 0;
  if (std::sscanf(text.c_str(), "%4u-%2u-%2u%n", &year, &month, &day, &used) != 3) return false;
  const std::string rest = text.substr(static_cast<std::size_t>(used));
  if (!rest.empty()) {
    const int times =
        std::sscanf(rest.c_str(), "%*1[T ]%2u:%2u:%2u%n", &hour, &minute, &second, &used);
    if (times != 3 || static_cast<std::size_t>(used) != rest.size()) return false;
  }
  const auto days = daysSince1984(year, month, day);
  if (!days || hour > 23 || minute > 59 || second > 59) return false;
  policy.date = *days;
  policy.time = ((hour * 60 + minute) * 60 + second) * 1000;
  return true;
}

void readCheck(const yaml::Value& value, canopen::BootPolicy& policy) {
  const auto text = value.text();
  if (!text) return;
  if (*text == "none") {
    policy.check = canopen::ConfigurationCheck::none;
  } else if (*text == "checksum") {
    policy.check = canopen::ConfigurationCheck::checksum;
  } else if (readDate(*text, policy)) {
    policy.check = canopen::ConfigurationCheck::date;
  } else {
    value.problem("must be none, checksum, or the date of the configuration as " +
                  std::string("2026-11-21 or 2026-11-21T15:30:00 (after 1984), not `") + *text +
                  "`");
  }
}

void readRetries(const yaml::Value& value, canopen::BootPolicy& policy) {
  yaml::Section section(value);
  const auto seconds = [&section](const std::string& key, yaml::Range range, Duration& target) {
    double time = toSeconds(target);
    if (section.read(key, time, range)) target = fromSeconds(time);
  };
  section.readInteger("retries", policy.retries, 0, 1000);
  seconds("retry_delay", yaml::Range{0.01, 3600.0, false}, policy.retry_delay);
  seconds("search_period", yaml::Range{0.0, 3600.0, false}, policy.search_period);
  section.finish();
}

void readChannel(const yaml::Value& value, canopen::SdoChannel& channel) {
  yaml::Section section(value);
  const std::string hint =
      "both COB-IDs of the channel, as the drive has them: {request: 0x641, "
      "answer: 0x5C1}";
  if (section.require("request", hint)) section.readInteger("request", channel.request, 1, 0x7FF);
  if (section.require("answer", hint)) section.readInteger("answer", channel.answer, 1, 0x7FF);
  section.finish();
}

void checkMasterTimeout(const yaml::Value& at, const canopen::ErrorControlOptions& options,
                        ErrorControl kind, const BusConfig& bus, const std::string& profile_name,
                        const canopen::DeviceProfile& profile) {
  if (!options.master_timeout) return;
  if (kind == ErrorControl::guarding) {
    at.problem("`master_timeout` is for heartbeats; with guarding `timeout` goes for both");
  } else if (!profile.heartbeat_consumer_supported) {
    at.problem("`master_timeout`: profile " + profile_name +
               " says that the drive watches no heartbeat");
  } else if (bus.heartbeat == Duration(0)) {
    at.problem(
        "`master_timeout` waits for the heartbeat of this program, which has none: give "
        "bus/heartbeat a time");
  } else if (*options.master_timeout <= bus.heartbeat) {
    at.problem("`master_timeout` (" + secondsText(*options.master_timeout) +
               ") must be longer than bus/heartbeat (" + secondsText(bus.heartbeat) + ")");
  }
}

void checkErrorControlPeriod(yaml::Section& section, const AxisDraft& draft, const BusConfig& bus) {
  const Duration shortest = draft.device.profile->error_control_min;
  const ErrorControlPlan plan = planErrorControl(bus, draft.device);
  if (plan.kind == ErrorControl::none || plan.period >= shortest) return;
  const std::string problem = "drives of profile " + draft.axis.profile->name + " stand no " +
                              (plan.kind == ErrorControl::guarding ? "guard time" : "heartbeat") +
                              " below " + secondsText(shortest) + ", and this is " +
                              secondsText(plan.period);
  if (const auto at = section.get("error_control"))
    return at->problem(problem + "; make it longer");
  section.problem(problem + " (bus/heartbeat); make that longer, or give it `error_control`");
}

}  // namespace

ErrorControlPlan planErrorControl(const BusConfig& bus, const DeviceConfig& device) {
  const canopen::DeviceProfile& profile = *device.profile;
  const canopen::ErrorControlOptions& options = device.error_control;
  ErrorControlPlan plan;
  plan.kind = options.kind.value_or(profile.heartbeat_supported       ? ErrorControl::heartbeat
                                    : profile.node_guarding_supported ? ErrorControl::guarding
                                                                      : ErrorControl::none);
  plan.period = options.period.value_or(bus.heartbeat);
  if (plan.period == Duration(0)) plan.kind = ErrorControl::none;
  if (plan.kind == ErrorControl::none) plan.period = Duration(0);
  plan.timeout = options.timeout.value_or(3 * plan.period);
  if (plan.kind != ErrorControl::guarding && profile.heartbeat_consumer_supported) {
    plan.master_timeout = options.master_timeout.value_or(3 * bus.heartbeat);
  }
  return plan;
}

void readNodeOptions(yaml::Section& section, DeviceConfig& device) {
  if (const auto value = section.get("error_control")) {
    readErrorControl(*value, device.error_control);
  }
  if (const auto value = section.get("sdo")) readChannel(*value, device.sdo);
  section.read("optional", device.boot.optional);
  section.read("restore_before_configure", device.boot.restore_before_configure);
  if (const auto value = section.get("configuration_check")) readCheck(*value, device.boot);
  if (const auto value = section.get("boot")) readRetries(*value, device.boot);
}

void checkErrorControl(yaml::Section& section, const AxisDraft& draft, const RobotConfig& robot) {
  const DeviceConfig& device = draft.device;
  const auto at = section.get("error_control");
  if (!draft.axis.profile) return;
  checkErrorControlPeriod(section, draft, robot.bus);
  if (!at) return;
  const std::string& profile_name = draft.axis.profile->name;
  const canopen::ErrorControlOptions& options = device.error_control;
  const ErrorControlPlan plan = planErrorControl(robot.bus, device);
  if (options.kind == ErrorControl::heartbeat && !device.profile->heartbeat_supported) {
    at->problem("profile " + profile_name +
                " says that the drive sends no heartbeat; write `guarding`, or `none`");
  }
  if (options.kind == ErrorControl::none && (options.period || options.timeout)) {
    at->problem("`none` has neither `period` nor `timeout`");
  } else if (plan.kind == ErrorControl::none && options.kind.value_or(plan.kind) != plan.kind) {
    at->problem("needs a `period`, as bus/heartbeat is 0");
  }
  checkMasterTimeout(*at, options, plan.kind, robot.bus, profile_name, *device.profile);
  if (plan.kind == ErrorControl::none) return;
  const bool multiple = plan.timeout % plan.period == Duration(0);
  const std::int64_t factor = plan.timeout / plan.period;
  if (plan.kind == ErrorControl::guarding && (!multiple || factor < 2 || factor > 255)) {
    at->problem("`timeout` (" + secondsText(plan.timeout) + ") must be 2 to 255 times `period` (" +
                secondsText(plan.period) + "): the drive holds their ratio (100Dh)");
  } else if (plan.timeout <= plan.period) {
    at->problem("`timeout` (" + secondsText(plan.timeout) + ") must be longer than `period` (" +
                secondsText(plan.period) + ")");
  }
}

}  // namespace cia402::config
