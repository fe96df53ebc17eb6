// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The procedures whose requests say nothing: std_srvs/Trigger.
#include "ros/services/table.h"

namespace cia402::ros_node {
namespace {

using drive::ProcedureKind;

/// After interface.md.
constexpr struct {
  const char* name;
  ProcedureKind kind;
  bool of_groups = true;
} kTriggers[] = {
    {"enable", ProcedureKind::enable},
    {"disable", ProcedureKind::disable},
    {"home", ProcedureKind::home},
    {"clear_faults", ProcedureKind::clear_faults},
    {"recover", ProcedureKind::recover},
    {"quick_stop", ProcedureKind::quick_stop},
    {"halt", ProcedureKind::halt},
    {"save_parameters", ProcedureKind::save_parameters, false},
    {"restore_parameters", ProcedureKind::restore_parameters, false},
};

}  // namespace

void offerTriggers(Offer& offer) {
  for (const auto& trigger : kTriggers) {
    if (offer.group != nullptr && !trigger.of_groups) continue;
    const auto begin = [&runner = offer.runner,
                        command = offer.procedure(trigger.kind)](bus::Reply<> reply) {
      runner.post(bus::Command(command, std::move(reply)));
    };
    offer.servers.push_back(offer.desk.advertise(offer.node, trigger.name, begin));
  }
}

}  // namespace cia402::ros_node
