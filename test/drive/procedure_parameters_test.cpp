// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// save_parameters and restore_parameters.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using namespace std::chrono_literals;
using test::Bench;
using test::FakeDrive;
using test::HasSubstr;
using test::testConfig;
using testing::Contains;
using testing::Pair;

// CiA 301: the characters "save" and "load", the first one in the lowest byte.
constexpr std::uint64_t kSave = 0x65766173, kLoad = 0x64616F6C;
constexpr std::uint32_t kHardwareError = 0x06060000;

AxisConfig configured(std::vector<std::uint8_t> save, std::vector<std::uint8_t> restore) {
  AxisConfig config = testConfig();
  config.save = std::move(save);
  config.restore = std::move(restore);
  return config;
}

class Parameters : public testing::Test {
 protected:
  void SetUp() override {
    for (const unsigned index : {0x1010u, 0x1011u}) {
      for (unsigned sub = 1; sub <= 3; ++sub) bench.drive.dictionary[{index, sub}] = {1, 4};
    }
    ASSERT_TRUE(bench.boot());
    bench.drive.writes.clear();
  }
  std::size_t count(unsigned index) const {
    return static_cast<std::size_t>(
        std::count_if(bench.drive.writes.begin(), bench.drive.writes.end(),
                      [index](const auto& write) { return write.first == index; }));
  }
  Bench bench;
};

TEST_F(Parameters, AreSavedAllByDefault) {
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  ASSERT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message,
              HasSubstr("shoulder (node 3): saved 1010:01 (all parameters) in the drive's memory"));
  EXPECT_EQ(bench.drive.writes, (std::vector<std::pair<unsigned, std::uint64_t>>{{0x1010, kSave}}));
  EXPECT_EQ((bench.drive.dictionary[{0x1010, 1}]), std::make_pair(kSave, 4u));
}

TEST(ParametersBySubIndex, AreSavedOneAfterTheOther) {
  Bench bench(configured({2, 3}, {}));
  bench.drive.dictionary[{0x1010, 2}] = bench.drive.dictionary[{0x1010, 3}] = {1, 4};
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  ASSERT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("1010:02 (communication parameters), 1010:03 (application "
                                        "parameters)"));
  EXPECT_EQ((bench.drive.dictionary[{0x1010, 2}].first), kSave);
  EXPECT_EQ((bench.drive.dictionary[{0x1010, 3}].first), kSave);
  EXPECT_EQ((bench.drive.dictionary.count({0x1010, 1})), 0u) << "sub-index 1 was not chosen";
}

TEST_F(Parameters, AreNotTouchedWhileTheAxisIsEnabled) {
  ASSERT_TRUE(bench.enable());
  bench.drive.writes.clear();
  for (const auto kind : {ProcedureKind::save_parameters, ProcedureKind::restore_parameters}) {
    EXPECT_THAT(bench.refusal(kind), HasSubstr("the axis is not disabled (operation enabled); "
                                               "disable it first"));
  }
  EXPECT_TRUE(bench.drive.writes.empty());
  EXPECT_TRUE(bench.drive.operational);
}

TEST_F(Parameters, AreNotTouchedOnceTheDriveHasPower) {
  const auto started = bench.axis.start({ProcedureKind::save_parameters, {}, 0.0}, bench.now);
  ASSERT_TRUE(started);
  bench.drive.state = FakeDrive::S::on;  // e.g. by its own input
  bench.drive.stuck = {FakeDrive::S::on};
  bench.run(8ms);
  bench.drive.stuck.clear();
  EXPECT_FALSE(bench.axis.procedure().success);
}

TEST_F(Parameters, ThatCannotBeSavedOnCommandAreToldSo) {
  bench.drive.dictionary[{0x1010, 1}] = {2, 4};
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  EXPECT_FALSE(status.success);
  EXPECT_EQ(status.message,
            "shoulder (node 3): the drive does not save 1010:01 (all parameters) on command "
            "(1010:01 is 0x00000002); it saves by itself");
  EXPECT_EQ(count(0x1010), 0u);
  bench.drive.dictionary[{0x1011, 1}] = {0, 4};
  EXPECT_THAT(bench.perform(ProcedureKind::restore_parameters).message,
              HasSubstr("does not restore 1011:01 (all parameters) on command (1011:01 is "
                        "0x00000000); choose others with `parameters`"));
  EXPECT_TRUE(bench.drive.operational) << "not reset";
}

TEST_F(Parameters, ADriveThatRefusesIsNamedWithItsReason) {
  bench.drive.aborts[{0x1010, 1}] = kHardwareError;
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): cannot save 1010:01 (all parameters): "
                                        "the drive refused: 0x06060000"));
}

TEST_F(Parameters, ASlowMemoryIsWaitedForAndNotAskedTwice) {
  bench.drive.unanswered = {{0x1010, 1}};
  ASSERT_TRUE(bench.axis.start({ProcedureKind::save_parameters, {}, 0.0}, bench.now));
  bench.run(9s);
  ASSERT_TRUE(bench.axis.procedure().running);
  EXPECT_EQ(bench.axis.procedure().step, "saving parameters");
  EXPECT_EQ(bench.axis.procedure().waiting_for, "the drive to confirm 1010:01 (all parameters)");
  EXPECT_EQ(count(0x1010), 1u);
  EXPECT_THAT(bench.refusal(ProcedureKind::enable), HasSubstr("while save_parameters runs"));
  bench.device().confirm({0x1010, 1});
  bench.run(20ms);
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
}

TEST_F(Parameters, AMemoryThatNeverConfirmsEndsInATimeOut) {
  bench.drive.unanswered = {{0x1010, 1}};
  const Time began = bench.now;
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("no answer within 10000 ms"));
  EXPECT_LT(bench.now - began, 11s);
  EXPECT_EQ(count(0x1010), 1u);
}

TEST_F(Parameters, AreRestoredAndTheNodeIsResetAndConfiguredAgain) {
  const std::uint32_t before = bench.device().bootUps();
  const ProcedureStatus& status = bench.perform(ProcedureKind::restore_parameters);
  ASSERT_TRUE(status.success) << status.message;
  EXPECT_THAT(status.message, HasSubstr("shoulder (node 3): restored the factory's values of "
                                        "1011:01 (all parameters); the drive was reset, configured "
                                        "again by the driver and is disabled"));
  EXPECT_EQ(bench.drive.writes.front(), std::make_pair(0x1011u, kLoad));
  EXPECT_EQ(bench.device().bootUps(), before + 1);
  EXPECT_TRUE(bench.drive.operational);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
  bench.run(100ms);
  EXPECT_EQ(bench.drive.state, FakeDrive::S::disabled);
}

TEST_F(Parameters, ADriveThatDoesNotComeBackIsTold) {
  ASSERT_TRUE(bench.axis.start({ProcedureKind::restore_parameters, {}, 0.0}, bench.now));
  bench.each_cycle = [&] { bench.drive.dead = bench.axis.procedure().step == "booting the node"; };
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_FALSE(bench.axis.procedure().success);
  EXPECT_THAT(bench.axis.procedure().message,
              HasSubstr("restored the factory's values of 1011:01 (all parameters) and reset it, "
                        "but it did not boot"));
}

TEST(ParametersBySubIndex, EachIsAskedForItselfAndWhatWasDoneBeforeIsTold) {
  Bench bench(configured({2, 3}, {}));
  bench.drive.dictionary[{0x1010, 2}] = {1, 4};
  bench.drive.dictionary[{0x1010, 3}] = {0, 4};  // not on command
  ASSERT_TRUE(bench.boot());
  const ProcedureStatus& status = bench.perform(ProcedureKind::save_parameters);
  EXPECT_FALSE(status.success);
  EXPECT_THAT(status.message, HasSubstr("does not save 1010:03 (application parameters)"));
  EXPECT_THAT(status.message, HasSubstr("; done before that: 1010:02 (communication parameters)"));
  EXPECT_EQ((bench.drive.dictionary[{0x1010, 3}].first), 0u);
}

TEST_F(Parameters, WaitUntilTheAxisIsSeenToStand) {
  ASSERT_TRUE(bench.axis.start({ProcedureKind::save_parameters, {}, 0.0}, bench.now));
  bench.cycle();
  EXPECT_EQ(bench.axis.procedure().step, "waiting for rest");
  EXPECT_EQ(bench.axis.procedure().waiting_for, "the axis to be seen standing");
  bench.run(200ms);
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
}

TEST(RestoredParameters, MayHoldAnotherZeroUnlessTheyAreOfTheCommunication) {
  for (const std::uint8_t subindex : std::vector<std::uint8_t>{1, 2, 3, 4}) {
    SCOPED_TRACE(int{subindex});
    Bench bench(configured({}, {subindex}));
    bench.drive.dictionary[{0x1011, subindex}] = {1, 4};
    ASSERT_TRUE(bench.boot());
    ASSERT_TRUE(bench.axis.state().homed);
    const ProcedureStatus& status = bench.perform(ProcedureKind::restore_parameters);
    ASSERT_TRUE(status.success) << status.message;
    EXPECT_EQ(bench.axis.state().homed, subindex == 2);
    EXPECT_EQ(status.message.find("not homed") == std::string::npos, subindex == 2);
  }
}

TEST(RestoredParameters, ThatTheDriveRefusesLeaveTheZero) {
  Bench bench(configured({}, {1}));
  bench.drive.dictionary[{0x1011, 1}] = {1, 4};
  ASSERT_TRUE(bench.boot());
  bench.drive.aborts[{0x1011, 1}] = kHardwareError;
  EXPECT_FALSE(bench.perform(ProcedureKind::restore_parameters).success);
  EXPECT_TRUE(bench.axis.state().homed);
}

TEST_F(Parameters, ADriveThatTakesItsTimeToComeBackIsWaitedFor) {
  bench.run(60s);
  ASSERT_TRUE(bench.axis.start({ProcedureKind::restore_parameters, {}, 0.0}, bench.now));
  Time reset{};
  bench.each_cycle = [&] {
    if (reset == Time{} && bench.axis.procedure().step == "booting the node") reset = bench.now;
    bench.drive.mute = reset != Time{} && bench.now - reset < 300ms;
  };
  ASSERT_TRUE(bench.runUntil([&] { return !bench.axis.procedure().running; }));
  EXPECT_TRUE(bench.axis.procedure().success) << bench.axis.procedure().message;
  EXPECT_GE(bench.now - reset, 300ms);
}

TEST_F(Parameters, ANodeThatIsNotThereIsRefused) {
  bench.drive.dead = true;
  ASSERT_TRUE(bench.runUntil([&] { return bench.device().health() == fieldbus::Health::lost; }));
  EXPECT_THAT(bench.refusal(ProcedureKind::save_parameters),
              HasSubstr("cannot save parameters: the node is lost"));
}

TEST(SavedParameters, AfterWhichADriveWantsToBeSwitchedOffKeepItFromBeingEnabled) {
  for (const bool wants : {true, false}) {
    SCOPED_TRACE(wants);
    DriveProfile profile = test::testProfile();
    profile.parameters.power_cycle_after_save = wants;
    Bench bench(testConfig(profile));
    bench.drive.dictionary[{0x1010, 1}] = {1, 4};
    ASSERT_TRUE(bench.boot());
    const ProcedureStatus saved = bench.perform(ProcedureKind::save_parameters);
    ASSERT_TRUE(saved.success) << saved.message;
    EXPECT_EQ(saved.remark, wants);
    const ProcedureStatus& status = bench.perform(ProcedureKind::enable);
    EXPECT_EQ(status.success, !wants);
    if (!wants) continue;
    EXPECT_THAT(saved.message, HasSubstr("switch the drive off and on before it is enabled"));
    EXPECT_THAT(status.message, HasSubstr("is not enabled: its parameters were saved"));
    bench.reboot();
    EXPECT_TRUE(bench.perform(ProcedureKind::recover).success);
  }
}

}  // namespace
}  // namespace cia402::drive
