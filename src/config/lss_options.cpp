// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using Number = std::optional<std::uint32_t>;

struct Row {
  const char* key;
  Number DeviceConfig::*expected;
};
constexpr Row kRows[] = {
    {"vendor_id", &DeviceConfig::vendor_id},
    {"product_code", &DeviceConfig::product_code},
    {"revision", &DeviceConfig::revision},
    {"serial", &DeviceConfig::serial},
};

Number ofProfile(const DeviceConfig& device, std::size_t part) {
  if (!device.profile || part > 1) return {};
  return part == 0 ? device.profile->vendor_id : device.profile->product_code;
}

}  // namespace

void readLss(const yaml::Value& value, DeviceConfig& device, const RobotConfig& robot) {
  canopen::DeviceLss lss;
  const bool mapping = value.isMap();
  if (!mapping) {
    const auto wanted = value.boolean();
    if (!wanted || !*wanted) return;
  }
  yaml::Section section(mapping ? value
                                : yaml::Value(YAML::Node(YAML::NodeType::Map), value.path(),
                                              value.problems(), value.source()));
  std::string missing;
  for (std::size_t part = 0; part < canopen::lss::kParts; ++part) {
    Number given, &expected = device.*kRows[part].expected;
    section.readInteger(kRows[part].key, given, 0, 0xFFFFFFFF);
    if (given && expected && *given != *expected) {
      section.get(kRows[part].key)->problem("is another number than that under `identity`");
    }
    if (!expected) expected = given;
    if (!expected) expected = ofProfile(device, part);
    if (expected) {
      lss.identity.setPart(part, *expected);
    } else if (!section.has(kRows[part].key)) {
      append(missing, kRows[part].key, ", ");
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
  for (const DeviceConfig& other : robot.devices) {
    if (!other.lss || other.lss->identity != lss.identity) continue;
    value.problem("`" + other.name + "` has the same identity: LSS cannot tell the drives apart");
  }
  device.lss = lss;
}

}  // namespace cia402::config
