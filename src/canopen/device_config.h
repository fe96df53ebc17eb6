// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canopen/config.h"
#include "canopen/device_profile.h"
#include "canopen/eds/eds.h"
#include "canopen/lss/protocol.h"
#include "canopen/pdo/layout.h"

namespace cia402::canopen {

/// A drive that gets its node-ID by LSS at start-up, see bus::LssSupervisor.
struct DeviceLss {
  lss::Identity identity;
  bool store = false;  ///< in the drive, where it was another one
};

/// How the loss of the drive, and of the master, is noticed; what is not given is as profile and
/// bus have it.
struct ErrorControlOptions {
  std::optional<ErrorControl> kind;
  std::optional<Duration> period;          ///< of heartbeats, or guard time
  std::optional<Duration> timeout;         ///< until the drive is lost
  std::optional<Duration> master_timeout;  ///< until the drive takes the master for lost
};

/// The PDOs of one axis of a device.
struct PdoSet {
  std::vector<PdoLayout> pdos;  ///< resolved layout (planned, the profile's or the user's)
  bool planned = false;         ///< for this cycle; another one may get another plan
  bool by_sdo = false;          ///< what is in `pdos` is read and written by SDO instead
  /// Of what is in `pdos`, the objects that only defaults ask for.
  std::vector<std::string> default_objects;
  /// Of these, the feedback that is there only because its PDOs had room for it.
  std::vector<std::string> riders;
};

/// Typed configuration of one device on the bus. What the master needs of it is made from that:
/// config::makeMasterConfig().
struct DeviceConfig {
  std::string name;   ///< of the axis in it, of several the first one
  std::string title;  ///< for messages: "shoulder (node 3)", "left, right (node 3)"
  NodeId node_id = 0;
  std::shared_ptr<const DeviceProfile> profile;
  std::shared_ptr<const EdsInfo> eds;  ///< of its EDS or DCF; nullptr: none was given
  std::array<PdoSet, 8> axes;          ///< by the number of the axis in the device; most have one
  /// A TPDO that fails to come so many times in a row is stale; where it brings statusword or
  /// position, an enabled axis is quick-stopped then.
  std::uint16_t stale_after = 10;
  Duration rpdo_timeout{0};  ///< the drive reacts when none came for so long; zero: never
  ErrorControlOptions error_control;
  SdoChannel sdo;                                 ///< COB-IDs other than the predefined ones
  std::optional<fieldbus::Encoding> half_floats;  ///< of 16 bits; absent: as the profile says
  BootPolicy boot;
  std::optional<std::uint32_t> vendor_id, product_code, revision, serial;  ///< expected identity
  std::optional<DeviceLss> lss;
};

}  // namespace cia402::canopen
