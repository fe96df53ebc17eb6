// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/FactoryReset.h>

#include "bus/jobs/factory_reset.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::FactoryReset;

void offerFactoryReset(Offer& offer) {
  offer.serve<FactoryReset>(
      "factory_reset", [&runner = offer.runner, axis = offer.name()](
                           const FactoryReset::Request& request, FactoryReset::Response& response) {
        respond(call(runner, bus::FactoryResetCommand{axis, request.confirm != 0}), response);
      });
}

}  // namespace cia402::ros_node
