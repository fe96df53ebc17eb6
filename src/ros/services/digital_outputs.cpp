// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SetDigitalOutputs.h>

#include "bus/jobs/output_job.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SetDigitalOutputs;

void offerDigitalOutputs(Offer& offer) {
  offer.serve<SetDigitalOutputs>(
      "set_digital_outputs",
      [&runner = offer.runner, axis = offer.name()](const SetDigitalOutputs::Request& request,
                                                    SetDigitalOutputs::Response& response) {
        const std::vector<bool> values(request.values.begin(), request.values.end());
        respond(call(runner, bus::SetOutputsCommand{axis, request.names, values}), response);
      });
}

}  // namespace cia402::ros_node
