// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/pdo_planner.h"
#include "config/drive_family.h"
#include "drive/profile/outputs.h"
#include "folders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace cia402::config {
namespace {

using canopen::PdoDirection;
using canopen::PdoLayout;
using testing::ElementsAre;
using testing::HasSubstr;

DriveFamily family(const std::string& name) {
  Problems problems;
  DriveFamily profile =
      loadDriveFamily(cia402::test::configFolder() + "/drives/" + name + ".yaml", problems);
  EXPECT_EQ(problems.text(), "");
  return profile;
}

PdoNeeds needs(const DriveFamily& profile, const std::string& mode = "cyclic_position") {
  PdoNeeds result;
  result.mode = mode;
  result.modes = profile.drive.default_modes;
  result.feedback = profile.drive.feedback;
  return result;
}

PdoPlan planned(const DriveFamily& profile, const PdoNeeds& what) {
  const Result<PdoPlan> plan = planPdos(profile.drive, profile.device, what);
  EXPECT_TRUE(plan.ok()) << (plan.ok() ? "" : plan.error().message);
  return plan.ok() ? *plan : PdoPlan();
}

/// "rpdo1: controlword target_position" and how often.
std::vector<std::string> lines(const PdoPlan& plan) {
  std::vector<std::string> result;
  for (const canopen::PdoLayout& pdo : plan.pdos) {
    const bool rpdo = pdo.direction == PdoDirection::rpdo;
    std::string text = (rpdo ? "rpdo" : "tpdo") + std::to_string(pdo.number) + " /" +
                       std::to_string(rpdo ? pdo.refresh_every : pdo.transmission) + ":";
    for (const std::string& object : pdo.objects) text += " " + object;
    result.push_back(text);
  }
  return result;
}

TEST(PdoPlanner, AGenericServoNeedsOneFrameEachWayPerCycle) {
  const DriveFamily profile = family("generic_cia402");
  EXPECT_THAT(lines(planned(profile, needs(profile))),
              ElementsAre("rpdo1 /1: controlword target_position", "rpdo2 /10: target_velocity",
                          "tpdo1 /1: statusword position_actual mode_display",
                          "tpdo2 /2: velocity_actual torque_actual",
                          "tpdo3 /10: error_code digital_inputs"));
}

TEST(PdoPlanner, WhatIsWantedIfThereIsRoomTravelsWhereItCostsNoPdo) {
  const DriveFamily profile = family("generic_cia402");
  PdoNeeds what = needs(profile);
  what.if_room = profile.drive.feedback_if_room;
  const PdoPlan plan = planned(profile, what);
  EXPECT_THAT(lines(plan),
              ElementsAre("rpdo1 /1: controlword target_position", "rpdo2 /10: target_velocity",
                          "tpdo1 /1: statusword position_actual mode_display",
                          "tpdo2 /2: velocity_actual torque_actual error_code",
                          "tpdo3 /10: digital_inputs following_error"))
      << "64 and 64 bits; TPDO 4 stays free";
  EXPECT_THAT(plan.riders, ElementsAre("following_error"));
}

TEST(PdoPlanner, WhatIsWantedIfThereIsRoomGetsNoPdoOfItsOwn) {
  const DriveFamily profile = family("generic_cia402");
  PdoNeeds what = needs(profile);
  what.if_room = {"following_error", "dc_link_voltage"};
  what.feedback = {};
  EXPECT_THAT(lines(planned(profile, what)),
              testing::Contains("tpdo1 /1: statusword position_actual mode_display"));
  EXPECT_TRUE(planned(profile, what).riders.empty()) << "8 bits are left, of 32";
  what.feedback = {"digital_inputs"};
  EXPECT_THAT(planned(profile, what).riders, ElementsAre("following_error")) << "the first of them";
}

TEST(PdoPlanner, ADamiaoServesAllItsModes) {
  const DriveFamily profile = family("damiao_dm");
  PdoNeeds what = needs(profile);
  for (const drive::ModeSpec& mode : profile.drive.modes) what.modes.push_back(mode.name);
  const PdoPlan plan = planned(profile, what);
  EXPECT_THAT(lines(plan), ElementsAre("rpdo1 /1: controlword target_position",
                                       "rpdo2 /10: target_velocity target_torque",
                                       "tpdo1 /1: statusword position_actual mode_display",
                                       "tpdo2 /2: velocity_actual torque_actual",
                                       "tpdo3 /10: error_code following_error"));
  EXPECT_EQ(plan.modes.size(), profile.drive.modes.size());
}

TEST(PdoPlanner, TheTargetOfTheStartModeTravelsWithTheControlword) {
  const DriveFamily profile = family("generic_cia402");
  EXPECT_THAT(lines(planned(profile, needs(profile, "cyclic_velocity"))),
              testing::Contains("rpdo1 /1: controlword target_velocity"));
}

TEST(PdoPlanner, WhatMayChangeAtAnyTimeTravelsWhereItsWorstCaseIsLeast) {
  const DriveFamily profile = family("generic_cia402");
  PdoNeeds what = needs(profile);
  what.modes = {"cyclic_torque"};
  // 8 bytes, 135 bits, in a cycle in which the torque changes; apart 115 + 75, though that is less
  // where it does not.
  EXPECT_THAT(lines(planned(profile, what)),
              testing::Contains("rpdo1 /1: controlword target_position target_torque"));
}

TEST(PdoPlanner, ASlowCycleBringsEverythingInEachCycle) {
  const DriveFamily profile = family("generic_cia402");
  PdoNeeds what = needs(profile);
  what.cycle = std::chrono::milliseconds(50);
  for (const canopen::PdoLayout& pdo : planned(profile, what).pdos) EXPECT_EQ(pdo.transmission, 1);
}

TEST(PdoPlanner, LeavesOptionalModesAndFeedbackOutWhereThereIsNoRoom) {
  DriveFamily profile = family("generic_cia402");
  profile.device.max_rpdos = profile.device.max_tpdos = 1;
  const PdoPlan plan = planned(profile, needs(profile));
  EXPECT_THAT(lines(plan), ElementsAre("rpdo1 /1: controlword target_position",
                                       "tpdo1 /1: statusword position_actual mode_display"));
  EXPECT_THAT(plan.modes, ElementsAre("cyclic_position", "profile_position", "homing"));
  EXPECT_THAT(plan.by_sdo,
              ElementsAre("velocity_actual", "torque_actual", "error_code", "digital_inputs"));
}

TEST(PdoPlanner, SaysWhichModeFindsNoRoomAndWhatToLeaveOut) {
  DriveFamily profile = family("generic_cia402");
  profile.device.max_rpdos = 1;
  PdoNeeds what = needs(profile);
  what.modes = {"cyclic_velocity"};
  what.modes_required = true;
  const auto plan = planPdos(profile.drive, profile.device, what);
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(
      plan.error().message,
      "mode `cyclic_velocity` finds no room: the drive has 1 RPDO of 64 bits with at most 8 "
      "objects, which controlword (16), target_position (32) fill already: `target_velocity` "
      "(32) would need another one; leave out `cyclic_velocity` or one of the modes before it");
}

TEST(PdoPlanner, TheTargetOfTheStartModeTravelsInEveryCycleAlsoByItself) {
  DriveFamily profile = family("generic_cia402");
  profile.device.max_pdo_entries = 1;
  EXPECT_THAT(lines(planned(profile, needs(profile))),
              testing::IsSupersetOf({"rpdo1 /1: controlword", "rpdo2 /1: target_position",
                                     "rpdo3 /10: target_velocity"}));
}

TEST(PdoPlanner, SaysWhyTheStartModeCannotBeServed) {
  DriveFamily profile = family("generic_cia402");
  profile.device.max_rpdos = 1;
  profile.device.max_pdo_entries = 1;
  const auto plan = planPdos(profile.drive, profile.device, needs(profile));
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().message,
              HasSubstr("mode `cyclic_position` needs controlword (16), target_position (32) in "
                        "RPDOs, but the drive has 1 RPDO of 64 bits with at most 1 objects"));
}

TEST(PdoPlanner, SaysThatATargetCannotBeMapped) {
  DriveFamily profile = family("generic_cia402");
  for (drive::ObjectSpec& object : profile.drive.objects) {
    if (object.name == "target_velocity") object.rpdo = false;
  }
  PdoNeeds what = needs(profile);
  what.modes = {"cyclic_velocity"};
  EXPECT_THAT(planned(profile, what).modes, ElementsAre("cyclic_position"));
  what.modes_required = true;
  const auto plan = planPdos(profile.drive, profile.device, what);
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().message, HasSubstr("`target_velocity`, which cannot be mapped"));
}

TEST(PdoPlanner, AModeIsSelectedBySdoOrByPdo) {
  DriveFamily profile = family("generic_cia402");
  const auto selectable = [&](bool writable, bool mappable) {
    for (drive::ObjectSpec& object : profile.drive.objects) {
      if (object.name != "mode_of_operation") continue;
      object.writable = writable;
      object.rpdo = mappable;
    }
    return planPdos(profile.drive, profile.device, needs(profile));
  };
  EXPECT_TRUE(selectable(true, false).ok());
  EXPECT_TRUE(selectable(false, true).ok());
  const auto plan = selectable(false, false);
  ASSERT_FALSE(plan.ok());
  EXPECT_THAT(plan.error().message, HasSubstr("mode `cyclic_position` cannot be selected: "
                                              "mode_of_operation can neither be written nor "
                                              "mapped"));
}

TEST(PdoPlanner, DoesNotUseAFixedRpdoThatWouldSendWhatNobodySets) {
  DriveFamily profile = family("generic_cia402");
  canopen::PdoLayout fixed;
  fixed.direction = PdoDirection::rpdo;
  fixed.number = 1;
  fixed.objects = {"controlword", "target_position", "max_torque"};
  profile.device.fixed_pdos = {fixed};
  EXPECT_THAT(lines(planned(profile, needs(profile))),
              testing::Contains("rpdo2 /1: controlword target_position"));
}

TEST(PdoPlanner, UsesAFixedRpdoWhereThereIsNoOther) {
  DriveFamily profile = family("generic_cia402");
  canopen::PdoLayout fixed;
  fixed.direction = PdoDirection::rpdo;
  fixed.number = 1;
  fixed.objects = {"controlword", "target_position"};
  profile.device.fixed_pdos = {fixed};
  profile.device.max_rpdos = 1;
  EXPECT_THAT(lines(planned(profile, needs(profile))),
              testing::Contains("rpdo1 /1: controlword target_position"));
}

/// A family made up by chance: rules, mappability and widths.
class RandomFamily {
 public:
  explicit RandomFamily(unsigned seed) : random_(seed), profile_(family("generic_cia402")) {
    for (drive::ObjectSpec& object : profile_.drive.objects) {
      const bool motion = object.quantity != drive::Quantity::none;
      constexpr fieldbus::DataType kTypes[] = {fieldbus::DataType::int8, fieldbus::DataType::int16,
                                               fieldbus::DataType::int32,
                                               fieldbus::DataType::int64};
      if (motion && below(3) == 0) object.type = kTypes[below(4)];
      if (below(8) == 0) object.rpdo = false;
      if (below(8) == 0) object.tpdo = false;
    }
    profile_.device.max_rpdos = 1 + below(5);
    profile_.device.max_tpdos = 1 + below(5);
    profile_.device.max_pdo_entries = 1 + below(8);
    for (unsigned i = below(4); i > 0; --i) addFixed();
    needs_.mode =
        profile_.drive.modes[below(static_cast<unsigned>(profile_.drive.modes.size()))].name;
    for (const drive::ModeSpec& mode : profile_.drive.modes) {
      if (below(2) == 0) needs_.modes.push_back(mode.name);
    }
    needs_.modes_required = below(2) == 0;
    for (const char* name : {"velocity_actual", "torque_actual", "error_code", "digital_inputs",
                             "following_error", "dc_link_voltage"}) {
      if (below(2) == 0) needs_.feedback.emplace_back(name);
    }
    needs_.cycle = std::chrono::milliseconds(1 + below(30));
  }
  const DriveFamily& profile() const { return profile_; }
  const PdoNeeds& needs() const { return needs_; }

 private:
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  void addFixed() {
    canopen::PdoLayout fixed;
    fixed.direction = below(2) == 0 ? PdoDirection::rpdo : PdoDirection::tpdo;
    const bool rpdo = fixed.direction == PdoDirection::rpdo;
    fixed.number = 1 + below(rpdo ? profile_.device.max_rpdos : profile_.device.max_tpdos);
    for (const canopen::PdoLayout& other : profile_.device.fixed_pdos) {
      if (other.direction == fixed.direction && other.number == fixed.number) return;
    }
    unsigned bits = 0;
    for (const drive::ObjectSpec& object : profile_.drive.objects) {
      const unsigned width = fieldbus::sizeBits(object.type);
      if (!(rpdo ? object.rpdo : object.tpdo) || below(4) != 0 || width == 0) continue;
      if (bits + width > 64 || fixed.objects.size() >= profile_.device.max_pdo_entries) break;
      bits += width;
      fixed.objects.push_back(object.name);
    }
    profile_.device.fixed_pdos.push_back(fixed);
  }

  std::mt19937 random_;
  DriveFamily profile_;
  PdoNeeds needs_;
};

bool isFixed(const DriveFamily& profile, const canopen::PdoLayout& pdo) {
  return std::any_of(profile.device.fixed_pdos.begin(), profile.device.fixed_pdos.end(),
                     [&](const canopen::PdoLayout& f) {
                       return f.direction == pdo.direction && f.number == pdo.number;
                     });
}

bool carries(const PdoPlan& plan, PdoDirection direction, const std::string& object) {
  return std::any_of(plan.pdos.begin(), plan.pdos.end(), [&](const canopen::PdoLayout& pdo) {
    return pdo.direction == direction &&
           std::find(pdo.objects.begin(), pdo.objects.end(), object) != pdo.objects.end();
  });
}

void check(const DriveFamily& profile, const PdoNeeds& what, const PdoPlan& plan) {
  std::map<std::pair<PdoDirection, unsigned>, int> numbers;
  std::map<std::pair<PdoDirection, std::string>, int> free_objects;
  for (const canopen::PdoLayout& pdo : plan.pdos) {
    const bool rpdo = pdo.direction == PdoDirection::rpdo;
    EXPECT_EQ(++numbers[std::make_pair(pdo.direction, pdo.number)], 1);
    EXPECT_GE(pdo.number, 1u);
    EXPECT_LE(pdo.number, rpdo ? profile.device.max_rpdos : profile.device.max_tpdos);
    EXPECT_LE(pdo.objects.size(), profile.device.max_pdo_entries);
    EXPECT_GE(pdo.transmission, 1);
    EXPECT_LE(pdo.transmission, 240);
    unsigned bits = 0;
    for (const std::string& name : pdo.objects) {
      const drive::ObjectSpec* object = profile.drive.find(name);
      ASSERT_NE(object, nullptr) << name;
      EXPECT_TRUE(rpdo ? object->rpdo : object->tpdo) << name;
      EXPECT_TRUE(!rpdo || drive::isSetByAxis(profile.drive, name)) << name;
      bits += fieldbus::sizeBits(object->type);
      if (!isFixed(profile, pdo)) {
        EXPECT_EQ(++free_objects[std::make_pair(pdo.direction, name)], 1) << name;
      }
    }
    EXPECT_GT(bits, 0u);
    EXPECT_LE(bits, 64u);
    for (const canopen::PdoLayout& fixed : profile.device.fixed_pdos) {
      if (fixed.direction == pdo.direction && fixed.number == pdo.number) {
        EXPECT_EQ(fixed.objects, pdo.objects) << "a fixed mapping was changed";
      }
    }
  }
  EXPECT_TRUE(carries(plan, PdoDirection::rpdo, "controlword"));
  EXPECT_TRUE(carries(plan, PdoDirection::tpdo, "statusword"));
  EXPECT_TRUE(carries(plan, PdoDirection::tpdo, "position_actual"));
  EXPECT_EQ(plan.modes.front(), what.mode);
  for (const std::string& name : plan.modes) {
    const std::string& target = profile.drive.mode(name)->target;
    EXPECT_TRUE(target.empty() || carries(plan, PdoDirection::rpdo, target)) << name;
  }
  for (const std::string& name : what.feedback) {
    const bool by_sdo =
        std::find(plan.by_sdo.begin(), plan.by_sdo.end(), name) != plan.by_sdo.end();
    EXPECT_NE(by_sdo, carries(plan, PdoDirection::tpdo, name)) << name;
  }
  if (!what.modes_required) return;
  for (const std::string& name : what.modes) {
    EXPECT_NE(std::find(plan.modes.begin(), plan.modes.end(), name), plan.modes.end()) << name;
  }
}

TEST(PdoPlannerProperty, EveryPlanKeepsTheRulesOrIsRefusedWithAReason) {
  unsigned plans = 0, refusals = 0;
  for (unsigned seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    const RandomFamily random(seed);
    const auto plan = planPdos(random.profile().drive, random.profile().device, random.needs());
    if (plan.ok()) {
      ++plans;
      check(random.profile(), random.needs(), *plan);
    } else {
      ++refusals;
      EXPECT_GT(plan.error().message.size(), 30u);
      EXPECT_THAT(plan.error().message,
                  testing::AnyOf(HasSubstr("the drive has"), HasSubstr("mapp")));
    }
    if (HasFailure()) break;
  }
  EXPECT_GT(plans, 60u);
  EXPECT_GT(refusals, 60u);
}

}  // namespace
}  // namespace cia402::config
