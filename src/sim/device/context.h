// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "sim/device/device.h"

namespace cia402::sim {

/// The node-ID of a device that has none yet (CiA 305).
inline constexpr canopen::NodeId kUnconfigured = 255;

/// What the services of one simulated slave share. `now` is the time of the call in progress, for
/// hooks that carry none.
struct SlaveContext {
  canopen::NodeId node;
  can::Sink& sink;
  ObjectDictionary& dictionary;
  DeviceBehaviour behaviour;
  Device::Application& application;
  canopen::NmtState state = canopen::NmtState::unknown;
  Time now{};
  Time sync_window_end = kNever;  ///< synchronous RPDOs are taken until then (1007h)
  std::function<void(canopen::NmtState)> change_state;
  std::function<void()> reset_communication;
  std::vector<ObjectId> hooked;

  SlaveContext(canopen::NodeId id, can::Sink& frames, ObjectDictionary& objects,
               DeviceBehaviour switches, Device::Application& app)
      : node(id), sink(frames), dictionary(objects), behaviour(switches), application(app) {}

  bool operational() const { return state == canopen::NmtState::operational; }
  /// States in which SDO, SYNC and EMCY work (CiA 301, table 38).
  bool communicating() const {
    return operational() || state == canopen::NmtState::pre_operational;
  }

  /// Value of an object of the dictionary, `missing` where there is none.
  std::uint64_t value(ObjectId id, std::uint64_t missing = 0) const {
    const Entry* entry = dictionary.find(id);
    return entry == nullptr ? missing : entry->number;
  }

  /// What the loss of the master by heartbeat or life guarding does (CiA 301, 7.5.2.29).
  void masterLost() {
    behaveOnError(value({0x1029, 1}));
    application.onMasterLost(now);
  }
  /// The same for the other errors of communication, where the device lets them be chosen
  /// (1029h:02, Damiao L626); else they change no state.
  void otherCommunicationError() { behaveOnError(value({0x1029, 2}, 1)); }
  /// @param reaction 0 pre-operational, 1 none, 2 stopped
  void behaveOnError(std::uint64_t reaction) {
    if (reaction == 0 && operational()) change_state(canopen::NmtState::pre_operational);
    if (reaction == 2) change_state(canopen::NmtState::stopped);
  }

  /// From an SDO request to its answer.
  Duration answerTime(const can::Frame& request) const {
    const unsigned index = request.data[1] | static_cast<unsigned>(request.data[2]) << 8U;
    const bool stores = request.data[0] >> 5U == 1 && (index == 0x1010 || index == 0x1011);
    return behaviour.sdo_latency + (stores ? behaviour.store_time : Duration::zero());
  }

  /// Serves writes of an object, if the dictionary has it. Either function may be empty.
  void serveWrites(ObjectId id, ObjectDictionary::WriteCheck check,
                   ObjectDictionary::WriteHook hook) {
    if (dictionary.find(id) == nullptr) return;
    dictionary.onWriteCheck(id, std::move(check));
    dictionary.onWrite(id, std::move(hook));
    hooked.push_back(id);
  }
};

}  // namespace cia402::sim
