// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Values of the drive that its profile names to be shown.
#include "drive/axis_fixture.h"

namespace cia402::drive {
namespace {

using test::Bench;
using test::milliseconds;
using test::testConfig;

DriveProfile withTemperature() {
  DriveProfile profile = test::testProfile();
  profile.objects.push_back(test::object("drive_temperature", 0x2200, DataType::int16));
  profile.signals = {"drive_temperature"};
  return profile;
}

TEST(AxisSignals, ASignalOfTheProfileIsReadForALookAndGetsOld) {
  const DriveProfile profile = withTemperature();
  Bench bench(testConfig(profile));
  bench.drive.dictionary[{0x2200, 0}] = {0xFFF6, 2};  // -10
  ASSERT_TRUE(bench.boot());
  bench.run(milliseconds(400));
  ASSERT_EQ(bench.axis.signals(bench.now).size(), 1u);
  EXPECT_FALSE(bench.axis.signals(bench.now)[0].known) << "nobody has looked";
  bench.axis.look();
  const Time looked = bench.now;
  bench.run(milliseconds(200));
  const ShownSignal shown = bench.axis.signals(bench.now)[0];
  ASSERT_TRUE(shown.known);
  EXPECT_EQ(shown.object->name, "drive_temperature");
  EXPECT_EQ(shown.raw, 0xFFF6u);
  EXPECT_GE(shown.stamp, looked);
  EXPECT_LE(shown.stamp, looked + milliseconds(100));
  bench.run(milliseconds(2600));
  EXPECT_FALSE(bench.axis.signals(bench.now)[0].known) << "older than two looks a second apart";
}

TEST(AxisSignals, ASignalThatTheDriveLacksHasNoObject) {
  const DriveProfile profile = withTemperature();
  AxisConfig config = testConfig(profile);
  config.lacks = {"drive_temperature"};
  Bench bench(config);
  ASSERT_TRUE(bench.boot());
  bench.axis.look();
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.axis.signals(bench.now)[0].object, nullptr);
  EXPECT_FALSE(bench.axis.signals(bench.now)[0].known);
}

TEST(AxisSignals, ASignalThatATpdoBringsIsNotReadForALook) {
  const DriveProfile profile = withTemperature();
  test::Layout layout = test::testLayout();
  layout.inputs.push_back(test::thirdInput({0x2200, 0}, 16));
  Bench bench(testConfig(profile), layout);
  bench.drive.dictionary[{0x2200, 0}] = {100, 2};
  ASSERT_TRUE(bench.boot());
  bench.axis.look();
  bench.run(milliseconds(200));
  EXPECT_FALSE(bench.axis.signals(bench.now)[0].known);
  bench.bring({0x2200, 0}, 200);
  bench.cycle();
  EXPECT_EQ(bench.axis.signals(bench.now)[0].raw, 200u);
}

}  // namespace
}  // namespace cia402::drive
