// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "sim/device/context.h"

namespace cia402::sim {

/// Layer setting services (CiA 305) of a device that has 1018h with its four numbers. The node-ID
/// and the bit rate exist three times: stored (survives a power cycle), pending, and active; the
/// active node-ID is SlaveContext::node.
class SlaveLss {
 public:
  /// @param stored_node node-ID out of the factory, 255 for none.
  SlaveLss(SlaveContext& context, canopen::NodeId stored_node)
      : context_(context), stored_node_(stored_node), pending_node_(stored_node) {}

  /// What is stored becomes pending and, for the bit rate, active (power-on, reset node).
  void load();
  /// Back to LSS waiting (any reset).
  void reset();
  canopen::NodeId pendingNode() const { return pending_node_; }
  /// The true bit rate of the bus in bit/s; 0: whatever the device takes is right.
  void setBusBitrate(std::uint32_t bitrate) { bus_bitrate_ = bitrate; }
  /// Neither hears nor sends: it speaks another bit rate than the bus, or is about to switch.
  bool deaf() const;

  /// A frame with the identifier of the LSS master.
  void receive(const can::Frame& frame);
  void tick();
  Time deadline() const { return std::min(switch_at_, silent_until_); }

 private:
  enum class State : std::uint8_t { waiting, configuration };

  void switchGlobal(std::uint8_t mode);
  void select(std::uint8_t command, std::uint32_t number);
  void identify(std::uint8_t command, std::uint32_t number);
  void identifyUnconfigured();
  void fastscan(const can::Frame& frame);
  void configure(const can::Frame& frame);
  void configureNode(std::uint8_t node);
  void configureBitTiming(std::uint8_t table, std::uint8_t index);
  void activateBitTiming(Duration delay);
  void store();
  std::uint32_t identity(unsigned part) const;
  bool available() const;
  bool unconfigured() const;
  void answer(std::uint8_t command, std::uint32_t value = 0);

  SlaveContext& context_;
  State state_ = State::waiting;
  std::uint8_t next_command_ = 0;  // of a sequence that has matched so far; 0: none
  std::uint8_t scan_part_ = 0;     // number of the identity that fastscan asks for
  canopen::NodeId stored_node_;
  canopen::NodeId pending_node_;
  std::uint32_t bus_bitrate_ = 0;
  std::uint32_t stored_bitrate_ = 0;  // 0: that of the bus
  std::uint32_t pending_bitrate_ = 0;
  std::uint32_t active_bitrate_ = 0;
  Time switch_at_ = kNever;
  Time silent_until_ = kNever;  // kNever: not switching
};

}  // namespace cia402::sim
