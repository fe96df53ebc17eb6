// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "bus/axis_news.h"
#include "bus/axis_reporter.h"
#include "bus/signal_watch.h"
#include "bus/snapshot.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

class CoupledAxes;

/// One axis and all that is kept of it, so that what it needs in a cycle lies together. It knows
/// the device that it sits in, and not which bus this is.
struct AxisUnit {
  /// What the bus says of the device.
  struct Place {
    fieldbus::Device* device = nullptr;
    std::string who;      ///< "shoulder (node 3)", for messages
    Duration patience{};  ///< for its first feedback, once it is ready
  };

  /// @param number of the axis, its index in the configuration.
  /// @param events must outlive it.
  AxisUnit(std::size_t number, const drive::AxisConfig& config, const Place& place,
           EventSink& events);

  /// The beginning of a cycle: takes what the device sent.
  void readFeedback(Time now) {
    axis.readFeedback(now);
    axis.update(now);
    const drive::AxisState& state = axis.state();
    if (state.health == fieldbus::Health::ready && state.stamp == last_feedback) ++missed_feedback;
    last_feedback = state.stamp;
  }
  /// Gives the device its commands of this cycle.
  void move(Time now) {
    axis.writeCommands(now);
    signals.watch(axis, now);
  }
  void fill(AxisSnapshot& snapshot) const {
    snapshot.state = axis.state();
    snapshot.target = axis.target();
    snapshot.procedure = axis.procedure().kind;
    snapshot.procedure_running = axis.procedure().running;
    snapshot.procedure_deadline = axis.procedure().deadline;
    snapshot.missed_feedback = missed_feedback;
    const EmergencyCounts& emergencies = reporter.emergencies();
    const bool more = snapshot.emergencies.total != emergencies.total ||
                      snapshot.emergencies.malformed != emergencies.malformed;
    if (more || snapshot.signals_version != signals.version() ||
        snapshot.words.version != news.words().version) {
      fillSeldom(snapshot);
    }
  }

  /// What is long and changes seldom.
  [[gnu::cold]] void fillSeldom(AxisSnapshot& snapshot) const;

  std::size_t index;
  drive::Axis axis;
  Time last_feedback{};
  std::uint64_t missed_feedback = 0;  ///< cycles without new feedback while the device was ready
  bool answered = false;              ///< by its device, beside the cycle, since it was looked at
  SignalWatch signals;
  AxisReporter reporter;
  AxisNews news;
  CoupledAxes* coupling = nullptr;  ///< that it is in; nullptr: it turns a joint by itself
};

}  // namespace cia402::bus
