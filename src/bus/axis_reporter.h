// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "bus/event.h"
#include "bus/repeat_limiter.h"
#include "drive/profile/profile.h"
#include "fieldbus/emergency.h"

namespace cia402::bus {

/// How often one emergency code came.
struct EmergencyCount {
  std::uint16_t code = 0;
  std::uint64_t count = 0;  ///< since start
  Time last{};
};

/// The emergencies of one axis since start.
struct EmergencyCounts {
  std::uint64_t total = 0;      ///< error resets (0x0000) included
  std::uint64_t malformed = 0;  ///< frames too short to hold a code; not in `total`
  std::size_t codes = 0;        ///< used places of `of`
  /// In the order in which the codes came first; a drive with more codes has some in `total` only.
  std::array<EmergencyCount, RepeatLimiter::kKinds> of{};
};

/// Puts what a drive reports by itself into words: emergencies, faults, boot-ups. What comes too
/// fast to be read is summed up every five seconds with its exact count.
class AxisReporter {
 public:
  /// @param axis index in the configuration, @param who "shoulder (node 3)".
  AxisReporter(std::size_t axis, std::string who,
               std::shared_ptr<const drive::DriveProfile> profile, EventSink& events);

  /// An emergency of the device came, which another of its axes tells of.
  void count(const fieldbus::Emergency& emergency);
  /// An emergency came: it is handed to EventSink::onEmergency() and told.
  /// @param excuse how this program itself has caused it, in words; empty: it has not
  void emergency(const fieldbus::Emergency& emergency, Time now, const std::string& excuse = {});
  /// A frame of `size` bytes came where an emergency was expected, without an error code.
  void malformedEmergency(std::size_t size, Time now);
  /// The axis has got a fault, a problem or a warning with this code (603Fh); `text` says all.
  void problem(Event::Severity severity, std::uint16_t code, const std::string& text, Time now);
  /// A boot-up message came once more before any boot was done.
  void bootUp(Time now);

  /// Tells the summaries that are due.
  void tick(Time now) {
    if (now >= emergency_limit_.deadline() || now >= other_limit_.deadline()) sumUp(now);
  }
  /// Tells what was held back until now.
  void flush(Time now);

  const EmergencyCounts& emergencies() const { return counts_; }

 private:
  void tell(Event::Severity severity, const std::string& text, Time now);
  void sumUp(Time now);
  void tellUnlessHeld(RepeatLimiter::Verdict verdict, Event::Severity severity,
                      const std::string& text, Time now);
  void tell(const char* prefix, const RepeatLimiter::Summary& summary, Time now);
  std::string kindText(std::uint32_t kind) const;
  std::string textOf(const fieldbus::Emergency& emergency, const std::string& excuse) const;

  std::size_t axis_;
  std::string who_;
  std::shared_ptr<const drive::DriveProfile> profile_;
  EventSink* events_;
  EmergencyCounts counts_;
  RepeatLimiter emergency_limit_;  // by code
  RepeatLimiter other_limit_;      // by code of a fault, or kBootUp, kMalformed
};

/// "1,234,567".
std::string groupedDigits(std::uint64_t number);

}  // namespace cia402::bus
