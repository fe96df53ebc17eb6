// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/event_log.h"

#include <cia402_driver/Emergency.h>
#include <ros/console.h>

#include "ros/clock_map.h"

namespace cia402::ros_node {

EventLog::EventLog(ros::NodeHandle& private_node, bus::BusRunner& runner, bus::ReplyLog& replies,
                   const config::RobotConfig& robot)
    : runner_(runner), replies_(replies), robot_(robot) {
  emergencies_ = private_node.advertise<cia402_driver::Emergency>("emergencies", 10000);
}

void EventLog::drain() {
  bus::Event event;
  while (runner_.nextEvent(event)) {
    switch (event.severity) {
      case bus::Event::Severity::info:
        ROS_INFO_STREAM(event.text.view());
        break;
      case bus::Event::Severity::warning:
        ROS_WARN_STREAM(event.text.view());
        break;
      case bus::Event::Severity::error:
        ROS_ERROR_STREAM(event.text.view());
        break;
    }
  }
  drainReplies();
  bus::RecordingService::News news;
  while (runner_.recordings().nextNews(news)) {
    if (news.written) {
      ROS_WARN_STREAM(news.text);
    } else {
      ROS_ERROR_STREAM(news.text);
    }
  }
  bus::EmergencyEvent emergency;
  while (runner_.nextEmergency(emergency)) publish(emergency);
  const std::uint64_t lost = runner_.lostEvents();
  if (lost != lost_told_) {
    ROS_WARN_STREAM(lost - lost_told_ << " events came too fast to be logged");
    lost_told_ = lost;
  }
  const std::uint64_t unpublished = runner_.lostEmergencies();
  if (unpublished != unpublished_told_) {
    ROS_WARN_STREAM(unpublished - unpublished_told_
                    << " emergencies came too fast to be published; they are counted");
    unpublished_told_ = unpublished;
  }
}

void EventLog::drainReplies() {
  bus::ReplyLog::Entry entry;
  while (replies_.next(entry)) {
    switch (entry.level) {
      case bus::ReplyLog::Level::debug:
        ROS_DEBUG_STREAM(entry.text.view());
        break;
      case bus::ReplyLog::Level::warning:
        ROS_WARN_STREAM(entry.text.view());
        break;
      case bus::ReplyLog::Level::error:
        ROS_ERROR_STREAM(entry.text.view());
        break;
    }
  }
  const std::uint64_t lost = replies_.lost();
  if (lost == replies_lost_told_) return;
  ROS_WARN_STREAM(lost - replies_lost_told_ << " refused commands came too fast to be logged");
  replies_lost_told_ = lost;
}

void EventLog::publish(const bus::EmergencyEvent& event) {
  const drive::AxisConfig& axis = robot_.axes[event.axis];
  cia402_driver::Emergency message;
  message.header.stamp = toRos(runner_.time(), event.emergency.stamp);
  message.node_id = robot_.deviceOf(axis).node_id;
  for (const drive::AxisConfig& other : robot_.axes) {
    if (other.device == axis.device) message.axes.push_back(other.name);
  }
  message.error_code = event.emergency.code;
  message.error_register = event.emergency.error_register;
  std::copy(event.emergency.vendor.begin(), event.emergency.vendor.end(),
            message.manufacturer.begin());
  const auto known = axis.profile->errors.find(event.emergency.code);
  if (known == axis.profile->errors.end()) {
    message.text = fieldbus::emergencyText(event.emergency.code);
  } else {
    message.text = known->second.text;
    message.remedy =
        known->second.cause + (known->second.cause.empty() ? "" : "; ") + known->second.remedy;
  }
  emergencies_.publish(message);
}

}  // namespace cia402::ros_node
