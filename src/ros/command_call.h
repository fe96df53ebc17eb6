// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <future>
#include <memory>
#include <utility>

#include "bus/runner.h"

namespace cia402::ros_node {

/// Has the bus thread carry out a request and waits for its end: every job has a deadline, and each
/// command gets its reply.
template <typename Request>
typename Request::Answer call(bus::BusRunner& runner, Request request) {
  using Answer = typename Request::Answer;
  const auto promise = std::make_shared<std::promise<Answer>>();
  std::future<Answer> answer = promise->get_future();
  runner.post(bus::Command(std::move(request),
                           [promise](const Answer& given) { promise->set_value(given); }));
  return answer.get();
}

/// Puts an answer into the response of a service with `success` and `message`. @return true, as
/// ROS wants it: the service itself has worked.
template <typename Response>
bool respond(const bus::Answer& answer, Response& response) {
  response.success = answer.success;
  response.message = answer.message;
  return true;
}

}  // namespace cia402::ros_node
