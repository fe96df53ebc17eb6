// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SetMode.h>

#include "bus/jobs/procedure_command.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SetMode;

void offerSetMode(Offer& offer) {
  offer.serve<SetMode>(
      "set_mode", [&runner = offer.runner, axis = offer.name()](const SetMode::Request& request,
                                                                SetMode::Response& response) {
        drive::ProcedureRequest wanted;
        wanted.kind = drive::ProcedureKind::set_mode;
        wanted.mode = drive::canonicalModeName(request.mode);
        respond(call(runner, bus::ProcedureCommand{axis, wanted}), response);
      });
}

}  // namespace cia402::ros_node
