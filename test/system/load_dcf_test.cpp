// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// load_dcf: what a DCF (CiA 306) says is brought back into a drive.
#include "bus/canopen/dcf_draft.h"
#include "bus/canopen/dcf_load.h"
#include "system/sv660c_scene.h"

namespace cia402 {
namespace {

using namespace std::chrono_literals;
using drive::ProcedureKind;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// "[2008sub1]" with a value. @param type of CiA 301, table 44: 6 is UNSIGNED16
std::string dcfEntry(const std::string& section, const std::string& value,
                     const std::string& type = "0x0006", const std::string& access = "rw") {
  return "[" + section + "]\r\nParameterName=Number " + section + "\r\nObjectType=0x7\r\n" +
         "DataType=" + type + "\r\nAccessType=" + access + "\r\nParameterValue=" + value + "\r\n";
}

/// A DCF of an SV660C by hand: 1000h is 0x00020192 [L13243], maker 0x3B9, product 0xD0117.
std::string dcfOfSv660c(const std::string& entries, const std::string& type = "0x00020192",
                        const std::string& product = "0x000D0117") {
  return "[FileInfo]\r\nFileName=a.dcf\r\n[DeviceInfo]\r\nVendorNumber=0x3B9\r\n"
         "ProductNumber=" +
         product + "\r\n" + dcfEntry("1000", type, "0x0007", "ro") + entries;
}

std::string dcfRecord(const std::string& index, const std::string& entries) {
  return "[" + index + "]\r\nParameterName=Group\r\nObjectType=0x9\r\nSubNumber=1\r\n" + entries;
}

/// Booted and at rest, not enabled.
struct DcfScene : Scene {
  explicit DcfScene(const std::string& yaml = sv660cJoint()) : Scene(loadText(yaml)) {
    EXPECT_TRUE(boot()) << told();
    run(500ms);
    world().bus().setMonitor([this](const can::Frame& frame, Time) {
      if (frame.id != 0x601 || (frame.data[0] & 0xE0) != 0x20) return;
      const fieldbus::ObjectId id{static_cast<std::uint16_t>(frame.data[1] + 256U * frame.data[2]),
                                  frame.data[3]};
      writes.push_back(fieldbus::toString(id));
    });
  }
  const drive::AxisConfig& config() { return axis("joint").config(); }
  const canopen::DeviceProfile& device() { return *loaded().robot.deviceOf(config()).profile; }
  bus::Answer load(const std::string& text, bool confirm) {
    const auto loading = bus::planDcf(text, "a.dcf", config(), device());
    if (!loading) return bus::answerOf(false, loading.error().message);
    const bus::Answer answer = call(bus::LoadDcfCommand{"joint", *loading, confirm});
    return answer.success ? bus::dcfOutcome(**loading, config()) : answer;
  }
  std::string save() {
    const drive::AxisConfig& axis = config();
    bus::DcfDraft draft(axis, loaded().robot.deviceOf(axis), {"a.dcf", "11-21-2026", "03:40PM"});
    EXPECT_TRUE(call(draft.command()).success);
    return draft.finish().text;
  }
  std::uint64_t number(std::uint16_t index, std::uint8_t sub) {
    return sv660cNumber(*this, index, sub);
  }
  std::vector<std::string> writes;  ///< by SDO
};

TEST(Sv660cDcf, BringsBackWhatWasDumped) {
  DcfScene scene;
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "250").success);
  ASSERT_TRUE(sv660cWrite(scene, "position_gain", "510").success);
  const std::string dump = scene.save();
  ASSERT_TRUE(sv660cWrite(scene, "speed_gain", "300").success);
  ASSERT_TRUE(sv660cWrite(scene, "following_error_window", "1234").success);
  const std::uint64_t window = scene.number(0x6065, 0);
  scene.writes.clear();
  const bus::Answer asked = scene.load(dump, false);
  EXPECT_FALSE(asked.success);
  EXPECT_THAT(
      asked.message,
      AllOf(HasSubstr("2 differ: 2008:01 H08.00 speed_gain, 6065:00 "
                      "following_error_window; nothing was written"),
            HasSubstr("confirm: true"), HasSubstr("set_bus_parameters sets it"),
            HasSubstr("motor_code (calibration)"), HasSubstr("software_reset (a command)")));
  EXPECT_THAT(scene.writes, ElementsAre());
  EXPECT_EQ(scene.number(0x6065, 0), window);
  const bus::Answer loaded = scene.load(dump, true);
  EXPECT_TRUE(loaded.success) << loaded.message;
  EXPECT_THAT(loaded.message, AllOf(HasSubstr("2 were written and read back: 2008:01"),
                                    HasSubstr("save_parameters keeps what was written")));
  EXPECT_THAT(scene.writes, ElementsAre("2008:01", "6065:00"));
  EXPECT_EQ(scene.number(0x2008, 1), 250U);
  EXPECT_EQ(scene.number(0x2008, 3), 510U);
  EXPECT_NE(scene.number(0x6065, 0), 1234U);
  const bus::Answer again = scene.load(dump, false);
  EXPECT_TRUE(again.success) << again.message << ": nothing differs any more";
  EXPECT_TRUE(scene.procedure(ProcedureKind::save_parameters, "joint").success);
  scene.inject("joint", "power_cycle");
  scene.run(5s);
  EXPECT_EQ(scene.number(0x2008, 1), 250U);
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
}

TEST(Sv660cDcf, OfAnotherDriveIsRefused) {
  DcfScene scene;
  const std::string gain = dcfRecord("2008", dcfEntry("2008sub1", "250"));
  for (const bool confirm : {false, true}) {
    const bus::Answer type = scene.load(dcfOfSv660c(gain, "0x00040192"), confirm);
    EXPECT_FALSE(type.success);
    EXPECT_THAT(type.message,
                HasSubstr("joint (node 1): a.dcf not loaded: it is of another drive: 1000:00"));
    EXPECT_THAT(type.message, HasSubstr("is 0x00040192 in it, and 0x00020192 here"));
    const bus::Answer product = scene.load(dcfOfSv660c(gain, "0x00020192", "0xD0118"), confirm);
    EXPECT_FALSE(product.success);
    EXPECT_THAT(product.message, HasSubstr("1018:02 is 0x000D0118 in it, and 0x000D0117 here"));
  }
  EXPECT_THAT(scene.load(gain, true).message, HasSubstr("does not say for which drive it is"));
  EXPECT_THAT(scene.load("no file", true).message, HasSubstr("a.dcf not loaded: line 1"));
  EXPECT_THAT(scene.load(dcfOfSv660c(""), true).message, HasSubstr("it has no value"));
  EXPECT_THAT(scene.writes, ElementsAre());
}

TEST(Sv660cDcf, IsRefusedWhileTheAxisIsEnabledAndLocksItMeanwhile) {
  DcfScene scene;
  const std::string file = dcfOfSv660c(dcfRecord("2008", dcfEntry("2008sub1", "250")));
  ASSERT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
  scene.writes.clear();
  const bus::Answer refused = scene.load(file, true);
  EXPECT_FALSE(refused.success);
  EXPECT_THAT(refused.message, HasSubstr("a.dcf not loaded: the axis is not disabled"));
  EXPECT_THAT(scene.writes, ElementsAre());
  ASSERT_TRUE(scene.procedure(ProcedureKind::disable).success);
  scene.run(500ms);
  const auto loading = bus::planDcf(file, "a.dcf", scene.config(), scene.device());
  ASSERT_TRUE(loading);
  const auto answer = scene.ask(bus::LoadDcfCommand{"joint", *loading, true});
  const bus::Answer enabled = scene.procedure(ProcedureKind::enable);
  EXPECT_FALSE(enabled.success) << "the DCF comes first";
  EXPECT_THAT(enabled.message, HasSubstr("a.dcf"));
  scene.run(200ms);
  ASSERT_TRUE(*answer);
  EXPECT_TRUE((*answer)->success) << (*answer)->message;
  EXPECT_TRUE(scene.procedure(ProcedureKind::enable).success) << scene.told();
}

// H0E.10 comes last, whatever else is in the file: without it there is no CANopen [L9629].
TEST(Sv660cDcf, IsWrittenWithTheChoiceOfCanopenLast) {
  DcfScene scene(sv660cJoint({}, sv660cDelivered("[0x200E, 0x0B, can_application_layer, uint16, "
                                                 "rw, -, 1, 0, 2]")));
  const bus::Answer loaded = scene.load(dcfOfSv660c(dcfRecord("2003", dcfEntry("2003sub1", "3")) +
                                                    dcfRecord("200E", dcfEntry("200EsubB", "2")) +
                                                    dcfRecord("2012", dcfEntry("2012sub16", "70"))),
                                        true);
  EXPECT_TRUE(loaded.success) << loaded.message;
  EXPECT_THAT(scene.writes, ElementsAre("2003:01", "2012:16", "200E:0B"));
  EXPECT_EQ(scene.number(0x2012, 0x16), 70U);
  EXPECT_EQ(scene.number(0x200E, 0x0B), 2U);
  EXPECT_THAT(loaded.message, HasSubstr("once the power was off count: 2003:01 H03.00"));
  const bus::Answer saved = scene.procedure(ProcedureKind::save_parameters, "joint");
  EXPECT_THAT(saved.message, HasSubstr("saved 2003:01 H03.00, 200E:0B H0E.10 can_application, "
                                       "2012:16 H12.21 in"));
}

TEST(Sv660cDcf, LeavesOutWhatCommandsAndWhatCannotBeWritten) {
  DcfScene scene;
  scene.forget();
  const bus::Answer loaded =
      scene.load(dcfOfSv660c(dcfRecord("2008", dcfEntry("2008sub1", "250")) +
                             dcfRecord("2002", dcfEntry("2002sub20", "1")) +  // factory reset
                             dcfRecord("200D", dcfEntry("200Dsub1", "1")) +   // software reset
                             dcfRecord("200C", dcfEntry("200Csub1", "5")) +   // node-ID
                             dcfRecord("200B", dcfEntry("200Bsub1", "7", "0x0003", "ro")) +
                             dcfEntry("1017", "77") + dcfEntry("6040", "15") +
                             dcfEntry("607A", "100000", "0x0004")),
                 true);
  EXPECT_TRUE(loaded.success) << loaded.message;
  EXPECT_THAT(scene.writes, ElementsAre("2008:01"));
  EXPECT_THAT(loaded.message,
              AllOf(HasSubstr("initialise_parameters (a command)"),
                    HasSubstr("200D:01 H0D.00 software_reset (a command)"),
                    HasSubstr("200C:01 H0C.00 node_id (set_bus_parameters sets it)"),
                    HasSubstr("controlword (a command)"), HasSubstr("target_position (a command)"),
                    Not(HasSubstr("motor_speed"))));
  scene.run(300ms);
  EXPECT_EQ(scene.node("joint").bootUps(), 1U);
  expectNothingMoved(scene, "joint");
}

TEST(Sv660cDcf, TellsWhatTheDriveRefusesAndWhatItDoesNotShow) {
  DcfScene scene;
  const bus::Answer loaded =
      scene.load(dcfOfSv660c(dcfRecord("2008", dcfEntry("2008sub1", "0")) +  // 1 to 20000 [L6442]
                             dcfRecord("2012", dcfEntry("2012sub16", "70")) +
                             dcfRecord("202F", dcfEntry("202Fsub1", "1"))),  // there is none
                 true);
  EXPECT_FALSE(loaded.success);
  EXPECT_THAT(loaded.message,
              AllOf(HasSubstr("1 were written and read back: 2012:16"),
                    HasSubstr("2 were not taken: 2008:01 H08.00 speed_gain (the drive refused: "
                              "0x06090032"),
                    HasSubstr("202F:01 H2F.00"), HasSubstr("0x06020000")));
  EXPECT_EQ(scene.number(0x2008, 1), 400U);
  scene.drive("joint").dictionary().onWrite({0x2012, 0x16}, [&](const sim::Entry& entry) {
    scene.drive("joint").dictionary().find(entry.id)->number = 12;
  });
  const bus::Answer other =
      scene.load(dcfOfSv660c(dcfRecord("2012", dcfEntry("2012sub16", "71"))), true);
  EXPECT_FALSE(other.success);
  EXPECT_THAT(other.message, HasSubstr("it took the write, but shows 0x000C"));
}

// The gear counts for where the joint is, so its zero is not believed any more.
TEST(Sv660cDcf, ThatChangesTheScaleCostsTheZero) {
  DcfScene scene;
  drive::ProcedureRequest here;
  here.kind = ProcedureKind::set_position;
  ASSERT_TRUE(scene.call(bus::ProcedureCommand{"joint", here}).success);
  ASSERT_TRUE(scene.state("joint").homed);
  scene.run(500ms);
  const bus::Answer loaded =
      scene.load(dcfOfSv660c(dcfRecord("6091", dcfEntry("6091sub1", "262145", "0x0007"))), true);
  EXPECT_TRUE(loaded.success) << loaded.message;
  EXPECT_THAT(loaded.message, HasSubstr("joint is not homed any more"));
  EXPECT_FALSE(scene.state("joint").homed);
  EXPECT_EQ(scene.number(0x6091, 1), 262145U);
  EXPECT_THAT(scene.procedure(ProcedureKind::enable).message, HasSubstr("6091:01"));
}

TEST(Sv660cDcf, IsGivenUpWhereTheDriveGoesAway) {
  DcfScene scene;
  scene.inject("joint", "sdo_silent");
  const std::string entries = dcfRecord("2008", dcfEntry("2008sub1", "250"));
  const bus::Answer answer = scene.load(dcfOfSv660c(entries), true);
  EXPECT_FALSE(answer.success);
  EXPECT_THAT(answer.message, HasSubstr("no answer"));
  scene.inject("joint", "clear");
  EXPECT_TRUE(scene.load(dcfOfSv660c(entries), true).success) << "it is locked no more";
}

}  // namespace
}  // namespace cia402
