// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/axis_unit.h"

namespace cia402::bus {

AxisUnit::AxisUnit(std::size_t number, const drive::AxisConfig& config, const Place& place,
                   EventSink& events)
    : index(number),
      axis(config, *place.device),
      reporter(number, place.who, config.profile, events),
      news(number, place.who, place.patience, events) {}

void AxisUnit::fillSeldom(AxisSnapshot& snapshot) const {
  snapshot.emergencies = reporter.emergencies();
  if (snapshot.signals_version != signals.version()) {
    snapshot.signals = signals.values();
    snapshot.signals_version = signals.version();
  }
  if (snapshot.words.version != news.words().version) snapshot.words = news.words();
}

}  // namespace cia402::bus
