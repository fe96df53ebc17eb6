// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes that lead a drive along a stream of positions by set-points (`set_point_stream`).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "profile/whole_profile.h"

namespace cia402::config {
namespace {

using testing::HasSubstr;

/// A drive whose only mode has these keys beside its number.
WholeProfile inMode(const std::string& keys, Problems& problems) {
  return parseDriveFamily(
      std::string(kLeastDrive) +
          "\n  fast: {object: \"6081:00\", type: uint32, quantity: velocity, pdo: rpdo}\n"
          "  ramp: {object: \"6084:00\", type: uint32, quantity: acceleration, unit: count/s^2,"
          " pdo: rpdo}\n"
          "  fixed: {object: \"607F:00\", type: uint32, quantity: velocity}\n"
          "modes:\n  led: {value: 1, " +
          keys + "}\n",
      "tested.yaml", problems);
}

const std::string kPositions = "control: position, target: target_position, ",
                  kStandard =
                      "handshake: new_set_point, status_bits: {set_point_acknowledge: 12}, ";

TEST(SetPointStreams, OfAModeSayWhichObjectTheirSpeedIs) {
  Problems problems;
  const WholeProfile profile = inMode(
      kPositions + kStandard +
          "cyclic: true, set_point_stream: {speed: fast, deceleration: ramp, interval: 0.04, "
          "catch_up: 0.2}",
      problems);
  ASSERT_TRUE(problems.empty()) << problems.text();
  const drive::ModeSpec& mode = *profile.mode("led");
  EXPECT_EQ(mode.set_point_stream->speed, "fast");
  EXPECT_EQ(mode.set_point_stream->deceleration, "ramp");
  EXPECT_DOUBLE_EQ(mode.set_point_stream->interval, 0.04);
  EXPECT_DOUBLE_EQ(mode.set_point_stream->catch_up, 0.2);
  EXPECT_THAT(mode.mapped, testing::ElementsAre("fast", "ramp")) << "it travels";
  EXPECT_FALSE(mode.runsOn()) << "a drive that hears nothing more comes to rest";
}

TEST(SetPointStreams, ThatCannotBeAreRefused) {
  const std::string stream = "cyclic: true, set_point_stream: {speed: fast}";
  const std::pair<std::string, const char*> mistakes[] = {
      {kPositions + stream, "needs the `handshake`"},
      {kPositions + kStandard + "set_point_stream: {speed: fast}", "`cyclic: true`"},
      {kPositions + kStandard + "cyclic: true, set_point_stream: {interval: 0.1}", "speed"},
      {kPositions + kStandard + "cyclic: true, set_point_stream: {speed: fixed}",
       "`fixed` is no object of the profile with `quantity: velocity` that an RPDO can carry"},
      {kPositions + kStandard + "cyclic: true, set_point_stream: {speed: fast, catch_up: 0.7}",
       "catch_up"},
      {kPositions + kStandard + "cyclic: true, set_point_stream: {speed: fast, deceleration: fast}",
       "`fast` is no object of the profile with `quantity: acceleration`"},
      {kPositions + kStandard + "relative_to: target, " + stream, "leave `queued` and"},
      {kPositions + kStandard + "cyclic: true", "cannot wait for an acknowledgement"}};
  for (const auto& [mode, told] : mistakes) {
    Problems problems;
    (void)inMode(mode, problems);
    EXPECT_THAT(problems.text(), HasSubstr(told)) << mode;
  }
}

}  // namespace
}  // namespace cia402::config
