// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Single frames and values that manuals print, byte by byte and in both directions: the simulated
// drive gets them and does what is printed beside them, and the driver sends them. Sequences are in
// printed_sequences_test.cpp; numbers in brackets are lines of the manual in question.
#include "bus/jobs/touch_probe_job.h"
#include "system/families_bus_scene.h"
#include "system/printed_scene.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using sim::ms;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr char kPrintedNimotion[] = "nimotion_stepper", kPrintedSv660c[] = "sv660c",
               kPrintedDm5[] = "megmeet_dm5", kPrintedDamiao[] = "damiao_dm";

bus::ObjectAnswer readPrinted(Scene& scene, const std::string& object) {
  return scene.call(bus::ReadObjectCommand{"joint", object});
}

// --- NiMotion ------------------------------------------------------------------------------------

// The data of the request are dots there [153-156].
TEST(NimotionPrintedFrames, RefuseAWriteToTheStatusword) {
  PrintedDrive drive(kPrintedNimotion);
  for (const std::string data : {" 00 00 00 00", " 37 02 00 00", " FF FF FF FF"}) {
    EXPECT_EQ(drive.ask("23 41 60 00" + data), "80 41 60 00 02 00 01 06");
  }
  // The driver writes no such object: another master does, and gets that answer.
  TracedScene scene(busJoint(kBusNimotion));
  Stranger stranger(scene.world());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  const std::string told = scene.told();
  scene.clear();
  stranger.send(printedFrame(0x601, "23 41 60 00 00 00 00 00"));
  scene.run(100ms);
  EXPECT_TRUE(inOrder(scene.lines, {"601 23 41 60 00 00 00 00 00", "581 80 41 60 00 02 00 01 06"}));
  EXPECT_EQ(scene.told(), told);
  expectGoes(scene, 0.3);
  const bus::Answer refused = scene.call(bus::WriteObjectCommand{"joint", "6041:00", "0"});
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("6041:00 statusword"));
}

// [1981-2001]; what is restored counts from the next power-on.
TEST(NimotionPrintedFrames, SaveAndRestoreParameters) {
  for (const char* sub : {"01", "04"}) {
    PrintedDrive drive(kPrintedNimotion);
    const auto powerCycle = [&] {
      drive.drive->powerOff(drive.now);
      drive.run(ms(100));
      drive.drive->powerOn(drive.now);
      drive.run(ms(1000));
      return drive.ask("40 08 20 01 00 00 00 00");
    };
    const std::string write = "2B 08 20 01 96 00 00 00", kept = "4B 08 20 01 96 00 00 00";
    drive.take({write.c_str()});
    drive.take({("23 10 10 " + std::string(sub) + " 73 61 76 65").c_str()});
    EXPECT_EQ(powerCycle(), kept) << sub;
    drive.take({("23 11 10 " + std::string(sub) + " 6C 6F 61 64").c_str()});
    EXPECT_EQ(powerCycle(), "4B 08 20 01 C8 00 00 00") << "200 from the factory";
  }
  TracedScene scene(busJoint(kBusNimotion, ", parameters: {save: [1, 4], restore: [1, 4]}"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.clear();
  EXPECT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success) << scene.told();
  EXPECT_TRUE(scene.procedure(ProcedureKind::restore_parameters, "joint").success) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"23 10 10 01 73 61 76 65", "23 10 10 04 73 61 76 65",
                                       "23 11 10 01 6C 6F 61 64", "23 11 10 04 6C 6F 61 64"}));
}

// VDI1 low, then high [2010-2013]: the present position is the zero.
TEST(NimotionPrintedFrames, MakeThePresentPositionTheZero) {
  sim::AxisMechanics mechanics;
  mechanics.initial_position = 2.0;
  PrintedDrive drive(kPrintedNimotion, mechanics);
  drive.take({"2B 17 20 02 00 00 00 00"});
  EXPECT_EQ(drive.position(), 8000);
  drive.take({"2B 17 20 02 01 00 00 00"});
  EXPECT_EQ(drive.position(), 0);
  TracedScene scene(busJoint(kBusNimotion,
                             ", homing: {method: 35, offset: 0.7}, simulation: "
                             "{initial_position: 1.3}"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.clear();
  EXPECT_TRUE(scene.procedure(ProcedureKind::home, "joint").success) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"2B 17 20 02 00 00 00 00", "2B 17 20 02 01 00 00 00"}));
  EXPECT_NEAR(scene.state("joint").position, 0.7, 1e-4);
}

// [2019-2042]; the time in quarters of an hour.
TEST(NimotionPrintedFrames, ReadTheTimeAndTheVersions) {
  struct Row {
    const char *request, *answer, *object;
    fieldbus::ObjectId id;
    std::uint32_t number;
    const char* told;
  };
  TracedScene scene(busJoint(kBusNimotion));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  for (const Row& row : {Row{"40 0B 20 06 00 00 00 00",
                             "43 0B 20 06 07 00 00 00",
                             "powered_time",
                             {0x200B, 6},
                             7,
                             "6300 s"},
                         Row{"40 02 20 05 00 00 00 00",
                             "43 02 20 05 03 02 01 00",
                             "hardware_version",
                             {0x2002, 5},
                             0x010203,
                             "66051"},
                         Row{"40 18 10 03 00 00 00 00",
                             "43 18 10 03 0A 00 02 00",
                             "1018:03 u32",
                             {0x1018, 3},
                             0x02000A,
                             "131082"}}) {
    PrintedDrive drive(kPrintedNimotion);
    drive.object(row.id.index, row.id.subindex).number = row.number;
    EXPECT_EQ(drive.ask(row.request), row.answer);
    scene.drive("joint").dictionary().find(row.id)->number = row.number;
    scene.clear();
    const bus::ObjectAnswer read = readPrinted(scene, row.object);
    EXPECT_THAT(read.message, HasSubstr(row.told));
    EXPECT_TRUE(inOrder(scene.lines,
                        {"601 " + std::string(row.request), "581 " + std::string(row.answer)}));
  }
}

// Boot-up, NMT and the states of the heartbeat [328-333, 354-367].
TEST(NimotionPrintedFrames, TellTheStatesOfTheNode) {
  PrintedDrive drive(kPrintedNimotion);
  EXPECT_EQ(drive.count(0x701), 1U);
  EXPECT_EQ(wireText(drive.sent.at(0)), "701 00");
  drive.take({"2B 17 10 00 64 00 00 00"});
  struct Row {
    const char *nmt, *heartbeat;
  };
  for (const Row& row : {Row{"01 01", "701 05"}, Row{"02 01", "701 04"}, Row{"80 01", "701 7F"}}) {
    drive.drive->receive(printedFrame(0x000, row.nmt), drive.now);
    drive.sent.clear();
    drive.run(ms(100));
    ASSERT_EQ(drive.count(0x701), 1U) << row.nmt;
    EXPECT_THAT(drive.sent, Contains(printedFrame(0x701, std::string(row.heartbeat).substr(4))));
  }
}

// 80000181h: not in use; 181h: in use, of node 1 [230].
TEST(NimotionPrintedFrames, SwitchTheFirstTpdoOffAndOn) {
  PrintedDrive drive(kPrintedNimotion);
  drive.take({"23 00 18 01 81 01 00 80"});
  EXPECT_EQ(drive.ask("40 00 18 01 00 00 00 00"), "43 00 18 01 81 01 00 80");
  drive.nmt(0x01);
  drive.run(ms(500));
  EXPECT_EQ(drive.count(0x181), 0U);
  drive.nmt(0x80);
  drive.take({"23 00 18 01 81 01 00 00"});
  EXPECT_EQ(drive.ask("40 00 18 01 00 00 00 00"), "43 00 18 01 81 01 00 00");
  drive.nmt(0x01);
  drive.run(ms(500));
  EXPECT_GE(drive.count(0x181), 1U);
  TracedScene scene(busJoint(kBusNimotion));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"23 00 18 01 81 01 00 80", "23 00 18 01 81 01 00 00"}));
}

// --- SV660C --------------------------------------------------------------------------------------

// Rows 4 to 10 of the table of transitions: the word, and bits 0 to 9 of the statusword [511-536].
TEST(Sv660cPrintedWords, DisableByEachWay) {
  struct Way {
    const char* transitions;
    std::vector<std::string> words, statuswords;
  };
  for (const Way& way :
       {Way{"5, 10", {"07", "00"}, {"237", "233", "250"}},
        Way{"5, 6, 7", {"07", "06", "00"}, {"237", "233", "231", "250"}},
        Way{"8, 7", {"06", "00"}, {"237", "231", "250"}}, Way{"9", {"00"}, {"237", "250"}}}) {
    const FamilyMode pv{kPrintedSv660c, "100000", "pv"};
    TracedScene scene(busJoint(pv, ", disable_by: [" + std::string(way.transitions) + "]"));
    ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
    ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
    scene.run(300ms);
    scene.clear();
    ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success) << scene.told();
    scene.run(50ms);
    std::vector<std::string> words, statuswords;
    const auto add = [](std::vector<std::string>& list, const std::string& item) {
      if (list.empty() || list.back() != item) list.push_back(item);
    };
    for (const std::string& line : scene.beginning("201 ")) add(words, line.substr(4, 2));
    for (const std::string& line : scene.beginning("181 ")) {
      char text[8];
      const unsigned word = std::stoul(line.substr(7, 2) + line.substr(4, 2), nullptr, 16) & 0x3FF;
      std::snprintf(text, sizeof text, "%03X", word);
      add(statuswords, text);
    }
    if (words.front() == "0F") words.erase(words.begin());
    EXPECT_EQ(words, way.words) << way.transitions;
    EXPECT_EQ(statuswords, way.statuswords) << way.transitions;
  }
}

// 60B8h = 0013h: probe 1, its input, rising edges, each of them [1880-1895]. Its input is told by
// H03.14 there, of DI7, which chapter 3 does not have: DI8, H03.16, stands for it.
TEST(Sv660cPrintedProbe, IsArmedAndTellsTheEdge) {
  sim::AxisMechanics mechanics;
  mechanics.initial_position = 0.25;
  PrintedDrive drive(kPrintedSv660c, mechanics);
  drive.take({"2B 03 20 11 26 00 00 00", "2B 03 20 12 00 00 00 00", "2B B8 60 00 13 00 00 00"});
  EXPECT_EQ(drive.read(0x60B9) & 0x3U, 0x1U);
  drive.drive->setProbe(1, true, drive.now);
  drive.run(ms(5));
  EXPECT_EQ(drive.read(0x60B9) & 0x3U, 0x3U) << "bit 1";
  EXPECT_EQ(drive.read(0x60BA), 2097152U) << "a quarter of 2^23";
  TracedScene scene(busJoint(kBusSv660c));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "di8_function", "38"}).success);
  scene.clear();
  bus::ArmTouchProbeCommand command;
  command.axis = "joint";
  command.probe = 1;
  command.edge = "rising";
  command.continuous = true;
  command.timeout = 5.0;
  (void)scene.ask(command);
  scene.run(200ms);
  EXPECT_TRUE(inOrder(scene.lines, {"601 2B B8 60 00 13 00 00 00", "581 60 B8 60 00 00 00 00 00"}));
}

// A unit is half a turn: 6091h = 4194304 / 1 [480-490].
TEST(Sv660cPrintedGear, MovesHalfATurnForAUnit) {
  PrintedDrive drive(kPrintedSv660c);
  drive.take({"23 91 60 01 00 00 40 00", "23 91 60 02 01 00 00 00", "2F 60 60 00 01 00 00 00",
              "23 7A 60 00 03 00 00 00", "23 81 60 00 02 00 00 00", "23 83 60 00 10 00 00 00",
              "23 84 60 00 10 00 00 00", "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00",
              "2B 40 60 00 0F 00 00 00"});
  drive.run(ms(300));
  drive.take({"2B 40 60 00 1F 00 00 00"});
  drive.run(ms(4000));
  EXPECT_NEAR(drive.turns(), 1.5, 1e-4);
  std::string yaml = busJoint(
      kBusSv660c,
      ", simulation: {with: {dictionary: [[0x6091, 2, gear_denominator, uint32, rw, -, 7]]}}");
  yaml = sv660cWith(yaml, "raw: 262144", "raw: 4194304");
  yaml = sv660cWith(yaml, "raw: 3125", "raw: 1");
  TracedScene scene(sv660cWith(yaml, "counts_per_turn: 100000", "counts_per_turn: 2"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"23 91 60 01 00 00 40 00", "23 91 60 02 01 00 00 00"}));
}

// --- DM5 -----------------------------------------------------------------------------------------

// 60600008h and 60400010h [1583-1587]
TEST(Dm5PrintedMapping, IsTakenAndWritten) {
  PrintedDrive drive(kPrintedDm5);
  drive.take({"23 00 14 01 01 02 00 80", "2F 00 16 00 00 00 00 00", "23 00 16 01 08 00 60 60",
              "23 00 16 02 10 00 40 60"});
  drive.take({"2F 00 16 00 02 00 00 00", "23 00 14 01 01 02 00 00"});
  drive.nmt(0x01);
  drive.drive->receive(printedFrame(0x201, "08 06 00"), drive.now);
  drive.run(ms(20));
  EXPECT_EQ(drive.ask("40 60 60 00 00 00 00 00"), "4F 60 60 00 08 00 00 00");
  EXPECT_EQ(drive.state(), 0x21) << "ready to switch on";
  TracedScene scene(busJoint(kBusDm5,
                             ", pdos: {rpdo1: [mode_of_operation, controlword, "
                             "target_position], tpdo1: [statusword, mode_display], "
                             "tpdo2: [position_actual]}"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"23 00 16 01 08 00 60 60", "23 00 16 02 10 00 40 60"}));
}

// The third is of 60C1h, which is in no table of the manual: with an object of that number the
// drive takes it, as 32 bits [1589].
TEST(Dm5PrintedMapping, OfInterpolationIsTakenWhereThatObjectIs) {
  PrintedDrive drive(kPrintedDm5,
                     "dictionary: [[0x60C1, 1, interpolation_target, int32, rw, r, 0]]");
  drive.take({"23 00 14 01 01 02 00 80", "2F 00 16 00 00 00 00 00", "23 00 16 01 20 01 C1 60",
              "2F 00 16 00 01 00 00 00", "23 00 14 01 01 02 00 00"});
  drive.nmt(0x01);
  drive.drive->receive(printedFrame(0x201, "78 56 34 12"), drive.now);
  drive.run(ms(20));
  EXPECT_EQ(drive.ask("40 C1 60 01 00 00 00 00"), "43 C1 60 01 78 56 34 12");
}

// 10 mm of the load are a turn of the motor: 6091h = 8388608 / 10 [1789-1819].
TEST(Dm5PrintedGear, MovesATurnForTenUnits) {
  PrintedDrive drive(kPrintedDm5);
  drive.take({"23 91 60 01 00 00 80 00", "23 91 60 02 0A 00 00 00", "2F 60 60 00 01 00 00 00",
              "23 7A 60 00 0A 00 00 00", "23 81 60 00 05 00 00 00", "23 83 60 00 64 00 00 00",
              "23 84 60 00 64 00 00 00", "2B 40 60 00 06 00 00 00", "2B 40 60 00 07 00 00 00",
              "2B 40 60 00 0F 00 00 00"});
  drive.run(ms(500));
  drive.take({"2B 40 60 00 1F 00 00 00"});
  drive.run(ms(4000));
  EXPECT_NEAR(drive.turns(), 1.0, 1e-4);
  const FamilyMode tenths{kPrintedDm5, "10", "csp"};
  TracedScene scene(busJoint(tenths,
                             ", write: [{object: gear_numerator, raw: 8388608}, {object: "
                             "gear_denominator, raw: 10}]"));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  EXPECT_TRUE(inOrder(scene.writes(), {"23 91 60 01 00 00 80 00", "23 91 60 02 0A 00 00 00"}));
}

// --- Damiao --------------------------------------------------------------------------------------

/// "43 04 20 01 CD CC 4C 3F": an answer, or a request where it begins with 40 and ends in zeros.
std::string objectBytes(std::uint8_t command, fieldbus::ObjectId id, std::uint32_t bits) {
  const auto byte = [](std::uint32_t number) { return static_cast<std::uint8_t>(number & 0xFF); };
  return wireText(
             can::Frame(0, {command, byte(id.index), byte(id.index >> 8U), id.subindex, byte(bits),
                            byte(bits >> 8U), byte(bits >> 16U), byte(bits >> 24U)}))
      .substr(4);
}

// What chapter 4 prints as the integer of a float [1055-1130, 1182-1326].
TEST(DamiaoPrintedFloats, AreWhatTheDriveHolds) {
  struct Row {
    std::uint16_t index;
    std::uint8_t sub;
    std::uint32_t bits;
  };
  PrintedDrive drive(kPrintedDamiao);
  for (const Row& row :
       {Row{0x2002, 1, 0x41C00000},  Row{0x2002, 2, 0x40E00000},  Row{0x2002, 3, 0x40400000},
        Row{0x2002, 4, 0x42F00000},  Row{0x2002, 8, 0x3F59999A},  Row{0x2002, 9, 0x39B4E11E},
        Row{0x2002, 11, 0x38C308FF}, Row{0x2002, 12, 0x3796FEB5}, Row{0x2004, 1, 0x3F4CCCCD},
        Row{0x2004, 2, 0x3A83126F},  Row{0x2004, 3, 0x447A0000},  Row{0x2005, 1, 0x3ECCCCCD},
        Row{0x2005, 2, 0x3B03126F},  Row{0x2005, 3, 0x40800000},  Row{0x2006, 1, 0x42580000},
        Row{0x2006, 2, 0x00000000},  Row{0x2008, 1, 0x3F4CCCCD},  Row{0x2009, 1, 0x42000000},
        Row{0x2009, 2, 0x41700000},  Row{0x200A, 3, 0x42C80000},  Row{0x200A, 4, 0x42C80000},
        Row{0x6065, 0, 0x3F000000},  Row{0x6067, 0, 0x3DCCCCCD},  Row{0x6068, 0, 0x3E4CCCCD},
        Row{0x606D, 0, 0x3F000000},  Row{0x606E, 0, 0x3DCCCCCD},  Row{0x606F, 0, 0x3C23D70A},
        Row{0x6071, 0, 0x00000000},  Row{0x6072, 0, 0x40E00000},  Row{0x607A, 0, 0x00000000},
        Row{0x6080, 0, 0x44160000},  Row{0x6083, 0, 0x44FA0000},  Row{0x6084, 0, 0x44FA0000},
        Row{0x6085, 0, 0x461C4000},  Row{0x6087, 0, 0x3F800000},  Row{0x60C5, 0, 0x457A0000},
        Row{0x60C6, 0, 0x457A0000},  Row{0x60FF, 0, 0x00000000}}) {
    const fieldbus::ObjectId id{row.index, row.sub};
    EXPECT_EQ(drive.ask(objectBytes(0x40, id, 0)), objectBytes(0x43, id, row.bits));
  }
}

// The five words of chapter 3 in 16 bits, where a firmware has those objects so wide [257-326].
TEST(DamiaoPrintedFloats, OfSixteenBitsAreWhatANarrowDriveHolds) {
  PrintedDrive drive("damiao_dm_half");
  EXPECT_EQ(drive.ask("40 6D 60 00 00 00 00 00"), "4B 6D 60 00 00 3F 00 00");
  EXPECT_EQ(drive.ask("40 6E 60 00 00 00 00 00"), "4B 6E 60 00 CC 3D 00 00");
  EXPECT_EQ(drive.ask("40 68 60 00 00 00 00 00"), "4B 68 60 00 4C 3E 00 00");
  EXPECT_EQ(drive.ask("40 6F 60 00 00 00 00 00"), "4B 6F 60 00 23 3C 00 00");
  drive.take({"2B 71 60 00 99 3E 00 00"});  // the target torque of the example [36]
  EXPECT_EQ(drive.ask("40 71 60 00 00 00 00 00"), "4B 71 60 00 99 3E 00 00");
}

// Chapter 3 prints other ones for the same objects [263-273]: the drive takes them.
TEST(DamiaoPrintedFloats, OfTheModesAreTaken) {
  PrintedDrive drive(kPrintedDamiao);
  drive.take({"23 83 60 00 00 00 A0 41", "23 84 60 00 00 00 A0 41", "23 05 20 01 0A D7 23 3D",
              "23 05 20 02 0A D7 23 3D"});
  EXPECT_EQ(drive.ask("40 83 60 00 00 00 00 00"), "43 83 60 00 00 00 A0 41");
  EXPECT_EQ(drive.readFloat(0x6084), 20.0F);
  EXPECT_EQ(drive.ask("40 05 20 01 00 00 00 00"), "43 05 20 01 0A D7 23 3D");
  EXPECT_EQ(drive.ask("40 05 20 02 00 00 00 00"), "43 05 20 02 0A D7 23 3D");
}

}  // namespace
}  // namespace cia402
