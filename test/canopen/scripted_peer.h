// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <deque>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "can/bus.h"

namespace cia402::canopen::test {

/// "601 40 41 60 00": identifier, then data bytes, all hexadecimal.
inline can::Frame frame(const std::string& text) {
  std::istringstream words(text);
  can::Frame result;
  words >> std::hex >> result.id;
  for (unsigned byte = 0; words >> byte;) {
    result.data[result.size++] = static_cast<std::uint8_t>(byte);
  }
  return result;
}

/// The same the other way round; "701 R1" for a remote frame that asks for one byte.
inline std::string text(const can::Frame& frame) {
  char word[8];
  std::snprintf(word, sizeof(word), "%03X", static_cast<unsigned>(frame.id));
  std::string result = word;
  if (frame.remote) return result + " R" + std::to_string(frame.size);
  for (std::size_t i = 0; i < frame.size; ++i) {
    std::snprintf(word, sizeof(word), " %02X", static_cast<unsigned>(frame.data[i]));
    result += word;
  }
  return result;
}

/// The other end of the wire as a table: what it hears and what it says to that. Knows nothing of
/// CANopen. Frames without a line in the table stay unanswered.
class ScriptedPeer : public can::Sink {
 public:
  /// Adds a line. A second line for one request is for its second time; the last one repeats.
  ScriptedPeer& on(const std::string& request, const std::vector<std::string>& answers) {
    script_[request].push_back(answers);
    return *this;
  }
  ScriptedPeer& on(const std::string& request, const char* answer) {
    return on(request, std::vector<std::string>{answer});
  }
  /// Replaces all lines for one request.
  ScriptedPeer& replace(const std::string& request, const std::vector<std::string>& answers) {
    forget(request);
    return on(request, answers);
  }
  ScriptedPeer& replace(const std::string& request, const char* answer) {
    return replace(request, std::vector<std::string>{answer});
  }
  /// Forgets the lines for one request: it is not answered any more.
  void forget(const std::string& request) { script_.erase(request); }

  bool send(const can::Frame& sent_frame) override {
    const std::string line = text(sent_frame);
    sent.push_back(line);
    const auto found = script_.find(line);
    if (found == script_.end()) return true;
    const std::vector<std::string> answers = found->second.front();
    if (found->second.size() > 1) found->second.pop_front();
    for (const std::string& answer : answers) answers_.push_back(frame(answer));
    return true;
  }

  /// Hands all answers over until there are none left.
  void deliver(const std::function<void(const can::Frame&)>& receive) {
    while (!answers_.empty()) {
      const can::Frame answer = answers_.front();
      answers_.pop_front();
      receive(answer);
    }
  }

  /// What was sent since the last call, one line a frame.
  std::vector<std::string> take() {
    std::vector<std::string> lines;
    lines.swap(sent);
    return lines;
  }

  std::vector<std::string> sent;

 private:
  std::map<std::string, std::deque<std::vector<std::string>>> script_;
  std::deque<can::Frame> answers_;
};

}  // namespace cia402::canopen::test
