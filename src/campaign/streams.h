// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "campaign/session.h"

namespace cia402::campaign {

/// Set-points, single ones and streams of them, and what they permit.
class Streams {
 public:
  explicit Streams(Session& session) : session_(session) {}

  /// @return false if the words are none of set-points.
  bool act(const Words& words);
  /// A stream from now on, in place of the axis' last one.
  /// @param value of the time since its beginning. @param seconds how long. @param rate per second
  void begin(std::size_t axis, std::function<double(Duration)> value, double seconds, double rate);
  /// Sends what is due.
  void step();
  /// When step() is due next; kNever without a stream.
  Time next() const;
  /// Ends all.
  void clear() { streams_.clear(); }

  // Actions.
  void stream(const Words& words);  ///< stream A VALUE SECONDS RATE
  void sine(const Words& words);    ///< sine A CENTRE AMPLITUDE PERIOD SECONDS RATE
  void nudge(const Words& words);   ///< nudge A DISTANCE SECONDS RATE: from where it is shown
  void point(const Words& words);   ///< point A VALUE
  void dry(const Words& words);     ///< dry A: the stream ends

 private:
  struct Stream {
    std::size_t axis = 0;
    std::function<double(Duration)> value;
    Time began{}, next{}, end{};
    Duration period{};
  };
  void end(std::size_t axis);
  void send(std::size_t axis, double value);
  void accepted(std::size_t axis, double value);

  Session& session_;
  std::vector<Stream> streams_;
};

}  // namespace cia402::campaign
