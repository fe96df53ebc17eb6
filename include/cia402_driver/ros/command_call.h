// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "cia402_driver/bus/runner.h"

namespace cia402::ros_node {

/// Has the bus thread run a command and waits for its end: every procedure has a deadline, and each
/// command gets its reply.
bus::Answer call(bus::BusRunner& runner, decltype(bus::Command::body) body);

/// Puts an answer into the response of a service with `success` and `message`. @return true, as
/// ROS wants it: the service itself has worked.
template <typename Response>
bool respond(const bus::Answer& answer, Response& response) {
  response.success = answer.success;
  response.message = answer.message;
  return true;
}

}  // namespace cia402::ros_node
