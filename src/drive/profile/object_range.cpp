// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/object_range.h"

#include <string>

namespace cia402::drive {

std::optional<ObjectRange> parseObjectRange(std::string_view text) {
  const std::size_t dash = text.find('-');
  const std::string_view from = text.substr(0, dash);
  const auto first = fieldbus::parseObjectId(from);
  if (!first) return {};
  ObjectRange range{*first, *first};
  const bool one = from.find(':') != std::string_view::npos;
  if (!one) range.last.subindex = 0xFF;
  if (dash == std::string_view::npos) return range;
  const std::string_view to = text.substr(dash + 1);
  if (one && to.size() <= 2) {  // "2004:01-03"
    const auto last = fieldbus::parseObjectId("0:" + std::string(to));
    if (!last) return {};
    range.last.subindex = last->subindex;
  } else {
    const auto last = fieldbus::parseObjectId(to);
    if (!last) return {};
    range.last = *last;
    if (to.find(':') == std::string_view::npos) range.last.subindex = 0xFF;
  }
  if (range.last < range.first) return {};
  return range;
}

}  // namespace cia402::drive
