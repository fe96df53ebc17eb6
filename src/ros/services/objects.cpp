// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/ReadObject.h>
#include <cia402_driver/WriteObject.h>

#include "bus/jobs/object_commands.h"
#include "common/text.h"
#include "ros/services/table.h"

namespace cia402::ros_node {
namespace {

using cia402_driver::ReadObject;
using cia402_driver::WriteObject;

}  // namespace

void offerObjects(Offer& offer) {
  offer.serve<ReadObject>(
      "read_object", [&runner = offer.runner, axis = offer.name()](
                         const ReadObject::Request& request, ReadObject::Response& response) {
        const bus::ObjectAnswer answer = call(runner, bus::ReadObjectCommand{axis, request.object});
        respond(answer, response);
        response.value = answer.text;
        response.raw = hexBytes(answer.data.data(), answer.data.size());
        response.number = answer.number;
        response.bytes = answer.data;
      });
  offer.serve<WriteObject>("write_object", [&runner = offer.runner, axis = offer.name()](
                                               const WriteObject::Request& request,
                                               WriteObject::Response& response) {
    respond(call(runner, bus::WriteObjectCommand{axis, request.object, request.value}), response);
  });
}

}  // namespace cia402::ros_node
