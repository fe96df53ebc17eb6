// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/reply.h"
#include "canopen/config.h"
#include "cia402_driver/common/time.h"
#include "config/robot.h"
#include "fieldbus/bytes.h"

namespace cia402::bus {

class Network;

/// What a running bus is to take over of another configuration of the same robot. Made by whoever
/// asks; goes to the bus thread with the command and is left alone there from its reply on, so that
/// what is replaced is freed by who asked.
struct Reload {
  /// Of a node, what is written into it at each boot, and what of that it does not hold yet.
  struct Writes {
    struct Item {
      canopen::StartupWrite write;
      std::optional<fieldbus::Bytes> former;  ///< what was written before; absent: nothing was
    };
    canopen::NodeId node = 0;
    std::vector<canopen::StartupWrite> all;
    std::vector<Item> changed;
  };

  std::vector<drive::AxisConfig> axes;      ///< all, in the order of the configuration
  std::vector<config::GroupConfig> groups;  ///< likewise
  /// Limits or searches for home are others, too: for disabled axes alone.
  bool at_rest = false;
  std::vector<Writes> nodes;  ///< where `at_rest`
};

/// What a running robot and one with `next` are to each other. Both are valid, have the same axes,
/// devices and groups, and differ in what tune() and adopt() of axes and groups take over.
struct ReloadSource {
  const config::RobotConfig& robot;
  const canopen::MasterConfig& master;
};
/// @param at_rest see Reload
std::shared_ptr<Reload> makeReload(const ReloadSource& now, const ReloadSource& next, bool at_rest);

struct ReloadAnswer : Answer {
  bool not_disabled = false;  ///< refused as an axis is not disabled, or busy
};

/// Takes it over between two cycles, all of it or nothing. What belongs into drives is written into
/// them before; where one refuses it, what others have taken is taken back.
struct ReloadCommand {
  using Answer = ReloadAnswer;
  std::shared_ptr<Reload> reload;  ///< not nullptr

  void begin(Network& network, const Reply<Answer>& reply, Time now) const;
};

}  // namespace cia402::bus
