// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "cia402_driver/can/bus.h"
#include "cia402_driver/canopen/nmt.h"
#include "cia402_driver/sim/object_dictionary.h"

namespace cia402::sim {

/// Behaviour switches of a simulated device's communication, where real devices differ.
struct DeviceBehaviour {
  Duration boot_time{std::chrono::milliseconds(20)};     ///< power-on or reset to boot-up
  Duration sdo_latency{std::chrono::microseconds(200)};  ///< request to answer
  bool ignores_nmt_reset = false;
  bool map_count_read_only = false;  ///< sub0 of 16xxh/1Axxh refuses writes with 0x06010002
  bool accepts_plain_sync = true;    ///< take an empty SYNC although 1019h is not 0
  bool sdo_silent = false;           ///< never answers SDO
};

/// A CANopen slave (CiA 301) on an object dictionary: boot-up, NMT, SDO server (expedited,
/// segmented), four or more PDO pairs with mapping and all transmission types, inhibit and event
/// timers, SYNC with counter, heartbeat producer and consumer, EMCY with 1001h/1003h. Sans-IO. It
/// shares no encoder with the master on purpose.
class Device {
 public:
  /// What the application (the drive) on top wants to know. All calls happen in receive()/tick().
  class Application {
   public:
    virtual ~Application() = default;
    virtual void onPowerOn(Time) {}  ///< also after reset node / reset communication
    virtual void onNmtState(canopen::NmtState, Time) {}
    virtual void onSync(Time) {}        ///< before synchronous TPDOs are sampled
    virtual void onRpdo(Time) {}        ///< after an RPDO's values were taken
    virtual void onMasterLost(Time) {}  ///< heartbeat consumer timed out (1016h)
    virtual void onMasterBack(Time) {}
    virtual void beforeTpdo(Time) {}  ///< bring actual values up to date
  };

  Device(canopen::NodeId node, can::Sink& sink, ObjectDictionary& dictionary,
         DeviceBehaviour behaviour, Application& application);
  ~Device();

  void powerOn(Time now);
  void powerOff();  ///< silent and deaf until powerOn()
  bool powered() const;
  void receive(const can::Frame& frame, Time now);
  void tick(Time now);
  Time nextEvent() const;

  canopen::NodeId node() const;
  canopen::NmtState nmtState() const;
  /// Sends an EMCY (unless inhibited) and enters it into 1003h; 1001h := error_register.
  void sendEmergency(std::uint16_t code, std::uint8_t error_register,
                     const std::array<std::uint8_t, 5>& vendor, Time now);
  /// EMCY 0000h: all errors gone; 1001h := 0.
  void clearEmergency(Time now);
  /// Mapped values of event-driven TPDOs may have changed: sends those whose content did, subject
  /// to their inhibit time (types 254, 255 by `behaviour`).
  void notifyChange(Time now);
  DeviceBehaviour& behaviour();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cia402::sim
