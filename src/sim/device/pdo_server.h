// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <vector>

#include "sim/device/rpdo.h"
#include "sim/device/tpdo.h"

namespace cia402::sim {

/// All PDOs of a slave: as many as the dictionary has records for.
class PdoServer {
 public:
  PdoServer(SlaveContext& context, SlaveEmergency& emergency)
      : context_(context), emergency_(emergency) {}

  /// Finds the PDOs in the dictionary and serves writes to their records.
  void serveObjects();
  /// Takes all records over (end of initialising).
  void configure();
  /// Entering and leaving operational.
  void start();
  void stop();
  /// Event-driven TPDOs of which entering operational is an event.
  void sendOnStart();

  /// Whether a frame with this CAN-ID may concern a PDO.
  bool concerns(std::uint32_t id) const { return id < ids_.size() && ids_[id]; }
  /// A frame of which concerns() is true.
  void receive(const can::Frame& frame);
  /// RPDOs that waited for the SYNC take effect.
  void applySynchronous();
  /// TPDOs that the SYNC with this counter (0: none) asks for.
  void sendSynchronous(std::uint8_t counter);
  /// Is any TPDO sent when its content changes?
  bool sendsOnChange() const { return event_driven_ && anySendsOnChange(); }
  void notifyChange();
  void tick();
  Time deadline() const;

 private:
  void serveRecords(const PdoRecords& pdo, const std::function<void()>& configure);
  void configured();
  bool anySendsOnChange() const;

  SlaveContext& context_;
  SlaveEmergency& emergency_;
  std::vector<SlaveRpdo> rpdos_;
  std::vector<SlaveTpdo> tpdos_;
  std::vector<SlaveTpdo*> due_;
  std::bitset<0x800> ids_;
  bool event_driven_ = false;  ///< any TPDO, as configured
  bool timed_ = false;         ///< any PDO may have a deadline: an event-driven or supervised one
};

}  // namespace cia402::sim
