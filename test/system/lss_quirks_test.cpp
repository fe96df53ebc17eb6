// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Drives without node-IDs whose LSS slaves do something otherwise.
#include <string>

#include "system/lss_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;

/// What slaves of other makers do otherwise, by their sources.
struct LssQuirk {
  const char* name;
  void (*set)(sim::DeviceBehaviour&);
  friend std::ostream& operator<<(std::ostream& out, const LssQuirk& quirk) {
    return out << quirk.name;
  }
};
const LssQuirk kLssQuirks[] = {
    {"knows_no_4Ch", [](sim::DeviceBehaviour& b) { b.lss_identify_unconfigured = false; }},
    {"waits_for_a_reset", [](sim::DeviceBehaviour& b) { b.lss_waits_for_reset = true; }},
    {"sends_no_boot_up", [](sim::DeviceBehaviour& b) { b.boot_up_message = false; }},
    {"all_of_them",
     [](sim::DeviceBehaviour& b) {
       b.lss_identify_unconfigured = b.boot_up_message = false;
       b.lss_waits_for_reset = b.lss_scanned_with_node_id = true;
     }},
};

class QuirkyLss : public testing::TestWithParam<LssQuirk> {};

TEST_P(QuirkyLss, ADriveThatForgotItsNodeIdGetsItAgain) {
  Scene scene(loadText(genericPair(lssOf(111) + unconfigured(111))));
  GetParam().set(scene.drive("left").device().behaviour());
  ASSERT_TRUE(boots(scene)) << scene.told();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health != Health::ready; }, 2s));
  ASSERT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 12s)) << scene.told();
  EXPECT_EQ(scene.drive("left").device().node(), 1);
}

TEST_P(QuirkyLss, ADriveThatIsGivenItsNodeIdByHandIsBooted) {
  Scene scene(loadText(genericPair(unconfigured(111))));
  GetParam().set(scene.drive("left").device().behaviour());
  scene.robot().start();
  scene.run(40s);  // the search has become slow
  ASSERT_EQ(scene.state("left").health, Health::absent);
  bus::LssAssignCommand assign;
  assign.identity = device(111);
  assign.node_id = 1;
  const auto assigned = call(scene, assign);
  ASSERT_TRUE(assigned.success) << assigned.message;
  EXPECT_TRUE(scene.runUntil([&] { return allReady(scene.robot()); }, 3s)) << scene.told();
}

TEST_P(QuirkyLss, RecoverGivesItItsNodeIdAndEnablesIt) {
  Scene scene(loadText(genericPair(lssOf(111) + unconfigured(111))));
  GetParam().set(scene.drive("left").device().behaviour());
  ASSERT_TRUE(boots(scene)) << scene.told();
  scene.inject("left", "power_cycle");
  ASSERT_TRUE(scene.runUntil([&] { return scene.state("left").health == Health::lost; }, 2s));
  scene.run(600ms);
  const auto recovered = scene.procedure(ProcedureKind::recover, "left");
  EXPECT_TRUE(recovered.success) << recovered.message;
  EXPECT_TRUE(scene.truth("left").power_stage_on);
}

INSTANTIATE_TEST_SUITE_P(Of, QuirkyLss, testing::ValuesIn(kLssQuirks),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace cia402
