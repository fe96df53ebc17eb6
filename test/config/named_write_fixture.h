// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/drive_family.h"
#include "drive/profile/named_write.h"
#include "folders.h"

namespace cia402::drive::test {

/// An axis of a shipped family.
inline AxisConfig axisOf(const char* drive) {
  Problems problems;
  AxisConfig axis;
  axis.name = "shoulder";
  axis.place = "node 3";
  axis.profile = std::make_shared<const DriveProfile>(
      config::loadDriveFamily(cia402::test::configFolder() + "/drives/" + drive + ".yaml", problems)
          .drive);
  EXPECT_EQ(problems.text(), "");
  axis.geometry.counts_per_turn = 6283.185307179586;  // 1000 counts per rad
  return axis;
}

inline NamedWrite write(const char* object, const char* from) {
  NamedWrite named;
  named.object = object;
  named.from = from;
  return named;
}

/// What is written; 0xBAD: nothing.
inline std::uint64_t rawOf(const NamedWrite& named, const AxisConfig& axis) {
  const auto resolved = resolveWrite(named, axis);
  EXPECT_TRUE(resolved) << (resolved ? "" : resolved.error().message);
  if (!resolved || !*resolved) return 0xBAD;
  return (*resolved)->raw;
}

}  // namespace cia402::drive::test
