// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What the families' drives remember of their errors, and what they save and restore.
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

class FamilyMemory : public testing::Test {
 protected:
  static bus::HistoryAnswer history(Scene& scene) {
    return scene.call(bus::ErrorHistoryCommand{"joint"});
  }
  static void strike(Scene& scene, const char* first, const char* second) {
    for (const char* fault : {first, second}) {
      scene.inject("joint", fault);
      scene.run(100ms);
      scene.inject("joint", "clear");
      scene.run(1500ms);
      EXPECT_TRUE(scene.procedure(ProcedureKind::clear_faults).success) << scene.told();
    }
  }
};

TEST_F(FamilyMemory, OfFaultsIsReadNewestFirstAndCleared) {
  struct Row {
    FamilyMode tested;
    const char *first, *second;
    std::uint16_t codes[2];
    bool cleared;
  };
  for (const Row& row : {Row{kBusNimotion, "over_voltage", "encoder_crc", {0x3110, 0xFF09}, true},
                         Row{kBusDamiao, "overcurrent", "encoder", {0x2310, 0x7305}, true},
                         Row{kBusId286, "over_voltage", "encoder", {0x000E, 0x001B}, false}}) {
    Scene scene(loadText(busJoint(row.tested)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    const bus::HistoryAnswer none = history(scene);
    EXPECT_TRUE(none.success) << none.message;
    EXPECT_THAT(none.message, HasSubstr("empty"));
    strike(scene, row.first, row.second);
    const bus::HistoryAnswer two = history(scene);
    ASSERT_EQ(two.history.entries.size(), 2U) << two.message;
    EXPECT_EQ(two.history.entries[0].code, row.codes[1]);
    EXPECT_EQ(two.history.entries[1].code, row.codes[0]);
    const auto cleared = scene.call(bus::WriteObjectCommand{"joint", "1003:00 u8", "0"});
    EXPECT_EQ(cleared.success, row.cleared) << cleared.message;
    if (row.cleared) {
      EXPECT_THAT(history(scene).message, HasSubstr("empty"));
    }
    if (!row.cleared) {
      EXPECT_THAT(cleared.message, HasSubstr("read-only"));
    }
  }
}

TEST_F(FamilyMemory, OfFaultsHoldsSixteenInANimotion) {
  Scene scene(loadText(busJoint(kBusNimotion)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  for (int i = 0; i < 9; ++i) strike(scene, "over_voltage", "encoder_crc");
  const bus::HistoryAnswer all = history(scene);
  ASSERT_EQ(all.history.entries.size(), 16U) << all.message;
  EXPECT_EQ(all.history.entries[0].code, 0xFF09);
  EXPECT_EQ(all.history.entries[15].code, 0x3110);
}

TEST_F(FamilyMemory, OfFaultsIsMissedInWords) {
  Scene scene(loadText(busJoint(kBusId286, ", simulation: {with: {without: [0x1003]}}")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_THAT(history(scene).message, HasSubstr("the drive keeps no error history"));
}

// 73 61 76 65 "save", 6C 6F 61 64 "load"; it takes longer to answer than other transfers may.
TEST_F(FamilyMemory, OfParametersIsWrittenOnRequestOnlyAndWithPatience) {
  for (const FamilyMode& tested : {kBusNimotion, kBusDamiao}) {
    const std::string subs = is(tested, kBusNimotion) ? "[1, 4]" : "[1, 2, 3, 4]";
    TracedScene scene(busJoint(tested, ", parameters: {save: " + subs + ", restore: " + subs +
                                           "}, simulation: {with: {communication: {store_time: "
                                           "3.0}}}"));
    expectBootsAndGoes(scene);
    const auto refused = scene.procedure(ProcedureKind::save_parameters, "joint");
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, HasSubstr("disable it first"));
    ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
    EXPECT_THAT(scene.writes(),
                AllOf(Not(Contains(HasSubstr(" 10 10 "))), Not(Contains(HasSubstr(" 11 10 ")))));
    const auto saved = scene.procedure(ProcedureKind::save_parameters, "joint");
    EXPECT_TRUE(saved.success) << saved.message;
    EXPECT_TRUE(inOrder(scene.writes(), {"23 10 10 01 73 61 76 65", "23 10 10 04 73 61 76 65"}));
    const std::uint32_t boots = scene.node("joint").bootUps();
    const auto restored = scene.procedure(ProcedureKind::restore_parameters, "joint");
    EXPECT_TRUE(restored.success) << restored.message;
    EXPECT_TRUE(inOrder(scene.writes(), {"23 11 10 01 6C 6F 61 64", "23 11 10 04 6C 6F 61 64"}));
    EXPECT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, kFamilyBoot));
    if (is(tested, kBusDamiao)) {
      EXPECT_EQ(scene.node("joint").bootUps(), boots + 1) << "a reset";
    }
    enableJoint(scene);
  }
}

TEST_F(FamilyMemory, OfParametersIsMissedInWords) {
  for (const FamilyMode& tested : {kBusId286, kBusDm5}) {
    Scene scene(loadText(busJoint(tested)));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    for (const auto kind : {ProcedureKind::save_parameters, ProcedureKind::restore_parameters}) {
      const bool by_object = is(tested, kBusDm5) && kind == ProcedureKind::restore_parameters;
      if (by_object) continue;  // P02.22
      const auto answer = scene.procedure(kind, "joint");
      EXPECT_FALSE(answer.success);
      EXPECT_THAT(answer.message, AllOf(HasSubstr("joint"), HasSubstr("0x06020000")));
    }
  }
}

}  // namespace
}  // namespace cia402
