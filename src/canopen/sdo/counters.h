// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// What an SDO client has done since it exists; the numbers only grow.
struct SdoCounters {
  std::uint64_t completed = 0;  ///< transfers
  std::uint64_t aborted = 0;    ///< transfers ended by the server, or by us for broken protocol
  std::uint64_t timeouts = 0;
  std::uint64_t retries = 0;       ///< transfers begun again, sub-blocks asked for again
  std::uint64_t stray_frames = 0;  ///< answers to nothing, repeated or late ones
  std::uint64_t fences = 0;        ///< reads to have done with an abandoned transfer
  std::uint64_t bytes = 0;         ///< of completed transfers
  Duration busy{};                 ///< time that completed transfers took, queueing not included
  std::uint64_t answers = 0;       ///< to single requests, the base of the latencies
  Duration last_latency{}, longest_latency{}, total_latency{};

  /// From request to answer; zero before the first one.
  Duration meanLatency() const {
    return answers == 0 ? Duration::zero() : total_latency / static_cast<std::int64_t>(answers);
  }
  /// Bytes per second over all completed transfers; 0 before the first one.
  double throughput() const {
    return busy <= Duration::zero() ? 0.0 : static_cast<double>(bytes) / toSeconds(busy);
  }
};

}  // namespace cia402::canopen
