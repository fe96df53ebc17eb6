// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "sim/world/sync_producer.h"
#include "system/scene.h"

namespace cia402 {

/// The robot follows SYNC of another device.
inline std::string syncExternal(const std::string& yaml = genericPair()) {
  return withBus("sync: external", yaml);
}

/// A whole robot in virtual time and another device that produces SYNC from the start.
class SyncedScene : public Scene {
 public:
  explicit SyncedScene(const std::string& yaml = syncExternal(),
                       const sim::SyncSchedule& schedule = {}, std::uint64_t seed = 1)
      : Scene(loadText(yaml), seed) {
    producer_.connect(world().addParticipant("producer", producer_));
    produce(schedule);
  }
  /// From one period on.
  void produce(const sim::SyncSchedule& schedule = {}) {
    producer_.start(schedule, now() + schedule.period);
  }
  void cease() { producer_.stop(); }
  /// Until SYNC has come for long enough to be known.
  bool boot() {
    if (!Scene::boot()) return false;
    run(std::chrono::milliseconds(300));
    return true;
  }

 private:
  sim::SyncProducer producer_{11};
};

}  // namespace cia402
