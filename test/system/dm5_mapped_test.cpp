// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// KeptObjects of the 6000h of a DM5 in RPDOs that no cycle sets: they carry what the drive holds,
// or what was written last. What the joint does is read from the motor.
#include <set>

#include "bus/jobs/output_job.h"
#include "drive/profile/outputs.h"
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::HasSubstr;

constexpr FamilyMode kKeptCsp{"megmeet_dm5", "8388608", "csp"};
constexpr std::size_t kKeptBytes = 8,
                      kKeptRpdos = 3;  // of a frame; beside the one that moves the joint

std::string withRpdos(const std::string& rpdos, const std::string& more = {}) {
  return busJoint(kKeptCsp, ", pdos: {rpdo1: [controlword, target_position], " + rpdos +
                                ", tpdo1: [statusword, position_actual], tpdo2: [error_code]}" +
                                more);
}

using KeptObjects = std::vector<drive::ObjectSpec>;

/// What an RPDO of the drive may carry beyond what moves the joint or sets its outputs.
KeptObjects keptObjects() {
  const Scene known(loadText(busJoint(kKeptCsp)));
  const drive::DriveProfile& profile = *known.loaded().robot.axes[0].profile;
  KeptObjects found;
  for (const drive::ObjectSpec& object : profile.objects) {
    if (object.rpdo && drive::isKept(profile, {"cyclic_position"}, object.name)) {
      found.push_back(object);
    }
  }
  return found;
}

/// As many of them as find room, each in the first RPDO that has it: "rpdo2: [...], rpdo3: [...]".
std::string packedRpdos(KeptObjects& waiting, KeptObjects& taken) {
  std::string text;
  for (std::size_t rpdo = 0; rpdo < kKeptRpdos; ++rpdo) {
    std::string names;
    std::size_t used = 0;
    for (auto object = waiting.begin(); object != waiting.end();) {
      const std::size_t bytes = fieldbus::sizeBits(object->type) / 8;
      if (used + bytes > kKeptBytes) {
        ++object;
        continue;
      }
      used += bytes;
      names += (names.empty() ? "" : ", ") + object->name;
      taken.push_back(*object);
      object = waiting.erase(object);
    }
    if (names.empty()) break;
    text += (text.empty() ? "rpdo" : ", rpdo") + std::to_string(rpdo + 2) + ": [" + names + "]";
  }
  return text;
}

/// Numbers that nobody has written, each another one, where every number will do.
void fillWithNumbers(Scene& scene) {
  std::uint64_t number = 71;
  for (const unsigned index :
       {0x6066, 0x6067, 0x6068, 0x606D, 0x606E, 0x606F, 0x6070, 0x6087, 0x607C, 0x60B8}) {
    sim::Entry* entry =
        scene.drive("joint").dictionary().find({static_cast<std::uint16_t>(index), 0});
    entry->number = entry->initial_number = ++number;
  }
}

std::uint64_t heldByDrive(Scene& scene, const drive::ObjectSpec& object) {
  return numberIn(scene, object.id.index, object.id.subindex);
}

/// Another number that the drive takes for the object while it stands without power.
std::string anotherNumber(const drive::ObjectSpec& object, std::uint64_t number) {
  const std::map<std::string, const char*> chosen = {
      {"quick_stop_option", "6"},         {"halt_option", "2"},    {"shutdown_option", "0"},
      {"disable_operation_option", "0"},  {"polarity", "64"},      {"homing_method", "-3"},
      {"software_limit_min", "-1000000"}, {"home_offset", "-2"},   {"touch_probe_function", "16"},
      {"software_limit_max", "1000000"},  {"gear_numerator", "3"}, {"gear_denominator", "2"}};
  const auto found = chosen.find(object.name);
  return found != chosen.end() ? found->second : std::to_string(number == 0 ? 1 : number - 1);
}

std::uint64_t rawOfText(const drive::ObjectSpec& object, const std::string& text) {
  const unsigned bits = fieldbus::sizeBits(object.type);
  return static_cast<std::uint64_t>(std::stoll(text)) & ((std::uint64_t{1} << bits) - 1);
}

TEST(Dm5Kept, IsEachObjectThatAnRpdoMayCarryUntilItIsWritten) {
  // What the drive holds where RPDOs carry none of it.
  Scene plain(loadText(busJoint(kKeptCsp)));
  fillWithNumbers(plain);
  ASSERT_TRUE(plain.boot(kFamilyBoot)) << plain.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(plain));
  plain.run(100ms);

  KeptObjects waiting = keptObjects();
  EXPECT_EQ(waiting.size(), 34U);
  while (!waiting.empty()) {
    KeptObjects carried;
    Scene scene(loadText(withRpdos(packedRpdos(waiting, carried))));
    fillWithNumbers(scene);
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    scene.run(100ms);
    expectNothingMoved(scene, "joint");
    for (const drive::ObjectSpec& object : carried) {
      EXPECT_NE(scene.node("joint").image().outputSlot(object.id), fieldbus::kNoSlot);
      EXPECT_EQ(heldByDrive(scene, object), heldByDrive(plain, object)) << object.name;
    }
    expectGoes(scene, 0.05);
    ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
    for (const drive::ObjectSpec& object : carried) {
      const std::string text = anotherNumber(object, heldByDrive(scene, object));
      ASSERT_NE(rawOfText(object, text), heldByDrive(scene, object)) << object.name;
      const auto answer = scene.call(bus::WriteObjectCommand{"joint", object.name, text});
      EXPECT_TRUE(answer.success) << answer.message;
      scene.run(300ms);
      EXPECT_EQ(heldByDrive(scene, object), rawOfText(object, text))
          << object.name << " does not stay";
    }
  }
}

/// All frames of an RPDO, each content once.
std::set<std::string> contentsOf(const TracedScene& scene, const std::string& cob_id) {
  const std::vector<std::string> frames = scene.beginning(cob_id);
  return {frames.begin(), frames.end()};
}

// 6068h 16 bits, 6098h and 607Eh 8 bits, 607Ch 32 bits.
constexpr char kOfFourWidths[] =
    "rpdo2: [position_window_time, homing_method, polarity, home_offset]";

TEST(Dm5Kept, TravelsByteByByteAsTheFileHasWrittenIt) {
  TracedScene scene(withRpdos(
      kOfFourWidths,
      ", write: [{object: position_window_time, raw: 0x1234}, {object: homing_method, raw: -3}, "
      "{object: home_offset, raw: -2}]"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  EXPECT_EQ(contentsOf(scene, "301 "), std::set<std::string>{"301 34 12 FD 00 FE FF FF FF"});
  // Once it is written, whoever has asked for it.
  scene.clear();
  EXPECT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "position_window_time", "513"}).success);
  scene.run(100ms);
  EXPECT_EQ(contentsOf(scene, "301 "),
            (std::set<std::string>{"301 34 12 FD 00 FE FF FF FF", "301 01 02 FD 00 FE FF FF FF"}));
  EXPECT_EQ(scene.beginning("301 ").back(), "301 01 02 FD 00 FE FF FF FF");
  EXPECT_EQ(numberIn(scene, 0x6068), 0x0201U);
  // What the drive refuses changes nothing.
  scene.clear();
  scene.drive("joint").dictionary().onWriteCheck(
      {0x6068, 0}, [](const sim::Entry&, std::uint64_t) { return 0x06090030U; });
  EXPECT_FALSE(scene.call(bus::WriteObjectCommand{"joint", "position_window_time", "514"}).success);
  scene.run(100ms);
  EXPECT_EQ(contentsOf(scene, "301 "), std::set<std::string>{"301 01 02 FD 00 FE FF FF FF"});
}

TEST(Dm5Kept, TravelsInTheWidthThatTheDriveHasItIn) {
  TracedScene scene(withRpdos(
      kOfFourWidths,
      ", write: [{object: homing_method, raw: -3}, {object: home_offset, raw: 7}], simulation: "
      "{with: {dictionary: [[0x6098, 0, homing_method, int16, rw, r, 0]]}}"));
  ASSERT_FALSE(scene.boot(3s)) << "nine bytes";
  TracedScene other(withRpdos(
      "rpdo2: [position_window_time, homing_method, home_offset]",
      ", write: [{object: homing_method, raw: -3}, {object: home_offset, raw: 7}], simulation: "
      "{with: {dictionary: [[0x6098, 0, homing_method, int16, rw, r, 0]]}}"));
  ASSERT_TRUE(other.boot(kFamilyBoot)) << other.told();
  other.run(100ms);
  EXPECT_EQ(contentsOf(other, "301 "), std::set<std::string>{"301 0A 00 FD FF 07 00 00 00"});
}

TEST(Dm5Kept, IsReadAnewWhereTheDriveHasStartedAnew) {
  Scene scene(loadText(withRpdos("rpdo2: [position_window_time, following_error_time]")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "position_window_time", "77"}).success);
  scene.run(100ms);
  EXPECT_EQ(numberIn(scene, 0x6068), 77U);
  EXPECT_TRUE(scene.call(bus::NmtServiceCommand{"joint", "reset_node"}).success);
  scene.run(100ms);
  EXPECT_EQ(numberIn(scene, 0x6068), 10U) << "what it holds from power-on";
}

// 60FEh:02 lets each bit of 60FEh:01 through; both in an RPDO.
TEST(Dm5Kept, IsTheMaskOfOutputsWhichSomebodySets) {
  Scene scene(loadText(withRpdos("rpdo2: [digital_outputs, digital_outputs_mask]",
                                 ", write: [{object: do1_function, raw: 28}, {object: "
                                 "do2_function, raw: 28}]")));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  for (const auto& [name, on, outputs] :
       {std::tuple("do2", true, 0x20000U), std::tuple("do1", true, 0x30000U),
        std::tuple("do2", false, 0x10000U)}) {
    const bus::Answer set = scene.call(bus::SetOutputsCommand{"joint", {name}, {on}});
    EXPECT_TRUE(set.success) << set.message;
    scene.run(50ms);
    EXPECT_EQ(scene.truth("joint").outputs, outputs);
  }
}

// Neither written nor told.
TEST(Dm5Kept, OfWhichNobodyKnowsTheNumberIsRefusedInWords) {
  const auto untold = [](Scene& scene) {
    scene.drive("joint").dictionary().onRead({0x6066, 0}, [](sim::Entry&) { return 0x06010001U; });
  };
  Scene scene(loadText(withRpdos("rpdo2: [following_error_time]")));
  untold(scene);
  scene.robot().start();
  scene.run(5s);
  EXPECT_EQ(scene.state("joint").health, fieldbus::Health::failed);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("what RPDO 2 shall carry of 6066:00 "
                                            "following_error_time is not known"),
                                  HasSubstr("give it by `write`, or take it out of the RPDO")));
  Scene written(loadText(withRpdos("rpdo2: [following_error_time]",
                                   ", write: [{object: following_error_time, raw: 21}]")));
  untold(written);
  ASSERT_TRUE(written.boot(kFamilyBoot)) << written.told();
  written.run(100ms);
  EXPECT_EQ(numberIn(written, 0x6066), 21U);
}

}  // namespace
}  // namespace cia402
