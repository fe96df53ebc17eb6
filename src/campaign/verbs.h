// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "campaign/session.h"

namespace cia402::campaign {

/// The actions that a part of the player knows, by their first word.
template <typename Part>
using Verbs = std::map<std::string, void (Part::*)(const Words&)>;

/// Lets `part` do an action. @return false if it is none of its verbs.
template <typename Part>
bool actBy(const Verbs<Part>& verbs, Part& part, const Words& words) {
  const auto verb = verbs.find(words[0]);
  if (verb == verbs.end()) return false;
  (part.*verb->second)(words);
  return true;
}

}  // namespace cia402::campaign
