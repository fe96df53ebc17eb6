// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <std_srvs/Trigger.h>

#include "ros/services/table.h"

namespace cia402::ros_node {

void offerDumpRecording(Offer& offer) {
  using std_srvs::Trigger;
  offer.serve<Trigger>("dump_recording", [&runner = offer.runner](const Trigger::Request&,
                                                                  Trigger::Response& response) {
    const bus::RecordingService::News news = runner.recordings().request();
    response.success = news.written;
    response.message = news.text;
  });
}

}  // namespace cia402::ros_node
