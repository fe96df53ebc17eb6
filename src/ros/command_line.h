// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace cia402::ros_node {

/// Looks at a node's arguments before ROS does: `-h` and `--help` print `help`; anything else that
/// is no remapping of ROS (`name:=value`) is refused in words.
/// @return the exit status if the node shall not start.
std::optional<int> readCommandLine(int argc, const char* const* argv, const char* help);

}  // namespace cia402::ros_node
