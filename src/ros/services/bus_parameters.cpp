// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SetBusParameters.h>

#include "bus/canopen/bus_setting_job.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SetBusParameters;

void offerBusParameters(Offer& offer) {
  offer.serve<SetBusParameters>("set_bus_parameters", [&runner = offer.runner, axis = offer.name()](
                                                          const SetBusParameters::Request& request,
                                                          SetBusParameters::Response& response) {
    bus::SetBusParametersCommand command;
    command.axis = axis;
    command.node_id = request.node_id;
    command.bit_rate = request.bit_rate;
    command.confirm = request.confirm != 0;
    respond(call(runner, command), response);
  });
}

}  // namespace cia402::ros_node
