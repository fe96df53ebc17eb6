// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/lss.h"

#include <algorithm>
#include <array>

#include "sim/device/frame.h"

namespace cia402::sim {

namespace {

constexpr std::uint32_t kAnswerId = 0x7E4;
constexpr std::uint16_t kIdentity = 0x1018;

// Command specifiers (CiA 305).
constexpr std::uint8_t kSwitchGlobal = 0x04;
constexpr std::uint8_t kConfigureNode = 0x11;
constexpr std::uint8_t kConfigureBitTiming = 0x13;
constexpr std::uint8_t kActivateBitTiming = 0x15;
constexpr std::uint8_t kStore = 0x17;
constexpr std::uint8_t kSelectVendor = 0x40;
constexpr std::uint8_t kSelectSerial = 0x43;
constexpr std::uint8_t kSelected = 0x44;
constexpr std::uint8_t kIdentifyVendor = 0x46;
constexpr std::uint8_t kIdentifySerialHigh = 0x4B;
constexpr std::uint8_t kIdentifyUnconfigured = 0x4C;
constexpr std::uint8_t kIdentified = 0x4F;
constexpr std::uint8_t kIdentifiedUnconfigured = 0x50;
constexpr std::uint8_t kFastscan = 0x51;
constexpr std::uint8_t kInquireVendor = 0x5A;
constexpr std::uint8_t kInquireSerial = 0x5D;
constexpr std::uint8_t kInquireNode = 0x5E;

constexpr std::uint8_t kScanBegin = 128;  // in place of a bit number
constexpr unsigned kLastPart = 3;

// Table 0 of CiA 301, bit/s; 0: reserved. Index 9 would be automatic detection.
constexpr std::array<std::uint32_t, 9> kBitrates = {1000000, 800000, 500000, 250000, 125000,
                                                    0,       50000,  20000,  10000};

bool isNodeId(std::uint8_t node) { return node >= 1 && node <= 127; }

}  // namespace

void SlaveLss::load() {
  pending_node_ = stored_node_;
  pending_bitrate_ = active_bitrate_ = stored_bitrate_;
  switch_at_ = silent_until_ = kNever;
}

void SlaveLss::reset() {
  state_ = State::waiting;
  next_command_ = 0;
  scan_part_ = 0;
}

bool SlaveLss::deaf() const {
  if (silent_until_ != kNever) return true;
  return bus_bitrate_ != 0 && active_bitrate_ != 0 && active_bitrate_ != bus_bitrate_;
}

bool SlaveLss::available() const {
  return context_.behaviour.lss && context_.dictionary.find({kIdentity, 4}) != nullptr;
}

// Neither an active nor a pending node-ID: the device waits in NMT initialisation.
bool SlaveLss::unconfigured() const {
  return context_.node == kUnconfigured && pending_node_ == kUnconfigured;
}

std::uint32_t SlaveLss::identity(unsigned part) const {
  return static_cast<std::uint32_t>(
      context_.value({kIdentity, static_cast<std::uint8_t>(part + 1)}));
}

void SlaveLss::answer(std::uint8_t command, std::uint32_t value) {
  can::Frame frame = emptyFrame(kAnswerId, 8);
  frame.data[0] = command;
  putBytes(frame, 1, 4, value);
  context_.sink.send(frame);
}

void SlaveLss::receive(const can::Frame& frame) {
  if (frame.remote || frame.size != 8 || !available()) return;
  const std::uint8_t command = frame.data[0];
  const auto number = static_cast<std::uint32_t>(takeBytes(frame, 1, 4));
  if (command == kSwitchGlobal) return switchGlobal(frame.data[1]);
  if (command >= kIdentifyVendor && command <= kIdentifySerialHigh) {
    return identify(command, number);
  }
  if (command == kIdentifyUnconfigured) return identifyUnconfigured();
  if (state_ == State::configuration) return configure(frame);
  if (command >= kSelectVendor && command <= kSelectSerial) return select(command, number);
  if (command == kFastscan) fastscan(frame);
}

void SlaveLss::switchGlobal(std::uint8_t mode) {
  const State before = state_;
  if (mode > 1) return;
  reset();
  if (mode == 1) state_ = State::configuration;
  // A device that has just got its first node-ID begins to live with it.
  const bool named = !context_.behaviour.lss_waits_for_reset && context_.node == kUnconfigured &&
                     pending_node_ != kUnconfigured;
  if (before == State::configuration && mode == 0 && named) context_.reset_communication();
}

// The four numbers come in their order; one that does not match ends the sequence.
void SlaveLss::select(std::uint8_t command, std::uint32_t number) {
  const bool in_order = command == kSelectVendor || command == next_command_;
  next_command_ = 0;
  if (!in_order || number != identity(command - kSelectVendor)) return;
  next_command_ = static_cast<std::uint8_t>(command + 1);
  if (command != kSelectSerial) return;
  next_command_ = 0;
  state_ = State::configuration;
  answer(kSelected);
}

// Vendor, product, then lowest and highest revision and serial number.
void SlaveLss::identify(std::uint8_t command, std::uint32_t number) {
  const bool in_order = command == kIdentifyVendor || command == next_command_;
  next_command_ = 0;
  if (!in_order) return;
  const unsigned step = command - kIdentifyVendor;
  bool fits = false;
  if (step < 2) {
    fits = number == identity(step);
  } else if (step % 2 == 0) {
    fits = number <= identity(step / 2 + 1);
  } else {
    fits = number >= identity(step / 2 + 1);
  }
  if (!fits) return;
  next_command_ = static_cast<std::uint8_t>(command + 1);
  if (command != kIdentifySerialHigh) return;
  next_command_ = 0;
  answer(kIdentified);
}

void SlaveLss::identifyUnconfigured() {
  if (unconfigured() && context_.behaviour.lss_identify_unconfigured) {
    answer(kIdentifiedUnconfigured);
  }
}

// Bits 31 to `bit` of one number are compared; with bit 0 the number is known and the next follows.
void SlaveLss::fastscan(const can::Frame& frame) {
  if (!unconfigured() && !context_.behaviour.lss_scanned_with_node_id) return;
  const auto number = static_cast<std::uint32_t>(takeBytes(frame, 1, 4));
  const std::uint8_t bit = frame.data[5];
  const std::uint8_t part = frame.data[6];
  const std::uint8_t next = frame.data[7];
  if (bit == kScanBegin) {
    scan_part_ = 0;
    return answer(kIdentified);
  }
  if (bit > 31 || part > kLastPart || next > kLastPart || part != scan_part_) return;
  if (((number ^ identity(part)) >> bit) != 0) return;
  scan_part_ = next;
  const bool last = bit == 0 && next < part;
  if (last && !context_.behaviour.lss_never_found) state_ = State::configuration;
  answer(kIdentified);
}

void SlaveLss::configure(const can::Frame& frame) {
  const std::uint8_t command = frame.data[0];
  if (command >= kInquireVendor && command <= kInquireSerial) {
    return answer(command, identity(command - kInquireVendor));
  }
  switch (command) {
    case kConfigureNode:
      return configureNode(frame.data[1]);
    case kConfigureBitTiming:
      return configureBitTiming(frame.data[1], frame.data[2]);
    case kActivateBitTiming:
      return activateBitTiming(
          std::chrono::milliseconds(static_cast<std::int64_t>(takeBytes(frame, 1, 2))));
    case kStore:
      return store();
    case kInquireNode:
      return answer(command, context_.node == kUnconfigured ? pending_node_ : context_.node);
    default:
      return;
  }
}

// Error 1: out of range.
void SlaveLss::configureNode(std::uint8_t node) {
  const bool known = isNodeId(node) || node == kUnconfigured;
  if (known) pending_node_ = node;
  answer(kConfigureNode, known ? 0 : 1);
}

void SlaveLss::configureBitTiming(std::uint8_t table, std::uint8_t index) {
  const bool known = context_.behaviour.lss_bit_timing && table == 0 && index < kBitrates.size() &&
                     kBitrates[index] != 0;
  if (known) pending_bitrate_ = kBitrates[index];
  answer(kConfigureBitTiming, known ? 0 : 1);
}

// Silent for the delay, then at the new bit rate silent for as long again.
void SlaveLss::activateBitTiming(Duration delay) {
  if (!context_.behaviour.lss_bit_timing) return;
  switch_at_ = context_.now + delay;
  silent_until_ = switch_at_ + delay;
  tick();
}

// Error 1: the device cannot store.
void SlaveLss::store() {
  if (!context_.behaviour.lss_store) return answer(kStore, 1);
  stored_node_ = pending_node_;
  stored_bitrate_ = pending_bitrate_;
  answer(kStore);
}

void SlaveLss::tick() {
  if (switch_at_ <= context_.now) {
    active_bitrate_ = pending_bitrate_;
    switch_at_ = kNever;
  }
  if (silent_until_ <= context_.now) silent_until_ = kNever;
}

}  // namespace cia402::sim
