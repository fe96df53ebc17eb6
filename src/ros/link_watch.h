// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "bus/snapshot.h"
#include "can/link_settings.h"
#include "can/traffic_meter.h"
#include "config/robot.h"

namespace cia402::can {
class SocketCan;
}

namespace cia402::ros_node {

/// What is asked of the kernel beside the cycle, as it may take its time to answer: settings of the
/// interface, the load of the bus, other receive filters. Of the main thread.
class LinkWatch {
 public:
  /// @param socket nullptr where the drives are simulated; must outlive this.
  LinkWatch(const config::BusConfig& bus, can::SocketCan* socket);

  /// Asks the kernel once a second; where a drive turns out to insist on COB-IDs that the receive
  /// filters do not pass, takes them off. To be called ten times as often.
  void update(const bus::NetworkSnapshot& snapshot);

  /// Nothing where there is no interface of the kernel.
  const std::optional<can::LinkSettings>& settings() const { return settings_; }
  /// Of the bus, over the last second: as the kernel counts where the driver does not hear
  /// everything, else as the driver does.
  can::TrafficMeter::Load load(const bus::NetworkSnapshot& snapshot) const;

 private:
  bool filtered() const { return socket_ != nullptr && !hears_all_; }

  const config::BusConfig& bus_;
  can::SocketCan* socket_;
  bool hears_all_;
  can::LinkReader reader_;
  can::TrafficMeter meter_;
  std::optional<can::LinkSettings> settings_;
  Time next_{};
};

}  // namespace cia402::ros_node
