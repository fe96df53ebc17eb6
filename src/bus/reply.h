// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>

namespace cia402::bus {

/// What a command came to, for a service answer. Commands that have more to tell answer with a type
/// made from this one.
struct Answer {
  bool success = false;
  std::string message;  ///< a sentence
};

inline Answer answerOf(bool success, std::string message) {
  Answer answer;
  answer.success = success;
  answer.message = std::move(message);
  return answer;
}

/// Called once, in the bus thread, when a command has ended; may be empty. Must not block.
template <typename AnswerType = Answer>
using Reply = std::function<void(const AnswerType&)>;

template <typename AnswerType>
void give(const Reply<AnswerType>& reply, const AnswerType& answer) {
  if (reply) reply(answer);
}
template <typename AnswerType>
void refuse(const Reply<AnswerType>& reply, const std::string& message) {
  AnswerType answer;
  answer.message = message;
  give(reply, answer);
}

inline std::string noSuchAxis(const std::string& name) {
  return "there is no axis \"" + name + "\"";
}

}  // namespace cia402::bus
