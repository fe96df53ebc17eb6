// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/ros/command_call.h"

#include <future>
#include <memory>

namespace cia402::ros_node {

bus::Answer call(bus::BusRunner& runner, decltype(bus::Command::body) body) {
  const auto promise = std::make_shared<std::promise<bus::Answer>>();
  bus::Command command;
  command.body = std::move(body);
  command.reply = [promise](const bus::Answer& answer) { promise->set_value(answer); };
  std::future<bus::Answer> answer = promise->get_future();
  runner.post(std::move(command));
  return answer.get();
}

}  // namespace cia402::ros_node
