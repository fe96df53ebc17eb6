// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What people are told of PDOs that do not come as they should.
#include "cia402_driver/bus/robot.h"
#include "cia402_driver/canopen/pdo/text.h"

namespace cia402::bus {
namespace {

constexpr Duration kPdoNewsInterval = std::chrono::seconds(1);  // per node

}  // namespace

void Robot::watchPdos(std::size_t axis, Time now) {
  AxisNews& news = news_[axis];
  const canopen::Node& node = *nodes_[axis];
  const canopen::PdoImage& image = node.image();
  const bool short_or_long = image.wrongLengths() != news.wrong_lengths;
  const bool stale = image.staleCount() != news.stale_count;
  if (now < news.pdos_told + kPdoNewsInterval) return;
  news.pdos_told = now;
  const std::string overdue = canopen::staleText(image);
  news.words.say(&AxisWords::stale, overdue);
  const std::string who = node.who() + ": ";
  if (short_or_long) {
    tell(Event::Severity::warning,
         who + canopen::wrongLengthText(image) +
             "; the drive maps other objects than configured, or another device uses that COB-ID",
         now);
  }
  if (stale && !overdue.empty() && !node.paused()) {
    tell(Event::Severity::warning,
         who + overdue +
             ": its values are stale and shown as unknown; check cable, bus load and "
             "the drive's TPDOs",
         now);
  }
  news.wrong_lengths = image.wrongLengths();
  news.stale_count = image.staleCount();
  news.pdo_troubles = image.troubles();
}

}  // namespace cia402::bus
