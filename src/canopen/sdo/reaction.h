// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace cia402::canopen {

/// What a frame of the server means to the transfer on the wire.
struct SdoReaction {
  /// What becomes of the transfer.
  enum class Kind : std::uint8_t {
    stray,      ///< no answer to what was asked: it is ignored
    taken,      ///< an answer; the transfer goes on
    completed,  ///< the last answer: all data have arrived
    refused,    ///< the server aborted with `code` (CiA 301, 7.2.4.2.8)
    broken,     ///< an answer against the protocol: it is to be aborted with `code`
    ordinary,   ///< a block upload that the server answers by an ordinary one (CiA 301, 7.2.4.2.14)
  };
  Kind kind = Kind::taken;
  std::uint32_t code = 0;  ///< abort code, CiA 301, table 22
  std::string why{};       ///< of what is broken, in words

  static SdoReaction stray() { return {Kind::stray, 0, {}}; }
  static SdoReaction taken() { return {Kind::taken, 0, {}}; }
  static SdoReaction completed() { return {Kind::completed, 0, {}}; }
  static SdoReaction refused(std::uint32_t code) { return {Kind::refused, code, {}}; }
  static SdoReaction broken(std::uint32_t code, std::string why) {
    return {Kind::broken, code, std::move(why)};
  }
  static SdoReaction ordinary() { return {Kind::ordinary, 0, {}}; }
};

}  // namespace cia402::canopen
