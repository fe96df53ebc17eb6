// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "robot_parts.h"

namespace cia402::config {
namespace {

using drive::AxisConfig;
using drive::YamlSection;
using drive::YamlValue;
using Number = std::optional<std::uint32_t>;

struct Row {
  const char* key;
  Number AxisConfig::*expected;
};
constexpr Row kRows[] = {
    {"vendor_id", &AxisConfig::vendor_id},
    {"product_code", &AxisConfig::product_code},
    {"revision", &AxisConfig::revision},
    {"serial", &AxisConfig::serial},
};

Number ofProfile(const AxisConfig& axis, std::size_t part) {
  if (!axis.profile || part > 1) return {};
  return part == 0 ? axis.profile->vendor_id : axis.profile->product_code;
}

}  // namespace

void readLss(const YamlValue& value, AxisConfig& axis, const RobotConfig& robot) {
  drive::AxisLss lss;
  const bool mapping = value.isMap();
  if (!mapping) {
    const auto wanted = value.boolean();
    if (!wanted || !*wanted) return;
  }
  YamlSection section(mapping ? value
                              : YamlValue(YAML::Node(YAML::NodeType::Map), value.path(),
                                          value.problems(), value.source()));
  std::string missing;
  for (std::size_t part = 0; part < canopen::lss::kParts; ++part) {
    Number given, &expected = axis.*kRows[part].expected;
    section.readInteger(kRows[part].key, given, 0, 0xFFFFFFFF);
    if (given && expected && *given != *expected) {
      section.get(kRows[part].key)->problem("is another number than that under `identity`");
    }
    if (!expected) expected = given;
    if (!expected) expected = ofProfile(axis, part);
    if (expected) {
      lss.identity.setPart(part, *expected);
    } else if (!section.has(kRows[part].key)) {
      missing += (missing.empty() ? "" : ", ") + std::string(kRows[part].key);
    }
  }
  section.read("store", lss.store);
  section.finish();
  if (!missing.empty()) {
    value.problem(
        "needs all four numbers of the drive's identity (1018h), here or under "
        "`identity`; missing: " +
        missing);
    return;
  }
  for (const AxisConfig& other : robot.axes) {
    if (!other.lss || other.lss->identity != lss.identity) continue;
    value.problem("`" + other.name + "` has the same identity: LSS cannot tell the drives apart");
  }
  axis.lss = lss;
}

}  // namespace cia402::config
