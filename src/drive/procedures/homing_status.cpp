// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/homing_status.h"

namespace cia402::drive {
namespace {

struct Row {
  bool error, attained, reached;
  HomingStatus status;
};
constexpr Row kTable[] = {
    {false, false, false, HomingStatus::in_progress},
    {false, false, true, HomingStatus::interrupted},
    {false, true, false, HomingStatus::attained_moving},
    {false, true, true, HomingStatus::completed},
    {true, false, false, HomingStatus::error_moving},
    {true, false, true, HomingStatus::error_stopped},
    {true, true, false, HomingStatus::contradictory},
    {true, true, true, HomingStatus::contradictory},
};
constexpr const char* kStatusNames[] = {"homing in progress",
                                        "homing interrupted or not started",
                                        "home found, still moving",
                                        "homing completed",
                                        "homing error, still moving",
                                        "homing error, stopped",
                                        "homing attained and error at once (reserved by CiA 402)"};

bool bitSet(std::uint16_t word, int bit) {
  return bit >= 0 && bit < 16 && ((static_cast<unsigned>(word) >> bit) & 1u) != 0;
}

}  // namespace

const char* toString(HomingStatus status) { return kStatusNames[static_cast<std::size_t>(status)]; }

HomingStatus decodeHoming(std::uint16_t statusword, const ModeSpec& mode, bool stands) {
  const bool error = bitSet(statusword, mode.homing_error_bit.value_or(13));
  const bool attained = bitSet(statusword, mode.homing_attained_bit.value_or(12));
  // Without that bit an axis that turns round at its switch must not look like one that has ended.
  const bool reached = mode.target_reached_bit ? bitSet(statusword, *mode.target_reached_bit)
                                               : stands && (attained || error);
  for (const Row& row : kTable) {
    if (row.error == error && row.attained == attained && row.reached == reached) return row.status;
  }
  return HomingStatus::contradictory;
}

}  // namespace cia402::drive
