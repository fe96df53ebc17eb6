// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ros/callback_queue.h>

#include <functional>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::ros_node {

/// The work of a node's main thread: callbacks of topics, and tasks at regular times. The thread
/// sleeps until there is something to do, so that an idle node wakes no oftener than its tasks
/// want.
class EventLoop {
 public:
  EventLoop();
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// For node handles: what is called back in step().
  ros::CallbackQueueInterface* queue() { return &queue_; }
  /// Called at the beginning of every step().
  void always(std::function<void()> task) { always_.push_back(std::move(task)); }
  /// Called at each whole multiple of `period` (> 0) since the loop was made, so that one waking
  /// serves tasks of several periods. What is too late is left out, never made good.
  /// @param wanted where it is given and says no, the task is left out, and nobody wakes for it
  /// @return its number, for retime()
  std::size_t every(Duration period, std::function<void()> task, std::function<bool()> wanted = {});
  /// Gives a task another period (> 0). Not to be called by a task.
  void retime(std::size_t task, Duration period);
  /// Any thread: ends the sleep of step(). Never waits.
  void wake() const;
  /// An eventfd: to write to it is wake(), for signal handlers.
  int wakeFd() const { return wake_fd_; }

  /// One thread: sleeps until a task is due or something has woken it, and does what there is.
  void step();

 private:
  /// A queue of roscpp that wakes the loop.
  class Queue : public ros::CallbackQueueInterface {
   public:
    explicit Queue(const EventLoop& loop) : loop_(loop) {}
    void addCallback(const ros::CallbackInterfacePtr& callback, uint64_t owner) override {
      waiting_.addCallback(callback, owner);
      loop_.wake();
    }
    void removeByID(uint64_t owner) override { waiting_.removeByID(owner); }
    void callAll() { waiting_.callAvailable(); }

   private:
    const EventLoop& loop_;
    ros::CallbackQueue waiting_;
  };
  struct Task {
    Duration period;
    Time due;
    std::function<void()> work;
    std::function<bool()> wanted;

    bool counts() const { return !wanted || wanted(); }
  };

  void sleep();

  int wake_fd_;
  Queue queue_{*this};
  std::vector<std::function<void()>> always_;
  std::vector<Task> tasks_;
  Time began_;
};

}  // namespace cia402::ros_node
