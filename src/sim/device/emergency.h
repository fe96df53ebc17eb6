// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sim/device/context.h"

namespace cia402::sim {

/// Emergency producer (CiA 301, 7.2.7): 1001h, 1003h, 1014h, 1015h.
class SlaveEmergency {
 public:
  explicit SlaveEmergency(SlaveContext& context) : context_(context) {}

  /// Takes writes of its objects, where the dictionary has them.
  void serveObjects();
  /// Forgets waiting frames and active communication errors (power-on, reset).
  void reset();
  void send(std::uint16_t code, std::uint8_t error_register,
            const std::array<std::uint8_t, 5>& vendor);
  /// Enters an error into 1003h and tells nobody.
  void remember(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor);
  /// An error is gone: EMCY 0x0000. @param remaining 1001h from now on, of other errors.
  void clear(std::uint8_t remaining = 0);
  /// A communication error begins: reports it once, until resolve() with the same flag.
  void raise(bool& active, std::uint16_t code);
  /// A communication error ends; with the last one "no error" is reported.
  void resolve(bool& active);
  void tick();
  Time deadline() const;

 private:
  static constexpr std::size_t kQueueSize = 16;

  void enterHistory(std::uint32_t field);
  void clearHistory();
  void queue(std::uint16_t code, std::uint8_t error_register,
             const std::array<std::uint8_t, 5>& vendor);

  SlaveContext& context_;
  std::array<can::Frame, kQueueSize> queue_;
  std::size_t head_ = 0;
  std::size_t waiting_ = 0;
  Time inhibited_until_ = Time::min();
  unsigned active_ = 0;
};

}  // namespace cia402::sim
