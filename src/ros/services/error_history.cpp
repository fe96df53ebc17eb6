// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cia402_driver/ErrorHistory.h>

#include "bus/canopen/history_command.h"
#include "bus/canopen/history_job.h"
#include "ros/services/table.h"

namespace cia402::ros_node {

using cia402_driver::ErrorHistory;

void offerErrorHistory(Offer& offer) {
  offer.serve<ErrorHistory>(
      "error_history", [&runner = offer.runner, &axis = *offer.axis](
                           const ErrorHistory::Request&, ErrorHistory::Response& response) {
        const bus::HistoryAnswer answer = call(runner, bus::ErrorHistoryCommand{axis.name});
        respond(answer, response);
        for (const canopen::ErrorHistoryEntry& entry : answer.history.entries) {
          response.codes.push_back(entry.code);
          response.infos.push_back(entry.info);
          response.texts.push_back(bus::historyCodeText(*axis.profile, entry.code));
        }
      });
}

}  // namespace cia402::ros_node
