// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// How messages call an axis whose joint has another name.
#include <sstream>

#include "system/scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::HasSubstr;
using testing::StartsWith;

constexpr char kWho[] = "hip (axis left, node 1)";
constexpr char kName[] = "hip (axis left)";

class Names : public testing::Test {
 protected:
  Names() : scene(loadText(robot())) {}
  static std::string robot() {
    std::string yaml = genericPair(", joint: hip");
    return yaml.replace(yaml.find("joints: [left"), 13, "joints: [hip");
  }
  std::string call(ProcedureKind kind, const std::string& mode = {}) {
    return scene.procedure(kind, "left", mode).message;
  }
  Scene scene;
};

TEST_F(Names, JointAndAxisStandInEveryAnswerOfAProcedure) {
  ASSERT_TRUE(scene.boot());
  EXPECT_THAT(scene.setpoint("left", 0.1), StartsWith(kWho));
  EXPECT_THAT(call(ProcedureKind::halt), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::clear_faults), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::enable), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::enable), StartsWith(kName)) << "already";
  EXPECT_THAT(call(ProcedureKind::recover), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::home), StartsWith(kWho)) << "none is configured";
  EXPECT_THAT(call(ProcedureKind::set_mode, "csv"), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::set_mode, "nonsense"), StartsWith(kWho));
  EXPECT_THAT(scene.move({0.1, 0.1}, 2s).message,
              AllOf(HasSubstr(std::string(kName) + " is in mode cyclic_velocity"),
                    HasSubstr("~left/set_mode cyclic_position first")));
  EXPECT_THAT(call(ProcedureKind::quick_stop), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::disable), StartsWith(kName));
  EXPECT_THAT(call(ProcedureKind::save_parameters), StartsWith(kWho));
}

TEST_F(Names, JointAndAxisStandInWhatIsSaidOfOneAmongAll) {
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.procedure(ProcedureKind::halt, "left").success);
  EXPECT_THAT(scene.procedure(ProcedureKind::recover).message,
              HasSubstr(std::string(kName) + " is halted: enable"));
}

TEST_F(Names, JointAndAxisStandInWhatIsReadAndWritten) {
  ASSERT_TRUE(scene.boot());
  const bus::ReadObjectCommand read{"left", "statusword"};
  const bus::WriteObjectCommand write{"left", "nonsense", "1"};
  EXPECT_THAT(scene.call(read).message, StartsWith(kWho));
  EXPECT_THAT(scene.call(write).message, StartsWith(kWho));
}

/// A group that ends otherwise than at its goal, as its rotor is blocked.
std::string outcomeOf(const std::string& tolerances) {
  std::string yaml = genericPair(", joint: hip", "", tolerances);
  ReadyScene scene(yaml.replace(yaml.find("joints: [left"), 13, "joints: [hip"));
  scene.inject("left", "blocked_rotor");
  EXPECT_TRUE(scene.move({0.004, 0.0}, 500ms).success);
  scene.run(2s);
  return scene.told();
}

TEST(NamesOfTrajectories, JointAndAxisStandInEveryOutcome) {
  EXPECT_THAT(outcomeOf(", constraints: {hip: {trajectory: 0.002}}"),
              HasSubstr(std::string("trajectory stopped: ") + kName + " is "));
  EXPECT_THAT(outcomeOf(", constraints: {goal_time: 0.2, hip: {goal: 0.001}}"),
              HasSubstr(std::string("goal missed: ") + kName + " is "));
}

TEST(NamesOfOptionalAxes, JointAndAxisStandInWhatIsLeftOut) {
  std::string yaml = genericPair(", joint: hip, optional: true");
  Scene scene(loadText(yaml.replace(yaml.find("joints: [left"), 13, "joints: [hip")));
  scene.robot().start();
  scene.drive("left").powerOff(scene.now());
  scene.port("left").setPowered(false);
  scene.run(8s);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable).message,
              HasSubstr(std::string(kName) + " is optional and not there"));
}

TEST_F(Names, EveryLineOfTheLogThatNamesTheNodeNamesJointAndAxis) {
  ASSERT_TRUE(scene.boot());
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.inject("left", "overcurrent");
  scene.run(500ms);
  scene.inject("left", "clear");
  ASSERT_TRUE(scene.procedure(ProcedureKind::recover).success);
  scene.inject("left", "power_cycle");
  scene.run(3s);
  ASSERT_TRUE(scene.procedure(ProcedureKind::recover).success);
  std::istringstream log(scene.told());
  int lines = 0;
  for (std::string line; std::getline(log, line);) {
    if (line.find("node 1") == std::string::npos) continue;
    ++lines;
    EXPECT_THAT(line, HasSubstr(kWho));
  }
  EXPECT_GE(lines, 5) << scene.told();
}

}  // namespace
}  // namespace cia402
