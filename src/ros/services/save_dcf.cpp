// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/SaveDcf.h>

#include "ros/dcf_file.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::SaveDcf;

// The drive is read in the bus thread; the file is planned, worded and written here.
void offerSaveDcf(Offer& offer) {
  offer.serve<SaveDcf>(
      "save_dcf", [&runner = offer.runner, &axis = *offer.axis, &robot = offer.robot](
                      const SaveDcf::Request& request, SaveDcf::Response& response) {
        const auto stamp = dcfStamp(axis.name, request.path);
        if (!stamp) {
          response.message = stamp.error().message;
          return;
        }
        std::vector<const drive::AxisConfig*> others;
        for (const drive::AxisConfig& other : robot.axes) {
          if (other.device == axis.device && other.name != axis.name) others.push_back(&other);
        }
        bus::DcfDraft draft(axis, robot.deviceOf(axis), *stamp, others);
        const bus::Answer read = call(runner, draft.command());
        respond(read, response);
        if (!read.success) return;
        const bus::DcfAnswer file = draft.finish();
        respond(file, response);
        if (!file.success) return;
        const auto written = writeDcfFile(request.path, file.text);
        response.success = written.ok();
        response.message += written ? "; written to " + *written : "; " + written.error().message;
      });
}

}  // namespace cia402::ros_node
