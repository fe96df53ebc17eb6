// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The layer setting services: ~lss_scan, ~lss_assign, ~lss_set_bit_timing.
#include <cia402_driver/LssAssign.h>
#include <cia402_driver/LssScan.h>
#include <cia402_driver/LssSetBitTiming.h>

#include <algorithm>
#include <cmath>

#include "bus/canopen/lss_commands.h"
#include "ros/services/table.h"

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

void scan(bus::BusRunner& runner, const LssScan::Request& request, LssScan::Response& response) {
  bus::LssScanCommand command;
  if (!takeSeconds(request.window, kLongestWindow, command.window)) {
    response.message = "refused: the window must be 0 to 2 s";
    return;
  }
  const bus::LssScanAnswer answer = call(runner, command);
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
}

void assign(bus::BusRunner& runner, const LssAssign::Request& request,
            LssAssign::Response& response) {
  bus::LssAssignCommand command;
  command.identity = {request.device.vendor_id, request.device.product_code,
                      request.device.revision, request.device.serial};
  command.node_id = request.node_id;
  command.store = request.store != 0;
  respond(call(runner, command), response);
}

void setBitTiming(bus::BusRunner& runner, const LssSetBitTiming::Request& request,
                  LssSetBitTiming::Response& response) {
  bus::LssBitTimingCommand command;
  command.axis = request.axis;
  command.kbit_per_s = request.kbit_per_s;
  command.store = request.store != 0;
  command.activate = request.activate != 0;
  if (!takeSeconds(request.delay, kLongestDelay, command.delay)) {
    response.message = "refused: the delay must be 0 to 60 s";
    return;
  }
  respond(call(runner, command), response);
}

}  // namespace

void offerLss(Offer& offer) {
  bus::BusRunner& runner = offer.runner;
  offer.serve<LssScan>("lss_scan",
                       [&runner](const LssScan::Request& request, LssScan::Response& response) {
                         scan(runner, request, response);
                       });
  offer.serve<LssAssign>(
      "lss_assign", [&runner](const LssAssign::Request& request, LssAssign::Response& response) {
        assign(runner, request, response);
      });
  offer.serve<LssSetBitTiming>(
      "lss_set_bit_timing",
      [&runner](const LssSetBitTiming::Request& request, LssSetBitTiming::Response& response) {
        setBitTiming(runner, request, response);
      });
}

}  // namespace cia402::ros_node
