// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "can/link_settings.h"

namespace cia402::can {

/// Messages of rtnetlink as bytes, in the machine's own byte order (linux/rtnetlink.h,
/// linux/can/netlink.h).
std::vector<std::uint8_t> linkRequest(const std::string& name, std::uint32_t sequence);
/// Asks for a restart of the controller of interface `index`; to be acknowledged.
std::vector<std::uint8_t> restartRequest(int index, std::uint32_t sequence);

/// What a message of the kernel says about an interface. @return nothing if it is none about one,
/// or cut short.
std::optional<LinkSettings> parseLink(const std::uint8_t* message, std::size_t size);
/// The errno value of an acknowledgement (0: done). @return nothing if it is none.
std::optional<int> parseAcknowledgement(const std::uint8_t* message, std::size_t size);

}  // namespace cia402::can
