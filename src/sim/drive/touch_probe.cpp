// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/touch_probe.h"

namespace cia402::sim {
namespace {

// Of 60B8h, those of probe 1; those of probe 2 lie eight bits higher.
constexpr unsigned kEnable = 0x01, kContinuous = 0x02, kSource = 0x0C, kIndexPulse = 0x04,
                   kFirstEdge = 0x10, kOfProbe = 0x3F;
// Of 60B9h.
constexpr unsigned kEnabled = 0x01, kFirstStored = 0x02;
constexpr unsigned kPerProbe = 8;

Role roleOf(Role first, unsigned probe, unsigned edge) {
  return static_cast<Role>(static_cast<unsigned>(first) + 2 * probe + edge);
}

}  // namespace

void TouchProbes::start() {
  for (Probe& probe : probes_) probe.function = probe.stored = probe.taken = 0;
  publish();
}

void TouchProbes::command() {
  const auto word = static_cast<unsigned>(axis_.values.raw(Role::touch_probe_function, 0));
  for (unsigned i = 0; i < kProbes; ++i) command(probes_[i], (word >> (kPerProbe * i)) & kOfProbe);
  publish();
}

void TouchProbes::command(Probe& probe, unsigned function) const {
  const bool was_armed = (probe.function & kEnable) != 0;
  const bool armed = (function & kEnable) != 0;
  const ProbeForgets when = axis_.definition.probe_forgets;
  const bool forgets = (when == ProbeForgets::disarmed && !armed) ||
                       (when == ProbeForgets::armed && armed && !was_armed);
  if (forgets) probe.stored = 0;
  if (armed && !was_armed) probe.taken = 0;
  for (unsigned edge = 0; armed && edge < kEdges; ++edge) {  // one that is not wanted any more
    if ((function & (kFirstEdge << edge)) == 0) probe.stored &= ~(kFirstStored << edge);
  }
  probe.function = function;
}

void TouchProbes::setInput(unsigned probe, bool active) {
  if (probe < 1 || probe > kProbes) return;
  Probe& set = probes_[probe - 1];
  if (set.input == active) return;
  set.input = active;
  if ((set.function & kSource) == 0) store(probe - 1, active ? 0 : 1, axis_.motor.position());
  publish();
}

/// The pulse is so short that both its edges are at the same place.
void TouchProbes::turned(double from) {
  for (unsigned i = 0; i < kProbes; ++i) {
    if ((probes_[i].function & kEnable) == 0 || (probes_[i].function & kSource) != kIndexPulse) {
      continue;
    }
    const auto index = axis_.switches.indexBetween(from, axis_.motor.position());
    for (unsigned edge = 0; index && edge < kEdges; ++edge) store(i, edge, *index);
    if (index) publish();
  }
}

void TouchProbes::store(unsigned probe, unsigned edge, double turns) {
  Probe& of = probes_[probe];
  const bool wanted = (of.function & kEnable) != 0 && (of.function & (kFirstEdge << edge)) != 0;
  const unsigned bit = kFirstStored << edge;
  const bool again = (of.function & kContinuous) != 0;
  if (!wanted || ((of.taken & bit) != 0 && !again)) return;
  of.stored |= bit;
  of.taken |= bit;
  axis_.values.set(roleOf(Role::touch_probe_1_rising, probe, edge), turns - axis_.frame);
  const Role counter = roleOf(Role::touch_probe_1_rising_count, probe, edge);
  axis_.values.setRaw(counter, axis_.values.raw(counter, 0) + 1);
}

void TouchProbes::publish() {
  unsigned status = 0;
  for (unsigned i = 0; i < kProbes; ++i) {
    const unsigned enabled = (probes_[i].function & kEnable) != 0 ? kEnabled : 0;
    status |= (enabled | probes_[i].stored) << (kPerProbe * i);
  }
  axis_.values.setRaw(Role::touch_probe_status, status);
}

}  // namespace cia402::sim
