// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "system/scene.h"

namespace cia402 {

inline std::string lssOf(int serial, const std::string& more = {}) {
  return ", lss: {vendor_id: 1234, product_code: 1026, revision: 65536, serial: " +
         std::to_string(serial) + more + "}";
}
inline std::string unconfigured(int serial) {
  return ", simulation: {unconfigured: true, serial: " + std::to_string(serial) + "}";
}
inline canopen::lss::Identity device(std::uint32_t serial) { return {1234, 1026, 65536, serial}; }

template <class Body>
bus::Answer call(Scene& scene, Body body) {
  bus::Command command;
  command.body = std::move(body);
  return scene.call(std::move(command));
}

/// Asks and does not wait; the answer goes to the returned place.
template <class Body>
std::shared_ptr<std::optional<bus::Answer>> ask(Scene& scene, Body body) {
  auto answer = std::make_shared<std::optional<bus::Answer>>();
  bus::Command command;
  command.body = std::move(body);
  command.reply = [answer](const bus::Answer& given) { *answer = given; };
  scene.robot().robot().execute(std::move(command), scene.now());
  return answer;
}

}  // namespace cia402
