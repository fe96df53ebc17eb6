// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// SDO with the families' drives: who they are, and what they refuse.
#include "system/families_bus_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using fieldbus::Health;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class FamilySdo : public testing::TestWithParam<FamilyMode> {
 protected:
  static bus::ObjectAnswer read(Scene& scene, const std::string& object) {
    return scene.call(bus::ReadObjectCommand{"joint", object});
  }
  static bus::Answer write(Scene& scene, const std::string& object, const std::string& value) {
    return scene.call(bus::WriteObjectCommand{"joint", object, value});
  }
};

INSTANTIATE_TEST_SUITE_P(All, FamilySdo, allFamilies(), nameOfFamily);

struct Printed {
  const char *object, *text;
};

std::vector<Printed> printedOf(const FamilyMode& tested) {
  if (is(tested, kBusNimotion)) {
    return {{"1000:00 u32", "0x00040192"},
            {"1018:01 u32", "45"},
            {"1018:02 u32", "1"},
            {"1018:03 u32", "1"},
            {"1018:04 u32", "1"},
            {"1008:00 text", "CANopen Slave"},
            {"1009:00 text", "V1.00"},
            {"100A:00 text", "V1.0 r0"},
            {"2002:03", "1"},
            {"2002:05", "1"}};
  }
  if (is(tested, kBusDamiao)) {
    return {
        {"1000:00 u32", "0x00030000"}, {"1008:00 text", "DM"},        {"1009:00 text", "V0.0"},
        {"100A:00 text", "V0.0"},      {"1018:01 u32", "1"},          {"1018:02 u32", "1"},
        {"1018:03 u32", "1"},          {"1018:04 u32", "1"},          {"2000:01 text", "DM4310"},
        {"2000:02 text", "MA732"},     {"2000:04 text", "JointMotor"}};
  }
  if (is(tested, kBusSv660c)) {
    return {{"1000:00 u32", "0x00020192"},
            {"1018:01 u32", "953"},
            {"1018:02 u32", "0x000D0117"},
            {"1018:03 u32", "0x00020001"},
            {"1008:00 text", "SV670P"}};
  }
  if (is(tested, kBusId286)) {
    return {{"1008:00 text", "iD286-CNFA"},
            {"1009:00 text", "V1.00 (simulated)"},
            {"100A:00 text", "V1.00 (simulated)"}};
  }
  return {{"1000:00 u32", "0x00020192"},
          {"1008:00 text", "DM5-CA015B"},
          {"1009:00 text", "sim"},
          {"100A:00 text", "1.00"}};
}

// Texts of more than four bytes come in segments; 60h and 70h ask for them in turn.
TEST_P(FamilySdo, TellsWhoItIs) {
  TracedScene scene(busJoint(GetParam()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  for (const Printed& printed : printedOf(GetParam())) {
    scene.clear();
    const bus::ObjectAnswer answer = read(scene, printed.object);
    EXPECT_TRUE(answer.success) << answer.message;
    EXPECT_THAT(answer.message, HasSubstr(printed.text));
    const bool text = std::string(printed.object).find("text") != std::string::npos;
    const std::size_t length = std::string(printed.text).size();
    if (text && length > 4) {
      EXPECT_EQ(scene.count("601 60 00 00 00"), (length + 13) / 14);
    }
    if (text && length > 7) {
      EXPECT_EQ(scene.count("601 70 00 00 00"), length / 14 + (length % 14 > 7 ? 1U : 0U));
    }
  }
}

// By its number, little-endian, eight bytes; its name in the answer.
TEST_P(FamilySdo, TakesNumbersOfOneTwoAndFourBytes) {
  struct Row {
    FamilyMode family;
    const char *one, *one_frame, *two, *two_frame, *four, *four_frame;
  };
  const Row rows[] = {{kBusNimotion, "60A3:00 u8=2", "2F A3 60 00 02 00 00 00", "6066:00=300",
                       "2B 66 60 00 2C 01 00 00", "6065:00=66051", "23 65 60 00 03 02 01 00"},
                      {kBusId286, "6098:00=17", "2F 98 60 00 11 00 00 00", "20D5:00=60",
                       "2B D5 20 00 3C 00 00 00", "6084:00=66051", "23 84 60 00 03 02 01 00"},
                      {kBusDm5, "6098:00=17", "2F 98 60 00 11 00 00 00", "6066:00=300",
                       "2B 66 60 00 2C 01 00 00", "6065:00=66051", "23 65 60 00 03 02 01 00"},
                      {kBusSv660c, "6098:00=17", "2F 98 60 00 11 00 00 00", "6066:00=300",
                       "2B 66 60 00 2C 01 00 00", "6067:00=66051", "23 67 60 00 03 02 01 00"},
                      {kBusDamiao, "1019:00 u8=0", "2F 19 10 00 00 00 00 00", "1015:00 u16=300",
                       "2B 15 10 00 2C 01 00 00", "6067:00=0x3DCCCCCD", "23 67 60 00 CD CC CC 3D"}};
  TracedScene scene(busJoint(GetParam()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  for (const Row& row : rows) {
    if (!is(GetParam(), row.family)) continue;
    const std::pair<const char*, const char*> writes[] = {
        {row.one, row.one_frame}, {row.two, row.two_frame}, {row.four, row.four_frame}};
    for (const auto& [text, frame] : writes) {
      const std::string all = text, bytes = frame;
      const std::string object = all.substr(0, all.find('=')),
                        value = all.substr(all.find('=') + 1);
      scene.clear();
      const bus::Answer written = write(scene, object, value);
      if (object.substr(0, 4) == "1019") continue;  // 1006h is not 0
      EXPECT_TRUE(written.success) << written.message;
      EXPECT_THAT(scene.lines, Contains("601 " + bytes));
      EXPECT_THAT(scene.lines, Contains("581 60 " + bytes.substr(3, 8) + " 00 00 00 00"));
      EXPECT_TRUE(read(scene, object).success);
      const std::string answer = bytes[1] == 'F' ? "4F" : bytes[1] == 'B' ? "4B" : "43";
      EXPECT_TRUE(inOrder(scene.lines, {"601 40 " + bytes.substr(3, 8) + " 00 00 00 00",
                                        "581 " + answer + bytes.substr(2)}));
    }
  }
}

TEST_P(FamilySdo, SaysInWordsWhatItRefuses) {
  Scene scene(loadText(busJoint(GetParam())));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  ASSERT_NO_FATAL_FAILURE(enableJoint(scene));
  EXPECT_THAT(read(scene, "5FFF:00 u32").message,
              AllOf(HasSubstr("joint (node 1): 5FFF:00"), HasSubstr("0x06020000"),
                    HasSubstr("object does not exist in the object dictionary")));
  EXPECT_THAT(read(scene, "1018:63 u32").message,
              AllOf(HasSubstr("1018:63"), HasSubstr("0x06090011 (sub-index does not exist)")));
  EXPECT_THAT(write(scene, "1000:00 u32", "1").message,
              AllOf(HasSubstr("1000:00"), HasSubstr("0x06010002 (attempt to write a read-only "
                                                    "object)")));
  EXPECT_THAT(
      write(scene, "1005:00 u8", "1").message,
      AllOf(HasSubstr("1005:00"), HasSubstr("0x060700"), HasSubstr("length of service parameter")));
  EXPECT_TRUE(scene.truth("joint").power_stage_on) << "that stops nothing";
  expectGoes(scene, 0.3);
}

// A lost answer is asked for again; a drive that is silent is told.
TEST_P(FamilySdo, IsAskedAgainWhereAnAnswerWasLost) {
  TracedScene scene(busJoint(GetParam()));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(2s);
  loseFrames(scene, 0x581, 1);
  const bus::ObjectAnswer answer = read(scene, "statusword");
  EXPECT_TRUE(answer.success) << answer.message;
  scene.inject("joint", "sdo_silent");
  const bus::ObjectAnswer none = read(scene, "statusword");
  EXPECT_FALSE(none.success);
  EXPECT_THAT(none.message, AllOf(HasSubstr("joint (node 1)"), HasSubstr("6041:00 statusword"),
                                  HasSubstr("no answer")));
}

// 1234h of 6064h is no answer to the question for 6041h, whose own answer was lost.
TEST_P(FamilySdo, IsNotTakenAtTheWordOfAnotherObject) {
  TracedScene scene(busJoint(GetParam()));
  Stranger stranger(scene.world());
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.run(2s);
  loseFrames(scene, 0x581, 1, "master");
  scene.watch([&] {
    if (scene.count("601 40 41 60 00") != 1 || scene.count("581 4B 64 60") != 0) return;
    stranger.send(can::Frame(0x581, {0x4B, 0x64, 0x60, 0x00, 0x34, 0x12, 0, 0}));
  });
  scene.clear();
  const bus::ObjectAnswer answer = read(scene, "statusword");
  EXPECT_TRUE(answer.success) << answer.message;
  EXPECT_EQ(scene.count("581 4B 64 60 00 34 12"), 1U);
  EXPECT_NE(answer.number, 0x1234);
  EXPECT_EQ(static_cast<unsigned>(answer.number) & 0x4FU, 0x40U) << "switch on disabled";
}

// All that its manual lists [162-194].
TEST(NimotionAborts, AreAllTranslated) {
  Scene scene(loadText(busJoint(kBusNimotion)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  std::uint32_t code = 0;
  scene.drive("joint").dictionary().onWriteCheck(
      {0x2008, 1}, [&](const sim::Entry&, std::uint64_t) { return code; });
  for (const auto& [abort, words] : std::initializer_list<std::pair<std::uint32_t, const char*>>{
           {0x05030000, "toggle bit"},       {0x05040000, "timed out"},
           {0x05040001, "command"},          {0x05040002, "block size"},
           {0x05040003, "sequence"},         {0x05040004, "CRC"},
           {0x05040005, "memory"},           {0x06010000, "unsupported access"},
           {0x06010001, "write-only"},       {0x06010002, "read-only"},
           {0x06020000, "does not exist"},   {0x06040041, "cannot be mapped"},
           {0x06040042, "PDO length"},       {0x06040043, "parameter incompatibility"},
           {0x06040047, "internal"},         {0x06060000, "hardware error"},
           {0x06070010, "does not match"},   {0x06070012, "too high"},
           {0x06070013, "too low"},          {0x06090011, "sub-index does not exist"},
           {0x06090030, "invalid value"},    {0x06090031, "too high"},
           {0x06090032, "too low"},          {0x06090036, "maximum value is less"},
           {0x08000000, "general error"},    {0x08000020, "transferred or stored"},
           {0x08000021, "local control"},    {0x08000022, "device state"},
           {0x08000023, "object dictionary"}}) {
    code = abort;
    const auto refused = scene.call(bus::WriteObjectCommand{"joint", "position_gain", "100"});
    EXPECT_FALSE(refused.success);
    EXPECT_THAT(refused.message, AllOf(HasSubstr("position_gain"), HasSubstr(words)));
  }
  code = 0;
  EXPECT_TRUE(scene.call(bus::WriteObjectCommand{"joint", "position_gain", "100"}).success);
}

// The only frames that its manual prints [L1037-1059]; node 2.
TEST(Id286Frames, AreThoseOfTheManual) {
  TracedScene scene(busRobot(busAxis(kBusId286, "joint", 2)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  scene.clear();
  const auto written = scene.call(bus::WriteObjectCommand{"joint", "1801:03 u16", "0x20F0"});
  EXPECT_TRUE(written.success) << written.message;
  const auto read = scene.call(bus::ReadObjectCommand{"joint", "1801:03 u16"});
  EXPECT_EQ(read.number, 8432.0) << read.message;
  EXPECT_TRUE(inOrder(scene.lines, {"602 2B 01 18 03 F0 20 00 00", "582 60 01 18 03 00 00 00 00",
                                    "602 40 01 18 03 00 00 00 00", "582 4B 01 18 03 F0 20 00 00"}));
}

TEST(Id286Storage, IsNeverWrittenAndNotNeeded) {
  TracedScene scene(busJoint(kBusId286));
  expectBootsAndGoes(scene);
  EXPECT_TRUE(scene.procedure(ProcedureKind::disable).success);
  for (const std::string& write : scene.writes()) {
    EXPECT_NE(write.substr(3, 5), "CE 20") << write;
    EXPECT_NE(write.substr(3, 5), "10 10") << write;
  }
}

struct WrongDevice {
  FamilyMode tested;
  std::string options;
  fieldbus::ObjectId object;
  const char* words;
};

class FamilyIdentity : public testing::TestWithParam<WrongDevice> {};

TEST_P(FamilyIdentity, OfAnotherDeviceIsRefusedInWords) {
  TracedScene scene(busJoint(GetParam().tested, GetParam().options));
  sim::Entry* entry = scene.drive("joint").dictionary().find(GetParam().object);
  ASSERT_NE(entry, nullptr);
  entry->number = entry->initial_number = 0x4711;
  scene.robot().start();
  scene.run(8s);
  EXPECT_EQ(scene.state("joint").health, Health::failed);
  EXPECT_THAT(scene.told(), AllOf(HasSubstr("joint (node 1): is another drive than configured: "),
                                  HasSubstr(GetParam().words)));
  EXPECT_NE(scene.truth("joint").nmt, canopen::NmtState::operational);
  EXPECT_TRUE(scene.writes().empty()) << "nothing is written to a stranger";
  EXPECT_FALSE(scene.procedure(ProcedureKind::enable).success);
}

INSTANTIATE_TEST_SUITE_P(
    That, FamilyIdentity,
    testing::Values(
        WrongDevice{kBusNimotion,
                    "",
                    {0x1000, 0},
                    "1000:00 device type is 0x00004711, configured is 0x00040192"},
        WrongDevice{kBusNimotion, "", {0x1018, 1}, "is 0x00004711, configured is 0x0000002D"},
        WrongDevice{kBusDamiao,
                    "",
                    {0x1000, 0},
                    "1000:00 device type is 0x00004711, configured is 0x00030000"},
        WrongDevice{kBusSv660c,
                    "",
                    {0x1000, 0},
                    "1000:00 device type is 0x00004711, configured is 0x00020192"},
        WrongDevice{kBusSv660c, "", {0x1018, 1}, "is 0x00004711, configured is 0x000003B9"},
        WrongDevice{kBusId286,
                    ", identity: {product_code: 0xCFA0}",
                    {0x1018, 2},
                    "is 0x00004711, configured is 0x0000CFA0"},
        WrongDevice{kBusDm5,
                    ", identity: {serial: 1}",
                    {0x1018, 4},
                    "is 0x00004711, configured is 0x00000001"}),
    [](const auto& tested) {
      return std::string(tested.param.tested.family) + "_" +
             (tested.param.object.index == 0x1000 ? "device_type" : "identity");
    });

TEST(Sv660cCounters, OfTheBusAreRead) {
  Scene scene(loadText(busJoint(kBusSv660c)));
  ASSERT_TRUE(scene.boot(kFamilyBoot)) << scene.told();
  constexpr std::uint8_t kCounters[] = {0x12, 0x13, 0x14, 0x0F};
  for (const std::uint8_t sub : kCounters) {
    scene.drive("joint").dictionary().find({0x200E, sub})->number = sub;
    char object[8];
    std::snprintf(object, sizeof(object), "200E:%02X", static_cast<unsigned>(sub));
    const auto read = scene.call(bus::ReadObjectCommand{"joint", std::string(object) + " u16"});
    EXPECT_TRUE(read.success) << read.message;
    EXPECT_EQ(read.data, (fieldbus::Bytes{sub, 0}));
  }
}

}  // namespace
}  // namespace cia402
