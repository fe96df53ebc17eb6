// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/callback_queue_interface.h>

#include <functional>
#include <utility>

namespace cia402::ros_node {

/// What roscpp gives to a callback queue for each call of a service.
class Callback : public ros::CallbackInterface {
 public:
  explicit Callback(std::function<void()> work) : work_(std::move(work)) {}
  CallResult call() override {
    work_();
    return Success;
  }

 private:
  std::function<void()> work_;
};

}  // namespace cia402::ros_node
