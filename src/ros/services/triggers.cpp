// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The procedures whose requests say nothing: std_srvs/Trigger.
#include "bus/jobs/procedure_command.h"
#include "ros/services/table.h"

namespace cia402::ros_node {
namespace {

using drive::ProcedureKind;

/// After interface.md.
constexpr struct {
  const char* name;
  ProcedureKind kind;
} kTriggers[] = {
    {"enable", ProcedureKind::enable},
    {"disable", ProcedureKind::disable},
    {"home", ProcedureKind::home},
    {"clear_faults", ProcedureKind::clear_faults},
    {"recover", ProcedureKind::recover},
    {"quick_stop", ProcedureKind::quick_stop},
    {"halt", ProcedureKind::halt},
    {"save_parameters", ProcedureKind::save_parameters},
    {"restore_parameters", ProcedureKind::restore_parameters},
};

}  // namespace

void offerTriggers(Offer& offer) {
  for (const auto& trigger : kTriggers) {
    const auto begin = [&runner = offer.runner, axis = offer.name(),
                        kind = trigger.kind](bus::Reply<> reply) {
      drive::ProcedureRequest request;
      request.kind = kind;
      runner.post(bus::Command(bus::ProcedureCommand{axis, request}, std::move(reply)));
    };
    offer.servers.push_back(offer.desk.advertise(offer.node, trigger.name, begin));
  }
}

}  // namespace cia402::ros_node
