// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/service_pool.h"

#include <pthread.h>

namespace cia402::ros_node {
namespace {

constexpr double kUntilWoken = 3600.0;  // s; roscpp knows no wait without an end

}  // namespace

ServicePool::ServicePool(unsigned threads) {
  for (unsigned i = 0; i < threads; ++i) threads_.emplace_back([this] { serve(); });
}

void ServicePool::stop() {
  ending_ = true;
  queue_.disable();  // wakes all of them
  for (std::thread& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void ServicePool::serve() {
  pthread_setname_np(pthread_self(), "service");
  while (!ending_) queue_.callOne(ros::WallDuration(kUntilWoken));
}

}  // namespace cia402::ros_node
