// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/Nmt.h>

#include "bus/canopen/nmt_command.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::Nmt;

void offerNmt(Offer& offer) {
  offer.serve<Nmt>("nmt", [&runner = offer.runner, axis = offer.name()](const Nmt::Request& request,
                                                                        Nmt::Response& response) {
    respond(call(runner, bus::NmtServiceCommand{axis, request.command}), response);
  });
}

}  // namespace cia402::ros_node
