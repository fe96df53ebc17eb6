// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/reply.h"

namespace cia402::ros_node {

/// Services of type std_srvs/Trigger whose calls wait for their answers without a thread, however
/// many there are: what a call asks for begins in the moment in which it arrives, and roscpp's
/// callback is called when the answer is there. So no call is ever behind another one.
///
/// roscpp gives the callback of a call to the callback queue of its service and sends the response
/// when that has returned. Each of these services has a queue of its own that keeps it until then.
class CallDesk {
 public:
  /// What a call asks for: must not wait, and gives the reply exactly once, from any thread. A
  /// reply that is dropped leaks its call.
  using Begin = std::function<void(bus::Reply<> reply)>;

  /// @param wake called where answer() has something to do; any thread, must not wait.
  explicit CallDesk(std::function<void()> wake);
  /// Nothing may reply any more.
  ~CallDesk();
  CallDesk(const CallDesk&) = delete;
  CallDesk& operator=(const CallDesk&) = delete;

  /// Offers a service. The server must not outlive the desk.
  ros::ServiceServer advertise(ros::NodeHandle& node, const std::string& name, Begin begin);
  /// The callback queue of such a service; the desk's. A callback is called once, in answer().
  ros::CallbackQueueInterface* queueFor(Begin begin);
  /// In a callback: the answer to its call.
  const bus::Answer& current() const { return *current_; }
  /// One thread: sends the answers that have come since the last time.
  void answer();

 private:
  /// A call from its arrival to its answer.
  struct Call {
    ros::CallbackInterfacePtr callback;
    bus::Answer answer;
    Call* next = nullptr;  // of the answered ones, the one before
  };
  /// The callback queue of one service.
  class Counter : public ros::CallbackQueueInterface {
   public:
    Counter(CallDesk& desk, Begin begin) : desk_(desk), begin_(std::move(begin)) {}
    void addCallback(const ros::CallbackInterfacePtr& callback, uint64_t owner) override;
    /// Nothing to do: roscpp has dropped the connections of a service that ends, and to call back
    /// for such a one does nothing.
    void removeByID(uint64_t) override {}

   private:
    CallDesk& desk_;
    Begin begin_;
  };

  void answered(Call* call);

  std::function<void()> wake_;
  std::vector<std::unique_ptr<Counter>> counters_;
  // A stack, so that the thread of the bus hands a call over without a lock and without memory.
  std::atomic<Call*> answered_{nullptr};
  const bus::Answer* current_ = nullptr;  // of the callback that answer() calls
};

}  // namespace cia402::ros_node
