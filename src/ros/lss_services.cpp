// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/ros/lss_services.h"

#include <cia402_driver/LssAssign.h>
#include <cia402_driver/LssScan.h>
#include <cia402_driver/LssSetBitTiming.h>

#include <algorithm>
#include <cmath>

#include "cia402_driver/ros/command_call.h"

namespace cia402::ros_node {
namespace {

using cia402_driver::LssAssign;
using cia402_driver::LssScan;
using cia402_driver::LssSetBitTiming;

constexpr double kLongestWindow = 2.0;  // s
constexpr double kLongestDelay = 60.0;  // s

/// Seconds of a request; 0 leaves `value` as it is. @return false for what makes no sense.
bool takeSeconds(double seconds, double longest, Duration& value) {
  if (!std::isfinite(seconds) || seconds < 0.0 || seconds > longest) return false;
  if (seconds > 0.0) value = fromSeconds(std::max(seconds, 0.001));
  return true;
}

}  // namespace

LssServices::LssServices(ros::NodeHandle& private_node, bus::BusRunner& runner) : runner_(runner) {
  servers_.push_back(private_node.advertiseService<LssScan::Request, LssScan::Response>(
      "lss_scan", [this](LssScan::Request& request, LssScan::Response& response) {
        bus::LssScanCommand command;
        if (!takeSeconds(request.window, kLongestWindow, command.window)) {
          response.message = "refused: the window must be 0 to 2 s";
          return true;
        }
        const bus::Answer answer = call(runner_, command);
        respond(answer, response);
        response.axes = answer.device_axes;
        for (const canopen::lss::Identity& identity : answer.devices) {
          cia402_driver::LssIdentity device;
          device.vendor_id = identity.vendor_id;
          device.product_code = identity.product_code;
          device.revision = identity.revision;
          device.serial = identity.serial;
          response.devices.push_back(device);
        }
        return true;
      }));
  servers_.push_back(private_node.advertiseService<LssAssign::Request, LssAssign::Response>(
      "lss_assign", [this](LssAssign::Request& request, LssAssign::Response& response) {
        bus::LssAssignCommand command;
        command.identity = {request.device.vendor_id, request.device.product_code,
                            request.device.revision, request.device.serial};
        command.node_id = request.node_id;
        command.store = request.store != 0;
        return respond(call(runner_, command), response);
      }));
  servers_.push_back(
      private_node.advertiseService<LssSetBitTiming::Request, LssSetBitTiming::Response>(
          "lss_set_bit_timing",
          [this](LssSetBitTiming::Request& request, LssSetBitTiming::Response& response) {
            bus::LssBitTimingCommand command;
            command.axis = request.axis;
            command.kbit_per_s = request.kbit_per_s;
            command.store = request.store != 0;
            command.activate = request.activate != 0;
            if (!takeSeconds(request.delay, kLongestDelay, command.delay)) {
              response.message = "refused: the delay must be 0 to 60 s";
              return true;
            }
            return respond(call(runner_, command), response);
          }));
}

}  // namespace cia402::ros_node
