// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives that take no enabling between saving their parameters and being switched off and on.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::milliseconds;

TEST(PowerCycle, IsWhatASavedDriveNeedsBeforeItIsEnabledWhereItsProfileSaysSo) {
  for (const bool needed : {false, true}) {
    DriveProfile profile = test::testProfile();
    profile.parameters.power_cycle_after_save = needed;
    Bench bench(test::testConfig(std::move(profile)));
    bench.drive.dictionary[{0x1010, 1}] = {1, 4};
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.perform(ProcedureKind::save_parameters).success);
    bench.drive.controlwords.clear();
    const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
    EXPECT_EQ(status.success, !needed);
    if (!needed) continue;
    EXPECT_THAT(status.message, HasSubstr("is not enabled: its parameters were saved"));
    EXPECT_THAT(status.message, HasSubstr("switch it off and on"));
    EXPECT_TRUE(bench.drive.controlwords.empty());
    EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
    bench.reboot();
    ASSERT_TRUE(bench.runUntil([&] { return bench.axis.state().feedback_valid; }));
    EXPECT_TRUE(bench.perform(ProcedureKind::enable).success) << bench.axis.procedure().message;
  }
}

}  // namespace
}  // namespace cia402::drive
