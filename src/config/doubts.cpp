// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a maker's manual leaves open, and an axis does all the same.
#include <algorithm>

#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {

void readTrusted(const yaml::Value& list, drive::AxisConfig& axis) {
  for (const yaml::Value& entry : list.list()) {
    const auto text = entry.text();
    if (!text) continue;
    const auto id = fieldbus::parseObjectAddress(*text);
    if (id && axis.profile->doubtful.find(*id) != nullptr) {
      axis.trusted.push_back(*id);
    } else {
      entry.problem("profile " + axis.profile->name + " calls nothing doubtful that is `" + *text +
                    "`: it can be written without being named here");
    }
  }
}

void checkDoubts(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot) {
  const drive::AxisConfig& axis = draft.axis;
  for (const drive::NamedWrite& write : axis.writes) {
    const auto id = drive::addressOf(*axis.profile, write.object);
    const std::string doubt = id ? drive::doubtOf(axis, *id) : std::string();
    if (!doubt.empty()) section.get("write")->problem("`" + write.object + "`: " + doubt);
  }
  if (!section.has("pdos") && !section.has("feedback")) return;
  for (const canopen::PdoLayout& pdo : draft.pdos().pdos) {
    for (const std::string& name : pdo.objects) {
      const drive::ObjectSpec* object = drive::findObject(*axis.profile, name);
      if (object == nullptr || object->doubt.empty()) continue;
      robot.warnings.push_back(
          "axes/" + axis.name + ": `" + object->name + "` in " +
          (pdo.direction == canopen::PdoDirection::rpdo ? "an RPDO" : "a TPDO") + ": " +
          object->doubt);
    }
  }
}

}  // namespace cia402::config
