// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sync/time_producer.h"

namespace cia402::canopen {
namespace {

constexpr std::uint32_t kTimeCobId = 0x100;  // default of 1012h
constexpr std::int64_t kDaysTo1984 = 5113;   // 14 years and 3 leap days
constexpr std::int64_t kMsPerDay = 86'400'000;
constexpr std::int64_t kLastDay = 0xFFFF;

std::uint8_t byteOf(std::int64_t value, int byte) {
  return static_cast<std::uint8_t>(value >> (8 * byte));
}

}  // namespace

std::optional<can::Frame> timeFrame(UnixTime time) {
  const std::int64_t ms = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  if (ms < kDaysTo1984 * kMsPerDay) return {};
  const std::int64_t days = ms / kMsPerDay - kDaysTo1984;
  const std::int64_t of_day = ms % kMsPerDay;
  if (days > kLastDay) return {};
  return can::Frame(kTimeCobId, {byteOf(of_day, 0), byteOf(of_day, 1), byteOf(of_day, 2),
                                 byteOf(of_day, 3), byteOf(days, 0), byteOf(days, 1)});
}

void TimeProducer::setWallTime(UnixTime wall, Time now) { offset_ = wall - now.time_since_epoch(); }

void TimeProducer::start(Time now) {
  if (enabled()) deadline_ = now;
}

void TimeProducer::tick(can::Sink& sink, Time now) {
  if (now < deadline_) return;
  deadline_ += interval_;
  if (deadline_ <= now) deadline_ = now + interval_;  // woken late: no burst to catch up
  if (!offset_) return;
  if (const auto frame = timeFrame(*offset_ + now.time_since_epoch())) sink.send(*frame);
}

}  // namespace cia402::canopen
