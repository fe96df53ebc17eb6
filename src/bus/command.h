// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bus/reply.h"
#include "bus/trajectory_order.h"
#include "cia402_driver/common/time.h"
#include "motion/trajectory.h"

namespace cia402::bus {

class AxisCycle;
class Network;

/// A bus as commands see it.
struct BusParts {
  AxisCycle& axes;   ///< what any bus has
  Network& network;  ///< with what CANopen alone has
  // That which a request's begin() takes:
  template <typename Request, typename... Others>
  AxisCycle& takenBy(void (Request::*)(AxisCycle&, Others...) const) const {
    return axes;
  }
  template <typename Request, typename... Others>
  Network& takenBy(void (Request::*)(Network&, Others...) const) const {
    return network;
  }
};

/// A set-point of the axis' active mode, rad or m, per s, N m or N. Answered only if refused.
struct SetpointCommand {
  using Answer = bus::Answer;
  std::size_t axis = 0;  ///< index in the configuration
  double value = 0.0;
  std::optional<Time> came{};  ///< to this program, in bus time; nothing: just now

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// Set-points for all joints of a group, each of its joint's active mode: all are taken for the
/// same cycle, or none, where one cannot be followed as it is. Answered only if refused.
struct GroupSetpointsCommand {
  using Answer = bus::Answer;
  std::size_t group = 0;       ///< index in the configuration
  std::vector<double> values;  ///< in the order of the group's joints
  std::optional<Time> came{};  ///< see SetpointCommand

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// Whether a trajectory was accepted.
struct TrajectoryAnswer : Answer {
  /// Of a refused one; that of a command that no group got is the first of them.
  motion::TrajectoryErrorCode code = motion::TrajectoryErrorCode::invalid_goal;
  std::size_t passed_points = 0;  ///< see TrajectoryOutcome
  bool slowed = false;            ///< likewise
};

/// A trajectory for a group; without points: stop, and what has ended is that all stand. Answered
/// once it was accepted or refused.
struct TrajectoryCommand {
  using Answer = TrajectoryAnswer;
  std::string group;
  std::vector<std::string> joints;
  std::vector<motion::TrajectoryPoint> points;
  std::optional<Time> start_time;
  TrajectoryTolerances tolerances;
  /// As topics have it: it may end in motion, and a single point is approached, however near it is.
  bool streamed = false;
  std::uint64_t id = 0;   ///< for CancelCommand; 0: nobody cancels it
  TrajectoryEnded ended;  ///< told how it ended, if it was accepted

  void begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const;
};

/// Brings a group to rest that follows the trajectory `id`, or is about to; else does nothing.
struct CancelCommand {
  using Answer = bus::Answer;
  std::string group;
  std::uint64_t id = 0;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// Where the joints of a group are commanded to be at a time, and how fast.
struct PlannedStateAnswer : Answer {
  std::vector<std::string> joints;
  std::vector<motion::MotionState> states;  ///< one a joint
};

/// Asks that of what runs, and of what waits for its time. A joint that nothing leads then is where
/// it was brought; one that is being stopped, or streamed, where that comes to rest. Refused where
/// a joint takes no trajectories, for a time before that which it follows has begun, and, where it
/// follows none but moves, for one more than 0.1 s ago.
struct PlannedStateCommand {
  using Answer = PlannedStateAnswer;
  std::string group;
  Time time{};

  void begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const;
};

/// Runs a function in the bus thread, e.g. to inject a fault into a simulated drive; also where
/// there is no bus.
struct CallCommand {
  using Answer = bus::Answer;
  std::function<bus::Answer(Time)> function;

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// What the bus thread is to do, on its way there, with the reply that it owes.
///
/// A request is a struct that says what is asked for, with
///     using Answer = ...;  // bus::Answer, or a type made from it
///     void begin(AxisCycle& cycle, const Reply<Answer>& reply, Time now) const;
/// or with Network& where it is of CANopen alone.
/// begin() gives the reply exactly once, at once or when the job that it adds has ended. What
/// streams lies in the command itself; any other request is taken to the heap, so that nothing here
/// names it.
class Command {
 public:
  /// Nothing is asked for; begin() must not be called.
  Command() = default;
  template <typename Request>
  explicit Command(Request request, Reply<typename Request::Answer> reply = {})
      : body_(bodyOf(Given<Request>{std::move(request), std::move(reply)})) {}

  /// Carries it out. @pre not empty
  void begin(const BusParts& bus, Time now) {
    withGiven([&](auto& given) { given.begin(bus, now); });
  }
  /// Replies that it is not carried out, for the reason `why`.
  void refuse(const std::string& why) {
    withGiven([&](auto& given) { given.refuse(why); });
  }
  /// It is out of date soon: it is carried out now or never.
  bool streams() const {
    return std::holds_alternative<Given<SetpointCommand>>(body_) ||
           std::holds_alternative<Given<GroupSetpointsCommand>>(body_) ||
           std::holds_alternative<Given<TrajectoryCommand>>(body_);
  }
  /// It makes sense only where frames reach the drives.
  bool needsBus() const { return !std::holds_alternative<Given<CallCommand>>(body_); }

 private:
  template <typename Request>
  struct Given {
    Request request;
    Reply<typename Request::Answer> reply;

    void begin(const BusParts& bus, Time now) {
      request.begin(bus.takenBy(&Request::begin), reply, now);
    }
    void refuse(const std::string& why) { bus::refuse(reply, why); }
  };
  class Erased {
   public:
    virtual ~Erased() = default;
    virtual void begin(const BusParts& bus, Time now) = 0;
    virtual void refuse(const std::string& why) = 0;
  };
  template <typename Request>
  class Boxed final : public Erased {
   public:
    explicit Boxed(Given<Request> given) : given_(std::move(given)) {}
    void begin(const BusParts& bus, Time now) override { given_.begin(bus, now); }
    void refuse(const std::string& why) override { given_.refuse(why); }

   private:
    Given<Request> given_;
  };
  using Body =
      std::variant<std::unique_ptr<Erased>, Given<SetpointCommand>, Given<GroupSetpointsCommand>,
                   Given<TrajectoryCommand>, Given<CallCommand>>;

  static Body bodyOf(Given<SetpointCommand> given) { return given; }
  static Body bodyOf(Given<GroupSetpointsCommand> given) { return given; }
  static Body bodyOf(Given<TrajectoryCommand> given) { return given; }
  static Body bodyOf(Given<CallCommand> given) { return given; }
  template <typename Request>
  static Body bodyOf(Given<Request> given) {
    return std::make_unique<Boxed<Request>>(std::move(given));
  }
  template <typename Use>
  void withGiven(Use use) {
    std::visit(
        [&](auto& body) {
          if constexpr (std::is_same_v<std::decay_t<decltype(body)>, std::unique_ptr<Erased>>) {
            use(*body);
          } else {
            use(body);
          }
        },
        body_);
  }

  Body body_;
};

}  // namespace cia402::bus
