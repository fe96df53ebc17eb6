// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/callback_queue.h>

#include <atomic>
#include <thread>
#include <vector>

namespace cia402::ros_node {

/// A few threads for services whose callbacks wait: as many calls as there are threads are served
/// at a time, further ones wait for their turn. The threads sleep while there is nothing to do.
class ServicePool {
 public:
  explicit ServicePool(unsigned threads);
  ~ServicePool() { stop(); }
  ServicePool(const ServicePool&) = delete;
  ServicePool& operator=(const ServicePool&) = delete;

  /// For the node handle of the services; must not outlive the pool.
  ros::CallbackQueueInterface* queue() { return &queue_; }
  /// Waits for the calls that are being served; those that wait for their turn are not answered.
  void stop();

 private:
  void serve();

  ros::CallbackQueue queue_;
  std::atomic<bool> ending_{false};
  std::vector<std::thread> threads_;
};

}  // namespace cia402::ros_node
