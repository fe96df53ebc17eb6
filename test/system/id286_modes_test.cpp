// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Modes, stops and losses of the iD286-CNFA, in each reading of what its manual leaves open.
#include "system/families_bus_scene.h"
#include "system/field_profile.h"
#include "system/id286_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using drive::State;
using fieldbus::Health;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// A simulated drive that reads the manual in one of the ways in which it can be read.
struct Id286Reading {
  const char* name;
  const char* with;
};
void PrintTo(const Id286Reading& reading, std::ostream* out) { *out << reading.name; }

class Id286Edge : public testing::TestWithParam<Id286Reading> {};

// Which edge brings a set-point, that of bit 4 or 5, or none at all, and whether bit 12 ever falls
// again.
TEST_P(Id286Edge, BringsEverySetPointOneAfterTheOtherAndInMotion) {
  Id286Trace scene(
      familyJoint(kId286InPp, ", simulation: {with: {" + std::string(GetParam().with) + "}}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  for (const double goal : {0.2, -0.1, 0.3}) {
    ASSERT_EQ(scene.setpoint("joint", goal), "");
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), goal, 1e-4);
  }
  ASSERT_EQ(scene.setpoint("joint", 1.5), "");
  scene.run(800ms);
  ASSERT_GT(scene.velocity("joint"), 0.5);
  scene.clear();
  ASSERT_EQ(scene.setpoint("joint", 0.1), "");  // it turns round
  scene.run(4s);
  EXPECT_NEAR(scene.position("joint"), 0.1, 1e-4);
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << scene.told();
}

constexpr char kPp[] =
    "behaviour: profile_position, bit_8: stopped, bit_13: none, before_start: [15]";
constexpr char kAt0F[] =  // needs no edge: follows 607Ah as soon as it is enabled
    "modes: {1: {behaviour: profile_position, bit_8: stopped, bit_13: none, handshake: false, "
    "bit_12: always}}";
const std::string kBits[] = {
    "modes: {1: {" + std::string(kPp) + ", set_point_bit: 4, bit_12: acknowledge}}",
    "modes: {1: {" + std::string(kPp) + ", set_point_bit: 4, bit_12: started}}",
    "modes: {1: {" + std::string(kPp) + ", set_point_bit: 5, bit_12: acknowledge}}",
    "modes: {1: {" + std::string(kPp) + ", set_point_bit: 5, bit_12: started}}"};

INSTANTIATE_TEST_SUITE_P(Of, Id286Edge,
                         testing::Values(Id286Reading{"Bit4ThatIsAcknowledged", kBits[0].c_str()},
                                         Id286Reading{"Bit4WithABit12ThatStays", kBits[1].c_str()},
                                         Id286Reading{"Bit5ThatIsAcknowledged", kBits[2].c_str()},
                                         Id286Reading{"Bit5WithABit12ThatStays", kBits[3].c_str()},
                                         Id286Reading{"At0F", kAt0F}),
                         [](const auto& tested) { return std::string(tested.param.name); });

// A drive that follows 607Ah from 0Fh on, without any edge: the printed trace has no controlword
// for the first start [L1874]. What stands there when it is enabled must be where the motor is.
TEST(Id286StartAt0F, MovesNothingWhenItIsEnabledWithATargetThatIsLeftThere) {
  for (const char* pdos : {"", ", pdos: none"}) {
    const double place = -0.7;
    Id286Trace scene(familyJoint(
        kId286InPp,
        std::string(pdos) + ", simulation: {initial_position: -0.7, with: {" + kAt0F + "}}"));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    scene.drive("joint").dictionary().find({0x607A, 0})->number = 90000;  // 1.13 rad
    scene.forget();
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
    scene.run(1s);
    EXPECT_TRUE(scene.truth("joint").power_stage_on);
    EXPECT_LT(scene.seen("joint").travel(), 2.0 * oneCount(kId286InPp)) << scene.told();
    ASSERT_EQ(scene.setpoint("joint", place + 0.2), "");
    scene.run(2s);
    EXPECT_NEAR(scene.position("joint"), place + 0.2, 1e-4) << "it is such a drive";
  }
}

// Without an edge, by the drive alone: what the test above relies on.
TEST(Id286StartAt0F, IsWhatTheSimulatedDriveDoes) {
  Id286Trace scene(
      familyJoint(kId286InPp, ", pdos: none, simulation: {with: {" + std::string(kAt0F) + "}}"));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.run(100ms);
  scene.clear();
  scene.drive("joint").dictionary().find({0x607A, 0})->number = 2000;
  scene.run(2s);
  EXPECT_THAT(scene.controlwords, testing::Each(0x0FU));
  EXPECT_NEAR(scene.position("joint"), 2000.0 * oneCount(kId286InPp), 1e-4);
}

// Each word in SYNC periods of its own, or a drive that takes the last one would see no edge.
TEST(Id286Edges, LieInDifferentSyncPeriods) {
  TracedScene scene(familyJoint(kId286InPp));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.clear();
  ASSERT_EQ(scene.setpoint("joint", 0.4), "");
  scene.run(300ms);
  std::vector<std::string> words;  // in each SYNC period the last one, once
  std::string last;
  for (const std::string& line : scene.lines) {
    if (line.compare(0, 3, "080") == 0 && !last.empty() && (words.empty() || words.back() != last))
      words.push_back(last);
    if (line.compare(0, 4, "201 ") == 0) last = line.substr(4, 2);
  }
  EXPECT_THAT(words, testing::ElementsAre("0F", "2F", "3F", "0F"));
}

// 6502h of the maker lacks torque and has csp, or it says torque; `modes` of the axis count.
TEST(Id286Supported, ModesOf6502hStandInTheWayOfNothing) {
  for (const char* modes : {"165", "0x2D", "0"}) {
    Id286Trace scene(familyJointWith(
        kId286InPp, "[pp, pv, pt]",
        ", simulation: {with: {dictionary: [[0x6502, 0, supported_modes, uint32, ro, -, " +
            std::string(modes) + "]]}}"));
    ASSERT_TRUE(scene.boot(20s)) << scene.told();
    std::vector<std::uint64_t> commanded;
    scene.watch([&] { appendChange(commanded, scene.number(0x6060)); });
    ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
    scene.run(200ms);
    EXPECT_THAT(commanded, testing::ElementsAre(1)) << "torque is tried on request only";
    EXPECT_TRUE(scene.procedure(ProcedureKind::set_mode, "joint", "pt").success);
    scene.run(100ms);
    EXPECT_THAT(commanded, testing::ElementsAre(1, 4));
    scene.watch({});
  }
}

TEST(Id286Csp, IsNeverChosenAndHadOnlyByAProfileOfOnesOwn) {
  Problems problems;
  config::loadRobot(
      YAML::Load(replaced(familyJoint(kId286InPp), "mode: pp, modes: [pp]", "mode: csp")),
      config::profilesIn({test::configFolder() + "/drives"}), problems);
  EXPECT_THAT(problems.text(), HasSubstr("profile id286_cnfa has no mode `cyclic_position`"));

  std::ifstream file(test::configFolder() + "/drives/id286_cnfa.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string forced =
      replaced(text.str(), "modes:\n  profile_velocity:",
               "modes:\n  cyclic_position: {value: 8, control: position, cyclic: true, target: "
               "target_position}\n  profile_velocity:");
  Scene scene(loadText(replaced(
      replaced(familyJoint(kId286InPp,
                           ", simulation: {drive: id286_cnfa, with: {modes: {8: {behaviour: "
                           "cyclic_position}}}}"),
               "mode: pp, modes: [pp]", "mode: csp, modes: [csp]"),
      "drive: id286_cnfa, counts", "drive: " + writeProfile(forced) + ", counts")));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  ASSERT_TRUE(enabled.success) << enabled.message;
  EXPECT_EQ(scene.truth("joint").mode, 8);
  EXPECT_TRUE(scene.move({0.4}, 2s).success);
  scene.run(3s);
  EXPECT_NEAR(scene.position("joint"), 0.4, 1e-3);
}

// 6040h, 6041h, 6071h and 6087h travel by PDO [L1681-1693]: 60 N m at the joint are 94 % of the
// current, 20 times as much a second.
TEST(Id286Torque, TravelsWithItsSlopeByPdo) {
  Scene scene(loadText(familyJoint(kId286InPt)));
  ASSERT_TRUE(scene.boot(20s)) << scene.told();
  const auto mapped = [&](std::uint16_t first, std::uint32_t object) {
    bool found = false;
    for (std::uint16_t pdo = 0; pdo < 4; ++pdo) {
      const auto map = static_cast<std::uint16_t>(first + pdo);
      for (std::uint8_t i = 1; i <= numberIn(scene, map); ++i) {
        found = found || numberIn(scene, map, i) == object;
      }
    }
    return found;
  };
  EXPECT_TRUE(mapped(0x1600, 0x60400010));
  EXPECT_TRUE(mapped(0x1600, 0x60710010));
  EXPECT_TRUE(mapped(0x1600, 0x60870020));
  EXPECT_TRUE(mapped(0x1A00, 0x60410010));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  scene.run(100ms);
  EXPECT_EQ(numberIn(scene, 0x6071), 0U);
  EXPECT_NEAR(static_cast<double>(numberIn(scene, 0x6087)), 20.0 * 60.0 / 50.0 / 1.27 * 100.0, 1.0);
  scene.stream("joint", 5.0, 300ms);
  EXPECT_NEAR(static_cast<double>(numberIn(scene, 0x6071)), 5.0 / 50.0 / 1.27 * 100.0, 1.0);
  EXPECT_GT(scene.velocity("joint"), 0.1);
}

/// From 8 s on the drive hears no controlword.
class Id286Deaf : public testing::TestWithParam<ProcedureKind> {};

TEST_P(Id286Deaf, StopIsGivenUpInTimeAndInWords) {
  Scene scene(loadText(familyJoint(
      kId286InPp, ", simulation: {with: {quirks: {local_from: 8.0, local_until: 30.0}}}")));
  ASSERT_TRUE(scene.boot(6s)) << scene.told();
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success);
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{7500ms}; }, 10s));
  ASSERT_EQ(scene.setpoint("joint", 2.4), "");
  ASSERT_TRUE(scene.runUntil([&] { return scene.now() >= Time{8100ms}; }, 10s));
  ASSERT_GT(scene.velocity("joint"), 0.3);
  const Time asked = scene.now();
  const bus::Answer stopped = scene.procedure(GetParam(), "joint");
  EXPECT_FALSE(stopped.success);
  EXPECT_LT(scene.now() - asked, 8s);
  EXPECT_THAT(stopped.message, AllOf(HasSubstr("joint (node 1)"),
                                     AnyOf(HasSubstr("2 s"), HasSubstr("given up after"),
                                           HasSubstr("timed out after"), HasSubstr("within"))));
  EXPECT_THAT(stopped.message, HasSubstr("statusword"));
}

INSTANTIATE_TEST_SUITE_P(To, Id286Deaf,
                         testing::Values(ProcedureKind::quick_stop, ProcedureKind::halt,
                                         ProcedureKind::disable),
                         [](const auto& tested) {
                           return std::string(drive::toString(tested.param));
                         });

constexpr char kWatchesMaster[] =
    ", simulation: {with: {dictionary: [{array: {index: 0x1016, name: consumer_heartbeat_time, "
    "count: 1, type: uint32, access: rw}}]}}";

std::string id286Pair(const std::string& more) {
  BusOptions bus;
  bus.more = more;
  return busRobot(busAxis(kBusId286, "left", 1, kWatchesMaster) +
                      busAxis(kBusId286, "right", 2, kWatchesMaster),
                  bus);
}

TEST(Id286Lost, OneOfTwoStopsBothWhereTheFileSaysSoAndTellsAlarm64WhenItIsBack) {
  for (const bool all : {false, true}) {
    Scene scene(loadText(id286Pair(all ? ", stop_all_on_loss: true" : "")));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    for (const char* joint : {"left", "right"}) {
      ASSERT_NO_FATAL_FAILURE(enableJoint(scene, joint));
      ASSERT_EQ(scene.setpoint(joint, 2.4), "");
    }
    scene.run(800ms);
    ASSERT_GT(scene.velocity("right"), 0.5);
    scene.port("left").setAttached(false);
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 1s));
    scene.run(500ms);
    EXPECT_EQ(scene.truth("right").power_stage_on, !all);
    EXPECT_EQ(std::fabs(scene.velocity("right")) > 0.5, !all) << scene.velocity("right");
    EXPECT_NEAR(scene.velocity("left"), 0.0, 1e-3) << "by itself, as its master is lost";
    if (!all) continue;
    EXPECT_THAT(scene.told(), HasSubstr("left (node 1) is lost: all axes get a quick stop"));
    EXPECT_THAT(scene.setpoint("right", 0.1), HasSubstr("right (node 2): not enabled"));
    scene.port("left").setAttached(true);
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 60s)) << scene.told();
    scene.run(500ms);
    EXPECT_THAT(scene.axis("left").faultText(),
                HasSubstr("left (node 1): fault 0x0064 communication lost while enabled"));
    EXPECT_THAT(scene.told(), HasSubstr("0x0064 communication lost while enabled"));
    EXPECT_FALSE(scene.truth("left").power_stage_on);
    const bus::Answer recovered = scene.procedure(ProcedureKind::recover, "left");
    EXPECT_TRUE(recovered.success) << recovered.message;
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene, "right"));
    expectGoes(scene, -0.2, "right");
  }
}

}  // namespace
}  // namespace cia402
