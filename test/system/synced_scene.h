// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cia402_driver/sim/sync_producer.h"
#include "system/scene.h"

namespace cia402 {

/// The robot follows SYNC of another device; `more` are further keys of `bus`.
inline std::string syncExternal(std::string yaml = genericPair(), const std::string& more = {}) {
  return yaml.replace(yaml.find("heartbeat: 0.1"), 14, "heartbeat: 0.1, sync: external" + more);
}

/// A whole robot in virtual time and another device that produces SYNC from the start.
class SyncedScene : public Scene {
 public:
  explicit SyncedScene(const std::string& yaml = syncExternal(),
                       const sim::SyncSchedule& schedule = {})
      : Scene(loadText(yaml)) {
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
