// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/pdo_packing.h"
#include "config/robot.h"

namespace cia402::config {
namespace {

constexpr unsigned kTimeBytes = 6;

// Bits per second, as a part that follows SYNC and a part that does not.
struct Traffic {
  FrameBits per_sync, per_second;

  void addPerSync(FrameBits frame, double nominal, double worst) {
    per_sync.nominal += frame.nominal * nominal;
    per_sync.worst += frame.worst * worst;
  }
  void addPerSecond(FrameBits frame, double rate) {
    per_second.nominal += frame.nominal * rate;
    per_second.worst += frame.worst * rate;
  }
};

void addRpdo(const canopen::PdoConfig& pdo, FrameBits frame, Traffic& traffic) {
  // Its type only says when the drive takes it. It may change, and be sent, in every cycle.
  traffic.addPerSync(frame, 1.0 / pdo.refresh_every, 1.0);
}

void addTpdo(const canopen::PdoConfig& pdo, FrameBits frame, double period_s, Traffic& traffic) {
  if (canopen::isCyclic(pdo.transmission)) {
    traffic.addPerSync(frame, 1.0 / pdo.transmission, 1.0 / pdo.transmission);
    return;
  }
  if (canopen::isRequested(pdo.transmission)) {
    traffic.addPerSync(frame, 1.0 / pdo.request_every, 1.0 / pdo.request_every);
    traffic.addPerSync(remoteFrameBits(), 1.0 / pdo.request_every, 1.0 / pdo.request_every);
    return;
  }
  // On events: with every SYNC in the worst case, but no more often than its inhibit time allows.
  const double inhibit_s = pdo.inhibit * 1e-4;
  if (canopen::isEventDriven(pdo.transmission) && inhibit_s > period_s) {
    traffic.addPerSecond(frame, 1.0 / inhibit_s);
  } else {
    traffic.addPerSync(frame, 1.0, 1.0);
  }
}

void addPdo(const canopen::PdoConfig& pdo, double period_s, Traffic& traffic) {
  if (!pdo.enabled) return;
  unsigned bits = 0;
  for (const canopen::PdoEntry& entry : pdo.entries) bits += entry.bits;
  const FrameBits frame = frameBits((bits + 7) / 8);
  if (pdo.direction == canopen::PdoDirection::rpdo) {
    addRpdo(pdo, frame, traffic);
  } else {
    addTpdo(pdo, frame, period_s, traffic);
  }
}

void addRegular(unsigned bytes, Duration interval, Traffic& traffic) {
  if (interval > Duration(0)) traffic.addPerSecond(frameBits(bytes), 1.0 / toSeconds(interval));
}

BusLoad loadOf(const Traffic& traffic, double period_s, double bitrate) {
  BusLoad load;
  load.nominal = (traffic.per_sync.nominal / period_s + traffic.per_second.nominal) / bitrate;
  load.worst = (traffic.per_sync.worst / period_s + traffic.per_second.worst) / bitrate;
  if (traffic.per_sync.worst > 0.0) {
    load.feasible_rate =
        (kComfortableLoad * bitrate - traffic.per_second.worst) / traffic.per_sync.worst;
  }
  return load;
}

void addErrorControl(const canopen::NodeConfig& node, Traffic& traffic) {
  const bool guarding = node.error_control == canopen::ErrorControl::guarding;
  addRegular(1, guarding ? node.guard_time : node.heartbeat, traffic);
  if (guarding) addRegular(0, node.guard_time, traffic);  // the request carries no data
}

}  // namespace

BusLoad pdoLoad(const canopen::PdoConfig& pdo, Duration sync_period, double bitrate) {
  Traffic traffic;
  addPdo(pdo, toSeconds(sync_period), traffic);
  return loadOf(traffic, toSeconds(sync_period), bitrate);
}

BusLoad busLoad(const canopen::MasterConfig& master, double bitrate) {
  Traffic traffic;
  traffic.addPerSync(frameBits(master.sync_counter == 0 ? 0 : 1), 1.0, 1.0);
  const double period_s = toSeconds(master.sync_period);
  addRegular(1, master.heartbeat, traffic);
  addRegular(kTimeBytes, master.time_interval, traffic);
  for (const canopen::NodeConfig& node : master.nodes) {
    addErrorControl(node, traffic);
    for (const canopen::PdoConfig& pdo : node.pdos) addPdo(pdo, period_s, traffic);
  }
  return loadOf(traffic, period_s, bitrate);
}

}  // namespace cia402::config
