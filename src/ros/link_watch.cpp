// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/link_watch.h"

#include <ros/console.h>

#include <algorithm>

#include "bus/real_clock.h"
#include "can/socketcan.h"

namespace cia402::ros_node {
namespace {

constexpr Duration kAskEvery = std::chrono::seconds(1);
constexpr Duration kOnTime =
    std::chrono::milliseconds(5);  // of the caller's timer: that is on time

}  // namespace

LinkWatch::LinkWatch(const config::BusConfig& bus, can::SocketCan* socket)
    : bus_(bus), socket_(socket), hears_all_(bus.receive_all), meter_(bus.bitrate) {}

void LinkWatch::update(const bus::NetworkSnapshot& snapshot) {
  if (socket_ == nullptr) return;
  const bool unforeseen = std::any_of(snapshot.axes.begin(), snapshot.axes.end(),
                                      [](const auto& axis) { return axis.node.own_cob_ids; });
  if (unforeseen && !hears_all_) {
    socket_->setFilters({});
    hears_all_ = true;
    ROS_INFO(
        "a drive insists on COB-IDs of its own: all frames of the bus are received from now "
        "on, as with `receive: all` under `bus`");
  }
  const Time now = bus::realNow();
  if (now + kOnTime < next_) return;
  next_ = now + kAskEvery;
  settings_ = reader_.read(bus_.interface);
  if (settings_) {
    meter_.update(*settings_, now);
  } else {
    meter_.reset();
  }
}

can::TrafficMeter::Load LinkWatch::load(const bus::NetworkSnapshot& snapshot) const {
  if (!filtered()) return {snapshot.bus_load, snapshot.most_bus_load};
  return meter_.load().value_or(can::TrafficMeter::Load());
}

}  // namespace cia402::ros_node
