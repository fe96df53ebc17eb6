// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/limit_reports.h"

#include <string>

namespace cia402::sim {

const FaultDefinition* LimitReports::Kind::faultOf(const Seen& seen,
                                                   const DriveDefinition& definition) {
  const FaultDefinition* fault =
      definition.fault((seen.upwards ? "positive_" : "negative_") + std::string(seen.name));
  if (fault == nullptr) fault = definition.fault(seen.name);
  if (fault != nullptr && fault->warning) warning_ = fault;
  return fault;
}

}  // namespace cia402::sim
