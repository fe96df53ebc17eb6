// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_reporter.h"

#include <algorithm>
#include <utility>

#include "common/text.h"
#include "drive/profile/fault_text.h"

namespace cia402::bus {
namespace {

// Kinds of news beside the 16-bit codes of faults.
constexpr std::uint32_t kBootUp = 0x10000;
constexpr std::uint32_t kMalformed = 0x10001;
constexpr const char* kSummedUp = "; further ones are summed up every 5 s";

}  // namespace

std::string groupedDigits(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t place = text.size(); place > 3;) {
    place -= 3;
    text.insert(place, ",");
  }
  return text;
}

AxisReporter::AxisReporter(std::size_t axis, std::string who,
                           std::shared_ptr<const drive::DriveProfile> profile, EventSink& events)
    : axis_(axis), who_(std::move(who)), profile_(std::move(profile)), events_(&events) {}

void AxisReporter::emergency(const fieldbus::Emergency& emergency, Time now,
                             const std::string& excuse) {
  count(emergency);
  events_->onEmergency({axis_, emergency});
  const auto verdict = emergency_limit_.take(emergency.code, now);
  if (verdict == RepeatLimiter::Verdict::hold) return;
  tellUnlessHeld(verdict, emergency.code == 0 ? Event::Severity::info : Event::Severity::warning,
                 textOf(emergency, excuse), now);
}

void AxisReporter::count(const fieldbus::Emergency& emergency) {
  ++counts_.total;
  const auto end = counts_.of.begin() + static_cast<std::ptrdiff_t>(counts_.codes);
  auto place = std::find_if(counts_.of.begin(), end, [&](const EmergencyCount& known) {
    return known.code == emergency.code;
  });
  if (place == counts_.of.end()) return;
  if (place == end) ++counts_.codes;
  place->code = emergency.code;
  ++place->count;
  place->last = emergency.stamp;
}

std::string AxisReporter::textOf(const fieldbus::Emergency& emergency,
                                 const std::string& excuse) const {
  if (!excuse.empty()) {
    return "emergency: " + hexText(emergency.code, 4) + " " +
           drive::errorName(*profile_, emergency.code) + ": the cause is that " + excuse +
           "; nothing is wrong with the drive, the axis goes on unless it says otherwise";
  }
  std::string text =
      "emergency: " + (emergency.code == 0 ? fieldbus::emergencyText(0)
                                           : drive::errorCodeText(*profile_, emergency.code));
  text += "; error register: " + fieldbus::errorRegisterText(emergency.error_register);
  const std::string vendor = fieldbus::vendorBytesText(emergency);
  if (!vendor.empty()) text += "; manufacturer bytes: " + vendor;
  if (emergency.size != fieldbus::Emergency::kSize) {
    text += "; the frame has " + std::to_string(emergency.size) + " bytes instead of 8";
  }
  return text;
}

void AxisReporter::malformedEmergency(std::size_t size, Time now) {
  ++counts_.malformed;
  tellUnlessHeld(other_limit_.take(kMalformed, now), Event::Severity::warning,
                 "an emergency frame of " + std::to_string(size) +
                     (size == 1 ? " byte" : " bytes") +
                     " has no error code: look for another device that uses this identifier",
                 now);
}

void AxisReporter::problem(Event::Severity severity, std::uint16_t code, const std::string& text,
                           Time now) {
  const auto verdict = code == 0 ? RepeatLimiter::Verdict::tell : other_limit_.take(code, now);
  if (verdict == RepeatLimiter::Verdict::hold) return;
  bus::tell(*events_, severity, text, now);
}

void AxisReporter::bootUp(Time now) {
  tellUnlessHeld(other_limit_.take(kBootUp, now), Event::Severity::warning,
                 "boots up again and again before it is configured: look for a power dip or a "
                 "watchdog reset",
                 now);
}

void AxisReporter::sumUp(Time now) {
  while (const auto summary = emergency_limit_.due(now)) tell("emergency", *summary, now);
  while (const auto summary = other_limit_.due(now)) tell("problem", *summary, now);
}

void AxisReporter::flush(Time now) {
  while (const auto summary = emergency_limit_.rest(now)) tell("emergency", *summary, now);
  while (const auto summary = other_limit_.rest(now)) tell("problem", *summary, now);
}

void AxisReporter::tellUnlessHeld(RepeatLimiter::Verdict verdict, Event::Severity severity,
                                  const std::string& text, Time now) {
  if (verdict == RepeatLimiter::Verdict::hold) return;
  tell(severity, verdict == RepeatLimiter::Verdict::tell ? text : text + kSummedUp, now);
}

void AxisReporter::tell(Event::Severity severity, const std::string& text, Time now) {
  bus::tell(*events_, severity, who_ + ": " + text, now);
}

std::string AxisReporter::kindText(std::uint32_t kind) const {
  if (kind == kBootUp) return "boot-up message";
  if (kind == kMalformed) return "emergency frame without an error code";
  const auto code = static_cast<std::uint16_t>(kind);
  return hexText(code, 4) + " " +
         (code == 0 ? fieldbus::emergencyText(0) : drive::errorName(*profile_, code));
}

void AxisReporter::tell(const char* prefix, const RepeatLimiter::Summary& summary, Time now) {
  const bool has_code = !summary.others && summary.kind <= 0xFFFF;
  tell(Event::Severity::warning,
       (has_code ? std::string(prefix) + " " : "") +
           (summary.others ? std::string(prefix) + " of yet other codes" : kindText(summary.kind)) +
           ": came " + groupedDigits(summary.count) + " times in the last " +
           secondsText(summary.over, 1) + ", " + groupedDigits(summary.total) +
           " times since start",
       now);
}

}  // namespace cia402::bus
