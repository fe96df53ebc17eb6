// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/frame_decoder.h"

#include <gtest/gtest.h>

#include "decode/decode_fixture.h"

namespace cia402::decode {
namespace {

using can::Frame;

class Decoder : public testing::Test {
 protected:
  /// "service|node|text"
  std::string line(const Frame& frame) {
    const DecodedFrame decoded = decoder.decode(frame);
    return decoded.service + "|" + decoded.node + "|" + decoded.text;
  }
  config::RobotConfig robot = test::robot();
  FrameDecoder decoder{robot, test::master(robot)};
};

TEST_F(Decoder, NmtCommandsNameWhomTheyAreFor) {
  EXPECT_EQ(line({0x000, {0x82, 0x00}}), "NMT|all|reset communication");
  EXPECT_EQ(line({0x000, {0x01, 0x01}}), "NMT|shoulder (1)|start");
  EXPECT_EQ(line({0x000, {0x02, 0x04}}), "NMT|gripper (4)|stop");
  EXPECT_EQ(line({0x000, {0x80, 0x09}}), "NMT|node 9|enter pre-operational");
  EXPECT_EQ(line({0x000, {0x81, 0x09}}), "NMT|node 9|reset node");
  EXPECT_EQ(line({0x000, {0x33, 0x09}}), "NMT|node 9|unknown command 0x33");
  EXPECT_EQ(line({0x000, {0x01}}), "NMT||too short: 01");
}

TEST_F(Decoder, AJointThatIsCalledOtherwiseThanItsAxisIsNamedFirst) {
  robot.axes[0].joint = "hip";
  robot.axes[1].joint = robot.axes[1].name;
  FrameDecoder renamed(robot, test::master(robot));
  EXPECT_EQ(renamed.decode(Frame(0x000, {0x01, 0x01})).node, "hip (axis shoulder, 1)");
  EXPECT_EQ(renamed.decode(Frame(0x000, {0x01, 0x02})).node, "slide (2)");
}

TEST_F(Decoder, SyncTellsItsCounter) {
  EXPECT_EQ(line({0x080, {}}), "SYNC||");
  EXPECT_EQ(line({0x080, {0x05}}), "SYNC||counter 5");
}

TEST_F(Decoder, TimeIsADate) {
  // 15665 days after 1984-01-01 (CiA 301, 7.1.6.6), 52628123 ms after midnight.
  EXPECT_EQ(line({0x100, {0x9B, 0x0A, 0x23, 0x03, 0x31, 0x3D}}), "TIME||2026-11-21 14:37:08.123");
  EXPECT_EQ(line({0x100, {0x00, 0x00, 0x00, 0x00, 0x0F, 0x17}}), "TIME||2000-02-29 00:00:00.000");
  EXPECT_EQ(line({0x100, {0x00, 0x00, 0x00, 0x00, 0x00, 0x00}}), "TIME||1984-01-01 00:00:00.000");
  EXPECT_EQ(line({0x100, {0x01}}), "TIME||too short");
}

TEST_F(Decoder, ATpdoIsItsObjectsInJointUnitsAndWords) {
  EXPECT_EQ(line({0x181, {0x37, 0x12, 0xE0, 0x2E, 0x03, 0x00, 0x08}}),
            "TPDO1|shoulder (1)|statusword 0x1237 operation enabled; voltage enabled, remote, "
            "follows the command | position_actual 0.1 rad (208608) | mode_display 8 "
            "cyclic_position");
  EXPECT_EQ(line({0x281, {0x00, 0x00, 0x00, 0x00, 0x06, 0xFF, 0x11, 0x86}}),
            "TPDO2|shoulder (1)|velocity_actual 0 rad/s (0) | torque_actual -16 N m (-250) | "
            "error_code 0x8611 following error");
  EXPECT_EQ(line({0x381, {0x00, 0x00, 0x00, 0x00, 0x20, 0xD1, 0xFC, 0xFF}}),
            "TPDO3|shoulder (1)|digital_inputs 0 | following_error -0.1 rad (-208608)");
}

TEST_F(Decoder, AnRpdoIsACommandAndASetPoint) {
  EXPECT_EQ(line({0x201, {0x0F, 0x00, 0x20, 0xD1, 0xFC, 0xFF}}),
            "RPDO1|shoulder (1)|controlword 0x000F enable operation | target_position -0.1 rad "
            "(-208608)");
}

TEST_F(Decoder, APrismaticAxisIsInMetres) {
  // 1000 counts a turn of 0.01 m: 25000 counts are 0.25 m.
  EXPECT_EQ(line({0x202, {0x06, 0x00, 0xA8, 0x61, 0x00, 0x00}}),
            "RPDO1|slide (2)|controlword 0x0006 shutdown | target_position 0.25 m (25000)");
}

TEST_F(Decoder, ModeNamesTheBitsThatDependOnIt) {
  EXPECT_EQ(line({0x182, {0x27, 0x10, 0x00, 0x00, 0x00, 0x00, 0x01}}),
            "TPDO1|slide (2)|statusword 0x1027 operation enabled; set-point acknowledged | "
            "position_actual 0 m (0) | mode_display 1 profile_position");
  EXPECT_EQ(line({0x202, {0x3F, 0x00, 0x00, 0x00, 0x00, 0x00}}),
            "RPDO1|slide (2)|controlword 0x003F enable operation; new set-point, change at once | "
            "target_position 0 m (0)");
  EXPECT_EQ(line({0x182, {0x27, 0x10, 0x00, 0x00, 0x00, 0x00, 0x06}}),
            "TPDO1|slide (2)|statusword 0x1027 operation enabled; homing attained | "
            "position_actual 0 m (0) | mode_display 6 homing");
  EXPECT_EQ(line({0x202, {0x1F, 0x00, 0x00, 0x00, 0x00, 0x00}}),
            "RPDO1|slide (2)|controlword 0x001F enable operation; start homing | target_position "
            "0 m (0)");
}

TEST_F(Decoder, APdoWhoseIdentifierOnlyTheDriveKnowsHidesNoNmt) {
  canopen::MasterConfig master = test::master(robot);
  for (canopen::PdoConfig& pdo : master.nodes[0].pdos) pdo.cob_id = 0;
  FrameDecoder other(robot, master);
  EXPECT_EQ(other.decode({0x000, {0x82, 0x00}}).service, "NMT");
  EXPECT_EQ(other.decode({0x181, {0x82, 0x00}}).service, "?");
}

TEST_F(Decoder, AShortPdoTellsWhatThereIs) {
  EXPECT_EQ(line({0x181, {0x18, 0x02}}),
            "TPDO1|shoulder (1)|too short, 2 of 7 bytes | statusword 0x0218 fault; voltage "
            "enabled, remote");
  EXPECT_EQ(line({0x181, {0x18}}), "TPDO1|shoulder (1)|too short, 1 of 7 bytes");
  EXPECT_EQ(line(test::remote(0x181, 7)), "TPDO1|shoulder (1)|asked for");
}

TEST_F(Decoder, EmergenciesAreInTheWordsOfProfileAndStandard) {
  EXPECT_EQ(line({0x081, {0x10, 0x23, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00}}),
            "EMCY|shoulder (1)|0x2310 continuous over current; error register 0x03 generic, "
            "current");
  EXPECT_EQ(line({0x081, {0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00}}),
            "EMCY|shoulder (1)|0x0000 error reset or no error; error register 0x00 none");
  EXPECT_EQ(line({0x089, {0x40, 0x82, 0x11, 0x01, 0x00, 0x00, 0x00, 0xAB}}),
            "EMCY|node 9|0x8240 unexpected SYNC data length; error register 0x11 generic, "
            "communication; manufacturer 01 00 00 00 AB");
  EXPECT_EQ(line({0x081, {0x10}}), "EMCY|shoulder (1)|too short for an emergency: 10");
}

TEST_F(Decoder, HeartbeatAndBootUp) {
  EXPECT_EQ(line({0x701, {0x00}}), "heartbeat|shoulder (1)|boot-up");
  EXPECT_EQ(line({0x701, {0x05}}), "heartbeat|shoulder (1)|operational");
  EXPECT_EQ(line({0x701, {0x7F}}), "heartbeat|shoulder (1)|pre-operational");
  EXPECT_EQ(line({0x701, {0x04}}), "heartbeat|shoulder (1)|stopped");
  EXPECT_EQ(line({0x701, {0x11}}), "heartbeat|shoulder (1)|unknown state 0x11");
  EXPECT_EQ(line({0x701, {}}), "heartbeat|shoulder (1)|empty");
  EXPECT_EQ(line({0x77F, {0x05}}), "heartbeat|master|operational");
}

TEST_F(Decoder, AGuardedNodeAnswersWithItsToggleBit) {
  EXPECT_EQ(line(test::remote(0x702, 1)), "guarding|slide (2)|asked for its state");
  EXPECT_EQ(line({0x702, {0x05}}), "guarding|slide (2)|operational, toggle 0");
  EXPECT_EQ(line({0x702, {0x85}}), "guarding|slide (2)|operational, toggle 1");
  EXPECT_EQ(line({0x702, {0x00}}), "heartbeat|slide (2)|boot-up");
}

TEST_F(Decoder, LssInTheWordsOfTheStandard) {
  EXPECT_EQ(line({0x7E5, {0x04, 0x01, 0, 0, 0, 0, 0, 0}}),
            "LSS|master|switch state global to configuration");
  EXPECT_EQ(line({0x7E5, {0x04, 0x00, 0, 0, 0, 0, 0, 0}}),
            "LSS|master|switch state global to waiting");
  EXPECT_EQ(line({0x7E5, {0x40, 0xD2, 0x04, 0x00, 0x00, 0, 0, 0}}),
            "LSS|master|switch state selective, vendor id 0x000004D2");
  EXPECT_EQ(line({0x7E5, {0x11, 0x05, 0, 0, 0, 0, 0, 0}}), "LSS|master|configure node-ID 5");
  EXPECT_EQ(line({0x7E4, {0x11, 0x00, 0, 0, 0, 0, 0, 0}}), "LSS|slave|configure node-ID: done");
  EXPECT_EQ(line({0x7E4, {0x11, 0xFF, 7, 0, 0, 0, 0, 0}}),
            "LSS|slave|configure node-ID: error 255, specific 7");
  EXPECT_EQ(line({0x7E5, {0x13, 0x00, 2, 0, 0, 0, 0, 0}}),
            "LSS|master|configure bit timing 500 kbit/s");
  EXPECT_EQ(line({0x7E5, {0x15, 0xF4, 0x01, 0, 0, 0, 0, 0}}),
            "LSS|master|activate bit timing in 500 ms");
  EXPECT_EQ(line({0x7E4, {0x5E, 0xFF, 0, 0, 0, 0, 0, 0}}),
            "LSS|slave|inquire node-ID 255 (not configured)");
  EXPECT_EQ(line({0x7E4, {0x5D, 0x78, 0x56, 0x34, 0x12, 0, 0, 0}}),
            "LSS|slave|inquire serial number 0x12345678");
  EXPECT_EQ(line({0x7E5, {0x51, 0, 0, 0, 0, 0x80, 0, 0}}),
            "LSS|master|fastscan: is there a non-configured device?");
  EXPECT_EQ(line({0x7E5, {0x51, 0x00, 0x04, 0, 0, 0x1F, 1, 1}}),
            "LSS|master|fastscan: product code 0x00000400 from bit 31 up, next product code");
  EXPECT_EQ(line({0x7E5, {0x99}}), "LSS|master|unknown command 0x99");
  EXPECT_EQ(line({0x7E4, {}}), "LSS|slave|empty");
}

TEST_F(Decoder, SdoOfEachNodeHasItsOwnMemory) {
  EXPECT_EQ(line({0x601, {0x40, 0x08, 0x10, 0x00, 0, 0, 0, 0}}),
            "SDO|shoulder (1)|read 1008:00 device name");
  EXPECT_EQ(line({0x602, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}}),
            "SDO|slide (2)|read 6041:00 statusword");
  EXPECT_EQ(line({0x581, {0x41, 0x08, 0x10, 0x00, 4, 0, 0, 0}}),
            "SDO|shoulder (1)|read 1008:00 device name, 4 bytes in segments");
  EXPECT_EQ(line({0x582, {0x4B, 0x41, 0x60, 0x00, 0x40, 0x02, 0, 0}}),
            "SDO|slide (2)|read 6041:00 statusword = 0x0240 switch on disabled; remote");
  EXPECT_EQ(line({0x581, {0x07, 'A', 'c', 'm', 'e', 0, 0, 0}}),
            "SDO|shoulder (1)|segment 1008:00 device name, toggle 0, 4 bytes, the last: 4 bytes in "
            "all: \"Acme\"");
  EXPECT_EQ(
      line({0x589, {0x80, 0x41, 0x60, 0x00, 0x00, 0x00, 0x02, 0x06}}),
      "SDO|node 9|abort 6041:00: 0x06020000 (object does not exist in the object dictionary)");
}

TEST_F(Decoder, AnSdoChannelOfOtherIdentifiersIsThatOfItsNode) {
  canopen::MasterConfig master = test::master(robot);
  master.nodes[1].sdo_channel = {0x650, 0x5D0};
  FrameDecoder other(robot, master);
  const DecodedFrame asked = other.decode({0x650, {0x40, 0x41, 0x60, 0x00, 0, 0, 0, 0}});
  EXPECT_EQ(asked.service + "|" + asked.node + "|" + asked.text,
            "SDO|slide (2)|read 6041:00 statusword");
  const DecodedFrame told = other.decode({0x5D0, {0x4B, 0x41, 0x60, 0x00, 0x40, 0x02, 0, 0}});
  EXPECT_EQ(told.text, "read 6041:00 statusword = 0x0240 switch on disabled; remote");
}

TEST_F(Decoder, ErrorFramesAndForeignOnesHaveWords) {
  Frame bus_off(0x040, {0, 0, 0, 0, 0, 0, 0, 0});
  bus_off.error = true;
  EXPECT_EQ(line(bus_off), "error||bus-off: the controller has left the bus");
  Frame extended(0x18FEF100, {0x01, 0x02});
  extended.extended = true;
  EXPECT_EQ(line(extended), "?||0x18FEF100: 01 02");
  EXPECT_EQ(line({0x3FF, {0xAA}}), "?||0x03FF: AA");
  EXPECT_EQ(line(test::remote(0x3FF, 3)), "?||0x03FF: remote request, 3 bytes");
}

TEST(DecodedLine, HasFixedColumnsThatAreNeverEmpty) {
  const std::chrono::nanoseconds stamp(1'700'000'000'123'456'789);
  EXPECT_EQ(formatDecoded(stamp, -0.5, "rx", {"TPDO1", "shoulder (1)", "text"}),
            "1700000000.123456   -0.500000  rx  TPDO1      shoulder (1)      text");
  EXPECT_EQ(formatDecoded(stamp, 0.0, "tx", {"SYNC", "", ""}),
            "1700000000.123456   +0.000000  tx  SYNC       -                 -");
}

/// Axis 1 of node 1 beside the shoulder, with a TPDO of its own and one that carries both.
struct TwoAxesDecoder : Decoder {
  TwoAxesDecoder() {
    drive::AxisConfig second = robot.axes[shoulder()];
    second.name = second.joint = "twin";
    second.device_axis = 1;
    second.profile =
        std::make_shared<const drive::DriveProfile>(drive::ofDeviceAxis(*second.profile, 1));
    robot.axes.push_back(second);
    master = test::master(robot);
    canopen::NodeConfig* node = nullptr;
    for (canopen::NodeConfig& each : master.nodes) {
      if (each.node_id == 1) node = &each;
    }
    canopen::PdoConfig own, both;
    own.direction = both.direction = canopen::PdoDirection::tpdo;
    own.number = 65;
    own.cob_id = 0x6A1;
    own.entries = {{{0x6841, 0}, 16, "statusword"}, {{0x6864, 0}, 32, "position_actual"}};
    both.number = 66;
    both.cob_id = 0x6A2;
    both.entries = {{{0x6041, 0}, 16, "statusword"}, {{0x6841, 0}, 16, "statusword"}};
    node->pdos.push_back(own);
    node->pdos.push_back(both);
  }
  std::size_t shoulder() const { return robot.axes[0].name == "shoulder" ? 0 : 1; }
  canopen::MasterConfig master;
};

TEST_F(TwoAxesDecoder, FramesAreThoseOfTheAxisWhoseObjectsTheyCarry) {
  FrameDecoder both(robot, master);
  const DecodedFrame own = both.decode(Frame(0x6A1, {0x37, 0x12, 0xE0, 0x2E, 0x03, 0x00}));
  EXPECT_EQ(own.node, "twin (1)");
  EXPECT_EQ(own.text,
            "statusword 0x1237 operation enabled; voltage enabled, remote, bit 12 | "
            "position_actual 0.1 rad (208608)");
  EXPECT_EQ(both.decode(Frame(0x181, {0x37, 0x12, 0xE0, 0x2E, 0x03, 0x00, 0x08})).node,
            "shoulder (1)");
  EXPECT_EQ(both.decode(Frame(0x6A2, {0x37, 0x12, 0x50, 0x02})).node, "shoulder, twin (1)");
  const DecodedFrame read = both.decode(Frame(0x601, {0x40, 0x64, 0x68, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(read.node, "shoulder, twin (1)");
  EXPECT_EQ(read.text, "read 6864:00 position_actual");
}

}  // namespace
}  // namespace cia402::decode
