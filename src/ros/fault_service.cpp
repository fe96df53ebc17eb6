// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "ros/fault_service.h"

#include <cia402_driver/InjectFault.h>

namespace cia402::ros_node {

FaultService::FaultService(ros::NodeHandle& private_node, Inject inject)
    : inject_(std::move(inject)) {
  server_ = private_node.advertiseService<cia402_driver::InjectFault::Request,
                                          cia402_driver::InjectFault::Response>(
      "inject_fault", [this](cia402_driver::InjectFault::Request& request,
                             cia402_driver::InjectFault::Response& response) {
        const bus::Answer answer = inject_(request.axis, request.fault);
        response.success = answer.success;
        response.message = answer.message;
        return true;
      });
}

bus::Answer injectFault(sim::AxisOfDrive found, const std::string& axis, const std::string& fault,
                        Time now) {
  bus::Answer answer;
  if (found.drive == nullptr) {
    answer.message = "there is no simulated drive \"" + axis + "\"";
    return answer;
  }
  const Result<void> injected = found.drive->inject(fault, now, found.axis);
  answer.success = injected.ok();
  answer.message = injected ? axis + ": injected " + fault : axis + ": " + injected.error().message;
  return answer;
}

}  // namespace cia402::ros_node
