// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SetMode.h>

#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SetMode;

void offerSetMode(Offer& offer) {
  offer.serve<SetMode>(
      "set_mode",
      [&runner = offer.runner, command = offer.procedure(drive::ProcedureKind::set_mode)](
          const SetMode::Request& request, SetMode::Response& response) {
        bus::ProcedureCommand wanted = command;
        wanted.request.mode = drive::canonicalModeName(request.mode);
        respond(call(runner, wanted), response);
      });
}

}  // namespace cia402::ros_node
