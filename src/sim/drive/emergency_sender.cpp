// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/emergency_sender.h"

#include <algorithm>

namespace cia402::sim {
namespace {

constexpr Duration kStormInterval = std::chrono::milliseconds(1);
constexpr std::uint16_t kStormCode = 0x6100;  // internal software
constexpr std::uint8_t kGenericError = 0x01;
constexpr unsigned kChatters = 6;
constexpr Duration kChatterInterval = std::chrono::milliseconds(80);

}  // namespace

void EmergencySender::report(const FaultDefinition& fault, std::uint8_t error_register, Time now) {
  if (!fault.tells && fault.records) device_.rememberError(fault.code, fault.vendor);
  if (!fault.tells) return;
  device_.sendEmergency(fault.code, error_register, fault.vendor, now);
  if (!definition_.quirks.emergency_chatter) return;
  chatter_ = {&fault, error_register, kChatters, now + kChatterInterval};
}

void EmergencySender::errorsGone(std::uint8_t error_register, Time now) {
  const unsigned times = definition_.quirks.emergency_chatter ? kChatters : 1;
  for (unsigned i = 0; i < times; ++i) device_.clearEmergency(now, error_register);
  chatter_.at = kNever;
}

void EmergencySender::storm(Time now) {
  storm_at_ = now;
  tickStorm(now);
}

void EmergencySender::tickStorm(Time now) {
  if (storm_at_ > now) return;
  storm_at_ = now + kStormInterval;
  const auto count = static_cast<std::uint8_t>(++storm_count_);
  device_.sendEmergency(kStormCode, kGenericError, {count, 0, 0, 0, 0}, now);
}

void EmergencySender::tickChatter(Time now) {
  if (chatter_.at > now) return;
  const bool ends = chatter_.left-- % 2 == 0;
  if (ends) {
    device_.clearEmergency(now);
  } else {
    const FaultDefinition& fault = *chatter_.fault;
    device_.sendEmergency(fault.code, chatter_.error_register, fault.vendor, now);
  }
  chatter_.at = chatter_.left == 0 ? kNever : now + kChatterInterval;
}

void EmergencySender::tick(Time now) {
  tickStorm(now);
  tickChatter(now);
}

Time EmergencySender::nextEvent() const { return std::min(storm_at_, chatter_.at); }

std::uint8_t registerFor(std::uint16_t code) {
  switch (code >> 12) {
    case 0x2:
      return 0x03;
    case 0x3:
      return 0x05;
    case 0x4:
      return 0x09;
    case 0x8:
      return (code & 0xFF00) == 0x8600 ? 0x21 : 0x11;
    default:
      return 0x01;
  }
}

}  // namespace cia402::sim
