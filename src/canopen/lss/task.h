// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "canopen/lss/master.h"

namespace cia402::canopen {

/// A sequence of LSS services with one purpose. One runs at a time on an LssMaster.
///
/// No task switches devices to the configuration state globally, but where all are meant (see
/// LssActivateTask): a drive in operation takes notice of nothing but requests for its own identity
/// and of "switch state global: waiting", which is the state that it is in.
class LssTask {
 public:
  /// How far it is; a task that is done or failed is not advanced again.
  enum class Status { running, done, failed };
  virtual ~LssTask() = default;

  /// Goes on; to be called at the start and whenever the master is not busy any more.
  Status advance(LssMaster& master, Time now);
  /// What it does now, in words: "switching to the configuration state".
  const std::string& step() const { return step_; }
  /// Why it failed, and what to do.
  const std::string& error() const { return error_; }
  /// What it came to, once done.
  const std::string& result() const { return result_; }

 protected:
  /// Looks at what the master has brought and begins the next request.
  virtual Status proceed(LssMaster& master, Time now) = 0;

  Status ask(LssMaster& master, Time now, std::string step, LssRequest request);
  Status done(std::string result);
  Status fail(std::string error);
  void show(std::string step) { step_ = std::move(step); }

 private:
  std::string step_, error_, result_;
};

/// Requests that several tasks use.
LssRequest lssWaitingRequest();
LssRequest lssSelectRequest(const lss::Identity& identity);
LssRequest lssInquireRequest(std::size_t part);
LssRequest lssInquireNodeIdRequest();

/// Selects one device by its identity and asks it who it is: what it answers must be what was
/// asked for, and one alone must answer, so that nothing is ever configured in a wrong device.
/// Part of other tasks.
class LssSelection {
 public:
  /// @param attempts to select it, at most; 0: LssOptions::attempts.
  explicit LssSelection(const lss::Identity& identity, int attempts = 0)
      : identity_(identity), attempts_(attempts) {}
  /// How far it is.
  enum class Status { running, done, absent, failed };
  /// As LssTask::advance(). `absent`: nobody has this identity.
  Status advance(LssMaster& master, Time now);
  const std::string& step() const { return step_; }
  const std::string& error() const { return error_; }
  /// Node-ID that the device has, lss::kUnconfigured if none; valid once done.
  std::uint8_t nodeId() const { return node_id_; }

 private:
  enum class Phase { begin, leaving, selecting, inquiring, node_id };
  Status check(LssMaster& master);

  lss::Identity identity_;
  int attempts_;
  Phase phase_ = Phase::begin;
  std::size_t part_ = 0;
  std::uint8_t node_id_ = 0;
  std::string step_, error_;
};

/// Gives the device of an identity its node-ID, and has it stored where asked.
class LssAssignTask final : public LssTask {
 public:
  /// What to assign to whom.
  struct Options {
    lss::Identity identity;
    NodeId node_id = 0;  ///< 1..127
    bool store = false;  ///< only where the node-ID is another one than before
    /// Node-IDs of others, asked for when the device has told its own; none: all are free. One that
    /// another has is neither given, nor left: the reset would hit both.
    std::function<std::vector<NodeId>()> in_use;
    /// Node-IDs become valid with the reset communication of all nodes at start-up; else the
    /// device itself is reset. One that had none boots by itself (CiA 305); as some wait for a
    /// reset of node 255 or of all (lely-core, src/co/nmt.c), 255 is reset, too.
    bool reset = true;
    /// How often the identity is called at most; 0: LssOptions::attempts.
    int attempts = 0;
  };
  /// @param sink where the NMT reset goes; outlives the task.
  LssAssignTask(Options options, can::Sink& sink)
      : options_(std::move(options)),
        sink_(sink),
        selection_(options_.identity, options_.attempts) {}

  /// Nobody answered to the identity; valid once failed.
  bool absent() const { return absent_; }
  /// The device has got another node-ID than it had; valid once done.
  bool changed() const { return changed_; }
  const lss::Identity& identity() const { return options_.identity; }

 private:
  enum class Phase { selecting, configuring, storing, leaving };
  Status proceed(LssMaster& master, Time now) override;
  Status select(LssMaster& master, Time now);
  Status configure(LssMaster& master, Time now);
  Status leave(LssMaster& master, Time now);
  Status finish();

  Options options_;
  can::Sink& sink_;
  LssSelection selection_;
  Phase phase_ = Phase::selecting;
  bool absent_ = false, changed_ = false;
  std::string failure_;  ///< told once the device is back in the waiting state
};

/// Writes the bit timing into one device and has it stored where asked. Nothing changes on the bus:
/// that is the task of LssActivateTask or of the next power-on.
class LssBitTimingTask final : public LssTask {
 public:
  /// @param kbit_per_s a rate of lss::bitTimingIndex().
  LssBitTimingTask(const lss::Identity& identity, unsigned kbit_per_s, bool store)
      : selection_(identity), identity_(identity), kbit_per_s_(kbit_per_s), store_(store) {}

 private:
  enum class Phase { selecting, configuring, storing, leaving };
  Status proceed(LssMaster& master, Time now) override;
  Status leave(LssMaster& master, Time now);

  LssSelection selection_;
  lss::Identity identity_;
  unsigned kbit_per_s_;
  bool store_;
  Phase phase_ = Phase::selecting;
  std::string failure_;
};

/// Has all devices on the bus that were given another bit timing take it: they are silent for
/// `delay`, switch, and are silent for it once more. Nobody answers.
class LssActivateTask final : public LssTask {
 public:
  explicit LssActivateTask(std::uint16_t delay_ms) : delay_ms_(delay_ms) {}

 private:
  Status proceed(LssMaster& master, Time now) override;
  std::uint16_t delay_ms_;
  int phase_ = 0;
};

}  // namespace cia402::canopen
