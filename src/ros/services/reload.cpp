// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <std_srvs/Trigger.h>

#include "ros/services/table.h"

namespace cia402::ros_node {

void offerReload(Offer& offer) {
  using std_srvs::Trigger;
  offer.serve<Trigger>(
      "reload", [&reloader = offer.reloader](const Trigger::Request&, Trigger::Response& response) {
        respond(reloader.reload(), response);
      });
}

}  // namespace cia402::ros_node
