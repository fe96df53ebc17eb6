// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "canopen/config.h"
#include "canopen/pdo/image.h"
#include "canopen/sdo/client.h"

namespace cia402::canopen {

/// Carries a process image without PDOs (NodeConfig::by_sdo): outputs are written when they change,
/// one after the other in the order of their changes, and between them the inputs are read in turn.
/// One transfer of it at a time, so that others that want something of the node get their turn.
class SdoCycle {
 public:
  /// All must outlive it. It does nothing where `config` has nothing for it.
  SdoCycle(const NodeConfig& config, PdoImage& image, SdoClient& sdo);

  /// The node is in operation: all outputs are written anew.
  void start();
  void stop();
  /// Once a cycle: what has changed of the outputs is to be written.
  void outputsSet(Time now);
  /// The node did not answer, however often it was asked.
  bool mute() const { return mute_; }
  /// Goes on where the last transfer has ended.
  void advance(Time now);

 private:
  struct Value {
    ObjectId object;
    std::uint8_t bytes;
    fieldbus::Slot slot;
  };
  struct Output : Value {
    std::uint64_t queued = 0;  ///< what it was told last, or will be
    bool known = false;        ///< ... if it was
    bool held = false;         ///< the drive has confirmed it
  };
  struct Write {
    std::size_t output;
    std::uint64_t raw;
  };

  void queue(std::size_t output, std::uint64_t raw);
  bool isStop(const Write& write) const;
  void listen();
  void finish(Time now);
  void next();

  const NodeConfig& config_;
  PdoImage& image_;
  SdoClient& sdo_;
  std::vector<Value> inputs_;
  std::vector<Output> outputs_;
  std::deque<Write> writes_;  ///< that have not begun
  SdoTicket ticket_;          ///< of the transfer under way
  bool reading_ = false;      ///< ... of inputs_[item_], else the write of outputs_[item_]
  std::size_t item_ = 0, turn_ = 0;
  std::uint64_t answers_ = 0, timeouts_ = 0;  ///< of the client, when it was heard last
  bool running_ = false, mute_ = false;
};

}  // namespace cia402::canopen
