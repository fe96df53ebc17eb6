// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SetPosition.h>

#include "bus/jobs/procedure_command.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SetPosition;

void offerSetPosition(Offer& offer) {
  offer.serve<SetPosition>(
      "set_position", [&runner = offer.runner, axis = offer.name()](
                          const SetPosition::Request& request, SetPosition::Response& response) {
        drive::ProcedureRequest wanted;
        wanted.kind = drive::ProcedureKind::set_position;
        wanted.position = request.position;
        respond(call(runner, bus::ProcedureCommand{axis, wanted}), response);
      });
}

}  // namespace cia402::ros_node
