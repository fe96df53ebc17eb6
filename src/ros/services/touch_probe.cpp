// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/ArmTouchProbe.h>

#include "bus/jobs/touch_probe_job.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::ArmTouchProbe;

void offerTouchProbe(Offer& offer) {
  offer.serve<ArmTouchProbe>("arm_touch_probe", [&runner = offer.runner, axis = offer.name()](
                                                    const ArmTouchProbe::Request& request,
                                                    ArmTouchProbe::Response& response) {
    bus::ArmTouchProbeCommand command;
    command.axis = axis;
    command.probe = request.probe;
    command.edge = request.edge;
    command.index_pulse = request.index_pulse != 0;
    command.continuous = request.continuous != 0;
    command.timeout = request.timeout;
    const bus::TouchProbeAnswer answer = call(runner, command);
    respond(answer, response);
    response.rising = answer.rising;
    response.falling = answer.falling;
  });
}

}  // namespace cia402::ros_node
