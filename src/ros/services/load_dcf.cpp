// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/LoadDcf.h>

#include "bus/canopen/dcf_load.h"
#include "ros/dcf_file.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::LoadDcf;

// The file is read and worded here; the bus thread has the drive alone.
void offerLoadDcf(Offer& offer) {
  offer.serve<LoadDcf>("load_dcf", [&runner = offer.runner, &axis = *offer.axis,
                                    &robot = offer.robot](const LoadDcf::Request& request,
                                                          LoadDcf::Response& response) {
    const auto file = readDcfFile(axis.name, request.path);
    if (!file) {
      response.message = file.error().message;
      return;
    }
    const auto loading = bus::planDcf(file->text, file->name, axis, *robot.deviceOf(axis).profile);
    if (!loading) {
      response.message = loading.error().message;
      return;
    }
    const bus::LoadDcfCommand command{axis.name, *loading, request.confirm != 0};
    const bus::Answer answer = call(runner, command);
    respond(answer.success ? bus::dcfOutcome(**loading, axis) : answer, response);
  });
}

}  // namespace cia402::ros_node
