// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/call_desk.h"

#include <ros/advertise_service_options.h>
#include <std_srvs/Trigger.h>

#include <utility>

#include "ros/command_call.h"

namespace cia402::ros_node {

using std_srvs::Trigger;

CallDesk::CallDesk(std::function<void()> wake) : wake_(std::move(wake)) {}

CallDesk::~CallDesk() {
  for (Call* call = answered_.exchange(nullptr); call != nullptr;) {
    const std::unique_ptr<Call> done(std::exchange(call, call->next));
  }
}

ros::ServiceServer CallDesk::advertise(ros::NodeHandle& node, const std::string& name,
                                       Begin begin) {
  auto options = ros::AdvertiseServiceOptions::create<Trigger>(
      name,
      [this](Trigger::Request&, Trigger::Response& response) {
        return respond(current(), response);
      },
      ros::VoidConstPtr(), queueFor(std::move(begin)));
  return node.advertiseService(options);
}

ros::CallbackQueueInterface* CallDesk::queueFor(Begin begin) {
  counters_.push_back(std::make_unique<Counter>(*this, std::move(begin)));
  return counters_.back().get();
}

// In roscpp's thread that reads the sockets.
void CallDesk::Counter::addCallback(const ros::CallbackInterfacePtr& callback, uint64_t) {
  auto call = std::make_unique<Call>();
  call->callback = callback;
  begin_([desk = &desk_, waiting = call.release()](const bus::Answer& answer) {
    waiting->answer = answer;
    desk->answered(waiting);
  });
}

void CallDesk::answered(Call* call) {
  call->next = answered_.load(std::memory_order_relaxed);
  while (!answered_.compare_exchange_weak(call->next, call, std::memory_order_release,
                                          std::memory_order_relaxed)) {
  }
  wake_();
}

void CallDesk::answer() {
  Call* newest = answered_.exchange(nullptr, std::memory_order_acquire);
  Call* oldest = nullptr;  // turns them round: who was answered first hears it first
  while (newest != nullptr) {
    Call* const call = std::exchange(newest, newest->next);
    call->next = std::exchange(oldest, call);
  }
  while (oldest != nullptr) {
    const std::unique_ptr<Call> call(std::exchange(oldest, oldest->next));
    current_ = &call->answer;
    call->callback->call();
    current_ = nullptr;
  }
}

}  // namespace cia402::ros_node
