// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <control_msgs/QueryTrajectoryState.h>

#include <stdexcept>

#include "ros/clock_map.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using control_msgs::QueryTrajectoryState;

/// Its answer has no room for a reason: what is refused is a failed call, with the reason as its
/// error.
void offerQueryState(Offer& offer) {
  offer.serve<QueryTrajectoryState>(
      "query_state",
      [&runner = offer.runner, group = offer.group->name](
          const QueryTrajectoryState::Request& request, QueryTrajectoryState::Response& response) {
        const auto answer =
            call(runner, bus::PlannedStateCommand{group, fromRos(runner.time(), request.time)});
        if (!answer.success) throw std::runtime_error(answer.message);
        response.name = answer.joints;
        for (const motion::MotionState& state : answer.states) {
          response.position.push_back(state.position);
          response.velocity.push_back(state.velocity);
          response.acceleration.push_back(state.acceleration);
        }
      });
}

}  // namespace cia402::ros_node
