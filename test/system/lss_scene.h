// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "system/scene.h"

namespace cia402 {

inline std::string lssOf(int serial, const std::string& more = {}) {
  return ", lss: {vendor_id: 1234, product_code: 1026, revision: 65536, serial: " +
         std::to_string(serial) + more + "}";
}
inline std::string unconfigured(int serial) {
  return ", simulation: {unconfigured: true, serial: " + std::to_string(serial) + "}";
}
/// Starts the driver on drives that may have no node-IDs yet. @return whether all boot in time.
inline bool boots(Scene& scene, Duration limit = std::chrono::seconds(20)) {
  scene.robot().start();
  return scene.runUntil([&] { return allReady(scene.robot()); }, limit);
}
inline canopen::lss::Identity device(std::uint32_t serial) { return {1234, 1026, 65536, serial}; }

}  // namespace cia402
