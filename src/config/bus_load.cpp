// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/config/robot.h"

namespace cia402::config {
namespace {

/// Bits of a classic CAN data frame with an 11-bit identifier and `bytes` of data, the three bits
/// between frames included.
struct FrameBits {
  double nominal, worst;
};

// Nominal: SOF 1, identifier 11, RTR, IDE, r0, DLC 4, data, CRC 15 + 1, ACK 2, EOF 7, pause 3.
// Worst: of the 34 + 8n bits that are stuffed, one more after the first five and then after each
// four (Davis, Burns, Bril, Lukkien 2007).
FrameBits frameBits(unsigned bytes) {
  const unsigned stuffable = 34 + 8 * bytes;
  const unsigned nominal = 47 + 8 * bytes;
  const unsigned worst = nominal + (stuffable - 1) / 4;
  return {static_cast<double>(nominal), static_cast<double>(worst)};
}

// Bits per second, as a part that follows SYNC and a part that does not.
struct Traffic {
  double per_sync = 0.0, per_second = 0.0;
};

double pdosPerSync(const canopen::PdoConfig& pdo) {
  if (pdo.transmission >= 1 && pdo.transmission <= 240) {
    // An RPDO is sent in every cycle; its type only says when the drive takes it.
    return pdo.direction == canopen::PdoDirection::rpdo ? 1.0 : 1.0 / pdo.transmission;
  }
  return 1.0;  // on events: in the worst case with every SYNC
}

void addPdo(const canopen::PdoConfig& pdo, double period_s, Traffic& nominal, Traffic& worst) {
  unsigned bits = 0;
  for (const canopen::PdoEntry& entry : pdo.entries) bits += entry.bits;
  const FrameBits frame = frameBits((bits + 7) / 8);
  // An event-driven TPDO is no more frequent than its inhibit time allows.
  const double inhibit_s = pdo.inhibit * 1e-4;
  const bool event_driven = pdo.transmission == 254 || pdo.transmission == 255;
  if (pdo.direction == canopen::PdoDirection::tpdo && event_driven && inhibit_s > period_s) {
    nominal.per_second += frame.nominal / inhibit_s;
    worst.per_second += frame.worst / inhibit_s;
    return;
  }
  nominal.per_sync += frame.nominal * pdosPerSync(pdo);
  worst.per_sync += frame.worst * pdosPerSync(pdo);
}

void addHeartbeat(Duration period, Traffic& nominal, Traffic& worst) {
  if (period <= Duration(0)) return;
  const FrameBits frame = frameBits(1);
  nominal.per_second += frame.nominal / toSeconds(period);
  worst.per_second += frame.worst / toSeconds(period);
}

void addErrorControl(const canopen::NodeConfig& node, Traffic& nominal, Traffic& worst) {
  if (node.error_control != canopen::ErrorControl::guarding) {
    addHeartbeat(node.heartbeat, nominal, worst);
    return;
  }
  addHeartbeat(node.guard_time, nominal, worst);  // the answer; the request carries no data
  const FrameBits request = frameBits(0);
  nominal.per_second += request.nominal / toSeconds(node.guard_time);
  worst.per_second += request.worst / toSeconds(node.guard_time);
}

}  // namespace

BusLoad busLoad(const canopen::MasterConfig& master, double bitrate) {
  Traffic nominal, worst;
  const FrameBits sync = frameBits(master.sync_counter == 0 ? 0 : 1);
  nominal.per_sync += sync.nominal;
  worst.per_sync += sync.worst;
  const double period_s = toSeconds(master.sync_period);
  addHeartbeat(master.heartbeat, nominal, worst);
  for (const canopen::NodeConfig& node : master.nodes) {
    addErrorControl(node, nominal, worst);
    for (const canopen::PdoConfig& pdo : node.pdos) {
      if (pdo.enabled) addPdo(pdo, period_s, nominal, worst);
    }
  }
  BusLoad load;
  load.nominal = (nominal.per_sync / period_s + nominal.per_second) / bitrate;
  load.worst = (worst.per_sync / period_s + worst.per_second) / bitrate;
  load.feasible_rate = (0.8 * bitrate - worst.per_second) / worst.per_sync;
  return load;
}

}  // namespace cia402::config
