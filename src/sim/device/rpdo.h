// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/device/emergency.h"
#include "sim/device/pdo_parameters.h"

namespace cia402::sim {

/// One RPDO (CiA 301, 7.2.2): data taken at once or with the next SYNC, lengths and event timer
/// supervised.
class SlaveRpdo {
 public:
  /// @param number 0 is RPDO 1.
  SlaveRpdo(SlaveContext& context, SlaveEmergency& emergency, unsigned number);

  const PdoRecords& records() const { return records_; }
  /// Takes communication and mapping parameters over from the dictionary.
  void configure();
  /// Forgets data that wait for a SYNC and stops the supervision.
  void stop();
  /// CAN-ID, or a value no frame has while the PDO is invalid.
  std::uint32_t canId() const { return can_id_; }
  /// A frame with its identifier.
  void receive(const can::Frame& frame);
  /// What has come counts now, if the transmission type is synchronous.
  void onSync();
  /// Reports that it fails to come, where its event timer says so.
  void tick();
  Time deadline() const { return deadline_; }
  /// As configured: does its event timer say that it must come?
  bool supervised() const { return event_time_ > Duration::zero(); }

 private:
  bool lengthFits(const can::Frame& frame);
  void apply(std::uint64_t data);

  SlaveContext& context_;
  SlaveEmergency& emergency_;
  PdoRecords records_;
  Mapping mapping_;
  std::uint32_t can_id_;
  bool synchronous_ = false;
  Duration event_time_{};
  bool waiting_ = false;
  std::uint64_t data_ = 0;
  Time deadline_ = kNever;
  bool too_short_ = false;
  bool too_long_ = false;
  bool timed_out_ = false;
};

}  // namespace cia402::sim
