// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "can/bus.h"
#include "canopen/lss/protocol.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// How long the LSS master waits.
struct LssOptions {
  Duration timeout{std::chrono::milliseconds(100)};  ///< for the answer of one device
  /// Answers of further devices to the same request come within this after the first. Also what
  /// each question of fastscan waits for: its answers say nothing about the question, so a device
  /// that takes longer would answer the next one.
  Duration window{std::chrono::milliseconds(20)};
  int attempts = 5;  ///< requests that nobody answers, or two, are repeated so often
};

/// One confirmed or unconfirmed LSS service on the wire.
struct LssRequest {
  std::vector<can::Frame> frames;  ///< sent one after the other
  lss::Command answer{};           ///< specifier of the answer
  bool confirmed = true;           ///< false: nobody answers; ends after the window
  bool many = false;               ///< several devices may answer
  bool question = false;           ///< of fastscan: the window, one attempt; silence is an answer
  int attempts = 0;                ///< at most; 0: LssOptions::attempts
};

/// LSS master (CiA 305): one request on the wire at a time, with time-outs and repetitions; counts
/// the answers of several devices to what one alone should answer. What to ask in which order is
/// the business of LssTask. Sans-IO, one thread.
class LssMaster {
 public:
  /// @param sink must outlive the master.
  explicit LssMaster(can::Sink& sink, LssOptions options = {}) : sink_(sink), options_(options) {}

  /// Sends a request; one still running is forgotten.
  void begin(LssRequest request, Time now);
  /// Takes a frame with COB-ID 7E4h; what is no answer to the running request is counted as stray.
  void receive(const can::Frame& frame, Time now);
  /// Ends waiting that is over.
  void tick(Time now);
  Time nextDeadline() const { return deadline_; }
  /// Forgets the running request.
  void stop() { deadline_ = kNever; }

  bool busy() const { return deadline_ != kNever; }
  /// The request has ended as it should: answered by one device (or several where that is
  /// allowed), or sent where nobody answers.
  bool ok() const { return !busy() && problem_.empty(); }
  /// Nobody answered at all.
  bool silent() const { return !busy() && answers_.empty(); }
  /// All answers to the last attempt. The first is the one, if ok().
  const std::vector<can::Frame>& answers() const { return answers_; }
  /// Why it is not ok, e.g. "nobody answered within 0.1 s, asked 3 times".
  const std::string& problem() const { return problem_; }

  const LssOptions& options() const { return options_; }
  void setWindow(Duration window) { options_.window = window; }
  std::uint64_t strayAnswers() const { return stray_answers_; }

 private:
  void send(Time now);
  int attempts() const { return request_.attempts > 0 ? request_.attempts : options_.attempts; }
  bool asItShould() const;
  std::string problemText() const;

  can::Sink& sink_;
  LssOptions options_;
  LssRequest request_;
  std::vector<can::Frame> answers_;
  std::string problem_;
  Time deadline_ = kNever;
  int attempt_ = 0;
  std::uint64_t stray_answers_ = 0;
};

}  // namespace cia402::canopen
