// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "canopen/device_profile.h"
#include "cia402_driver/common/result.h"
#include "cia402_driver/common/time.h"
#include "drive/profile/profile.h"

namespace cia402::config {

/// What an axis wants to travel by PDO.
struct PdoNeeds {
  std::string mode;                 ///< canonical name, a mode of the profile: the one to start in
  std::vector<std::string> modes;   ///< others that it may be switched to
  drive::FeedForward feed_forward;  ///< whose offsets travel with the modes that have them
  bool modes_required = false;  ///< one of `modes` that finds no room is an error; else left out
  /// Feedback beside statusword, position_actual and mode_display, most important first; what
  /// finds no room is left to SDO.
  std::vector<std::string> feedback;
  bool feedback_required = false;  ///< somebody asked for it by name
  /// Further feedback, where the PDOs that travel for the rest have room for it: no PDO more.
  std::vector<std::string> if_room;
  /// The PDOs of a direction that it may take, of a device whose axes share them.
  struct Share {
    std::vector<unsigned> taken;  ///< numbers that other axes have
    std::size_t most = 512;       ///< that it may take, the others shall have some, too
  };
  Share rpdos, tpdos;
  Duration cycle{std::chrono::milliseconds(4)};
  /// Velocity and torque shall not be older than this, where the cycle allows.
  Duration fresh{std::chrono::milliseconds(10)};
};

struct PdoPlan {
  std::vector<canopen::PdoLayout> pdos;
  std::vector<std::string> modes;   ///< that the plan serves, the one to start in first
  std::vector<std::string> by_sdo;  ///< feedback that found no room
  std::vector<std::string> riders;  ///< of PdoNeeds::if_room, what has found some
};

/// Chooses the PDO mapping of one axis: controlword and target of the start mode in one RPDO where
/// they fit, the targets of the other modes beside them, statusword, position and mode in a TPDO of
/// every cycle, the rest in slower ones; as little load on the bus as the profile's rules allow.
/// @return a sentence that says which rule is in the way and what to leave out, if there is no way.
Result<PdoPlan> planPdos(const drive::DriveProfile& profile, const canopen::DeviceProfile& device,
                         const PdoNeeds& needs);

}  // namespace cia402::config
