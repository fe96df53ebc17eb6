// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// NMT, heartbeat and node guarding with the families' drives, on the wire and in words.
#include <optional>

#include "system/families_bus_scene.h"
#include "system/interface_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using canopen::NmtState;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class FamilyNmt : public testing::TestWithParam<FamilyMode> {
 protected:
  static bus::Answer nmt(Scene& scene, const std::string& axis, const std::string& word) {
    return call(scene, bus::NmtServiceCommand{axis, word});
  }
  static std::string pair() {
    return busRobot(busAxis(GetParam(), "a", 1) + busAxis(GetParam(), "b", 2));
  }
};

INSTANTIATE_TEST_SUITE_P(All, FamilyNmt, allFamilies(), nameOfFamily);

TEST_P(FamilyNmt, TakesEachCommandAloneAndWithAllOthers) {
  TracedScene scene(pair());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  struct Row {
    const char *word, *byte;
    NmtState state;
  };
  for (const Row& row :
       {Row{"stop", "02", NmtState::stopped}, Row{"start", "01", NmtState::operational},
        Row{"pre_operational", "80", NmtState::pre_operational},
        Row{"start", "01", NmtState::operational},
        Row{"reset_communication", "82", NmtState::operational}}) {
    for (const bool all : {false, true}) {
      scene.clear();
      const bus::Answer answer = nmt(scene, all ? "" : "a", row.word);
      EXPECT_TRUE(answer.success) << row.word << ": " << answer.message;
      EXPECT_EQ(scene.truth("a").nmt, row.state) << row.word;
      if (all) {
        EXPECT_EQ(scene.truth("b").nmt, row.state) << row.word;
      }
      const bool each = all && row.byte == std::string("01");  // who is not there is not started
      if (!each) {
        EXPECT_THAT(scene.lines, Contains("000 " + std::string(row.byte) + (all ? " 00" : " 01")));
      }
    }
  }
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, kFamilyBoot)) << scene.told();
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
}

// A host that stands still is no master: its drives leave the state operational meanwhile, and what
// they have told before is not true any more.
TEST(NmtStart, CountsNothingThatIsOlderThanAStandstillOfTheHost) {
  // They miss their master 0.3 s after it, and say so in a heartbeat up to 0.1 s later.
  int judged = 0;
  for (int moment = 0; moment < 100; ++moment) {
    InterfaceScene scene(loadText(genericPair()), {});
    ASSERT_TRUE(scene.runUntil([&] { return scene.allReady(); }, 10s)) << scene.told();
    scene.run(std::chrono::milliseconds(13 * moment % 100));
    std::optional<bus::Answer> answer;
    scene.network().execute(bus::Command(bus::NmtServiceCommand{"left", "start"},
                                         [&](const bus::Answer& given) { answer = given; }),
                            scene.now());
    scene.run(std::chrono::milliseconds(moment % 7));
    if (answer) continue;
    ++judged;
    scene.stall(300ms + std::chrono::milliseconds(moment));
    ASSERT_TRUE(scene.runUntil([&] { return answer.has_value(); }, 10s)) << scene.told();
    EXPECT_TRUE(answer->success) << answer->message;
    EXPECT_EQ(scene.truth(0).nmt, NmtState::operational) << moment;
  }
  EXPECT_GT(judged, 50) << "most are not answered before the host stands still";
}

// A NiMotion does nothing by it [332-333]: it goes on, and is configured all the same.
TEST_P(FamilyNmt, ComesBackFromAResetAlsoWhereThatDoesNothing) {
  TracedScene scene(pair());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  const bool nothing = is(GetParam(), kBusNimotion);
  for (const char* axis : {"a", ""}) {
    scene.clear();
    const std::uint32_t boots = scene.node("a").bootUps();
    const Time begin = scene.now();
    const bus::Answer answer = nmt(scene, axis, "reset_node");
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_GE(scene.count("000 81"), 1U);
    EXPECT_LE(scene.count("000 81"), nothing ? 8U : 1U) << "the boot tries it again";
    EXPECT_EQ(scene.node("a").bootUps() - boots, nothing ? 0U : 1U);
    EXPECT_LT(scene.now() - begin, 12s);
    const char* in_vain = "switch it off and on for a start";
    if (nothing && *axis != '\0') {
      EXPECT_THAT(answer.message, HasSubstr(in_vain));
    } else {
      EXPECT_THAT(answer.message, Not(HasSubstr(in_vain)));
    }
    EXPECT_TRUE(allReady(scene.robot()));
  }
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
}

// Resets to which the drive gives no boot-up message hang nobody.
TEST(FamilyNmtReset, ThatDoesNothingHangsNobody) {
  TracedScene scene(busJoint(kBusNimotion));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_EQ(scene.count("701 00"), 1U) << "of the power-on alone";
  EXPECT_GE(scene.count("000 82 01"), 1U) << "it was told to";
  scene.clear();
  const Time begin = scene.now();
  const bus::Answer answer = call(scene, bus::NmtServiceCommand{"joint", "reset_communication"});
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(scene.count("701 00"), 0U);
  EXPECT_LT(scene.now() - begin, 6s);
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

TEST_P(FamilyNmt, IsBroughtBackWhenSomebodyElseStopsIt) {
  TracedScene scene(busJoint(GetParam()));
  Stranger stranger(scene.world());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  stranger.send(can::Frame(0x000, {0x02, 0x01}));
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").health != Health::ready; }, 200ms));
  EXPECT_GE(scene.count("701 04"), 1U) << "it says that it is stopped";
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, kFamilyBoot)) << scene.told();
  EXPECT_EQ(scene.truth("joint").nmt, NmtState::operational);
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

TEST_P(FamilyNmt, AnswersNoSdoWhileItIsStoppedAndIsAskedForNothing) {
  TracedScene scene(busJoint(GetParam()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(nmt(scene, "joint", "pre_operational").success);
  EXPECT_TRUE(scene.call(bus::ReadObjectCommand{"joint", "6041:00"}).success);
  ASSERT_TRUE(nmt(scene, "joint", "stop").success);
  scene.clear();
  const auto asked = scene.call(bus::ReadObjectCommand{"joint", "6041:00"});
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(asked.message, HasSubstr("answers no SDO"));
  EXPECT_EQ(scene.count("601"), 0U);
  ASSERT_TRUE(nmt(scene, "joint", "start").success);
  EXPECT_TRUE(scene.call(bus::ReadObjectCommand{"joint", "6041:00"}).success);
}

/// As `more` of an axis: rows in the dictionary that the manual tells of without listing them.
constexpr char kId286Guarded[] =
    ", simulation: {with: {dictionary: [[0x100C, 0, guard_time, uint16, rw, -, 0], "
    "[0x100D, 0, life_time_factor, uint8, rw, -, 0]]}}";
constexpr char kId286Consumer[] =
    ", simulation: {with: {dictionary: [{array: {index: 0x1016, name: consumer_heartbeat_time, "
    "count: 1, type: uint32, access: rw}}]}}";

// 100 ms = 64h; the master, node 127 = 7Fh, is missed after 300 ms = 12Ch.
TEST_P(FamilyNmt, HasItsHeartbeatWatchedAndWatchesThatOfTheDriver) {
  const bool id286 = is(GetParam(), kBusId286);
  TracedScene scene(busJoint(GetParam(), id286 ? kId286Consumer : ""));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_THAT(scene.writes(), Contains("2B 17 10 00 64 00 00 00"));
  const std::string watches = "23 16 10 01 2C 01 7F 00";
  if (is(GetParam(), kBusNimotion)) {
    EXPECT_THAT(scene.writes(), Not(Contains(HasSubstr(" 16 10 "))));
    EXPECT_THAT(scene.told(), HasSubstr("cannot notice a dead master"));
  } else {
    EXPECT_THAT(scene.writes(), Contains(watches));
    EXPECT_EQ(numberIn(scene, 0x1016, 1), 0x007F012CU);
  }
  scene.clear();
  scene.run(1s);
  EXPECT_NEAR(static_cast<double>(scene.count("701 05")), 10.0, 1.0);
  EXPECT_NEAR(static_cast<double>(scene.count("77F 05")), 10.0, 1.0);
  EXPECT_EQ(scene.node("joint").nmtState(), NmtState::operational);
}

TEST(FamilyHeartbeat, OfTheDriverIsWrittenOnlyWhereTheDriveHasAPlaceForIt) {
  Scene scene(loadText(busJoint(kBusId286)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("1016:01"), HasSubstr("cannot notice a dead master")));
}

TEST_P(FamilyNmt, IsLostWithoutItsHeartbeatToldAndCommandedNoMore) {
  TracedScene scene(busJoint(GetParam()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  ASSERT_EQ(scene.setpoint("joint", scene.state("joint").position + 2.0), "");
  scene.run(1s);
  ASSERT_GT(scene.velocity("joint"), 0.5);
  loseFrames(scene, 0x701);
  const Time begin = scene.now();
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").health == Health::lost; }, 1s));
  EXPECT_GE(scene.now() - begin, 200ms) << "two of its periods at least";
  EXPECT_LE(scene.now() - begin, 310ms);
  EXPECT_THAT(scene.told(), HasSubstr("joint (node 1): no heartbeat for 0.3 s"));
  EXPECT_THAT(scene.setpoint("joint", 0.1), Not(testing::IsEmpty()));
  scene.run(500ms);
  EXPECT_NEAR(scene.velocity("joint"), 0.0, 1e-3) << "it is told to stop, and hears that";
  scene.clear();
  scene.forget();
  scene.run(300ms);
  EXPECT_EQ(scene.count("201"), 0U);
  EXPECT_LT(scene.seen("joint").travel(), 1e-4);
  scene.world().bus().faults().clear();
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 60s)) << scene.told();
  scene.run(200ms);
  EXPECT_FALSE(scene.truth("joint").power_stage_on);
  EXPECT_TRUE(scene.procedure(ProcedureKind::recover, "joint").success) << scene.told();
}

// By node guarding where the manual has it, and then without a heartbeat: 100 ms, three times.
class FamilyGuarding : public testing::TestWithParam<FamilyMode> {
 protected:
  static std::string guarded() {
    return busJoint(GetParam(), std::string(", error_control: guarding") +
                                    (is(GetParam(), kBusId286) ? kId286Guarded : ""));
  }
};

INSTANTIATE_TEST_SUITE_P(Of, FamilyGuarding, testing::Values(kBusId286, kBusDamiao, kBusSv660c),
                         nameOfFamily);

TEST_P(FamilyGuarding, AsksByRemoteFramesAndNeverBesideAHeartbeat) {
  TracedScene scene(guarded());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 17 10 00 00 00 00 00", "2B 0C 10 00 64 00 00 00",
                                       "2F 0D 10 00 03 00 00 00"}));
  EXPECT_THAT(scene.writes(), Not(Contains(HasSubstr(" 16 10 "))));
  scene.clear();
  scene.run(1s);
  EXPECT_NEAR(static_cast<double>(scene.count("701 R")), 10.0, 1.0);
  EXPECT_NEAR(static_cast<double>(scene.count("701 05")), 5.0, 1.0) << "operational";
  EXPECT_NEAR(static_cast<double>(scene.count("701 85")), 5.0, 1.0) << "with the toggle bit";
  EXPECT_EQ(scene.count("701 05") + scene.count("701 85"), scene.count("701 R"));
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  expectGoes(scene, 0.3);
}

TEST_P(FamilyGuarding, FindsItLostWithoutAnswersOrWithAToggleBitThatStands) {
  for (const bool stuck : {false, true}) {
    TracedScene scene(guarded());
    Stranger stranger(scene.world());
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    if (stuck) {
      scene.port("joint").setAttached(false);
      std::size_t answered = scene.count("701 R");
      scene.watch([&scene, &stranger, answered]() mutable {
        for (; answered < scene.count("701 R"); ++answered) {
          stranger.send(can::Frame(0x701, {0x05}));
        }
      });
    } else {
      scene.port("joint").setAttached(false);
    }
    ASSERT_TRUE(scene.runUntil([&] { return scene.state("joint").health == Health::lost; }, 1s));
    EXPECT_THAT(scene.told(), HasSubstr(stuck ? "joint (node 1): no valid answer to node guarding"
                                              : "joint (node 1): no answer to node guarding for "
                                                "0.3 s"));
    scene.watch({});
    scene.port("joint").setAttached(true);
    ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 60s)) << scene.told();
    EXPECT_FALSE(scene.truth("joint").power_stage_on);
  }
}

TEST(FamilyHeartbeats, ThatAreTooShortForTheDriveAreRefused) {
  BusOptions bus;
  bus.heartbeat = "0.019";
  EXPECT_THAT(
      problemsOfRobot(busRobot(busAxis(kBusId286), bus)),
      AllOf(
          HasSubstr(
              "drives of profile id286_cnfa stand no heartbeat below 0.02 s, and this is 0.019 s"),
          HasSubstr("(bus/heartbeat)")));
  EXPECT_THAT(
      problemsOfRobot(busJoint(kBusId286,
                               ", error_control: {kind: guarding, period: "
                               "0.01}")),
      HasSubstr("axes/joint/error_control: drives of profile id286_cnfa stand no guard time below "
                "0.02 s, and this is 0.01 s; make it longer"));
  bus.heartbeat = "0.02";
  EXPECT_EQ(problemsOfRobot(busRobot(busAxis(kBusId286), bus)), "");
}

}  // namespace
}  // namespace cia402
