// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// A drive that was left enabled: it is stopped before anything else, and what it refuses until it
// has stopped is repeated.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "canopen/node_fixture.h"

namespace cia402::canopen {
namespace {

using namespace std::chrono_literals;
using test::Lines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char kStop[] = "603 2B 40 60 00 02 00 00 00";  // controlword 0x0002

class BootStop : public test::NodeFixture {
 protected:
  BootStop() {
    StartupWrite stop;
    stop.object = {0x6040, 0};
    stop.name = "controlword";
    stop.data = {0x02, 0x00};
    stop.optional = true;
    stop.only_if_different = false;
    stop.always = true;
    config.writes = {stop};
    peer.on(kStop, "583 60 40 60 00 00 00 00 00");
  }
  /// Writes by SDO so far.
  Lines writes() {
    Lines lines;
    for (const std::string& line : peer.take()) {
      if (line.substr(0, 5) == "603 2") lines.push_back(line);
    }
    return lines;
  }
  /// The drive refuses `write` by 0x08000022 for as long as it is enabled.
  void refuse(int times, const std::string& write, const std::string& object) {
    const std::string refusal = "583 80 " + object + " 22 00 00 08";
    peer.forget(write);
    for (int i = 0; i < times; ++i) peer.on(write, {refusal});
    peer.on(write, {"583 60 " + object + " 00 00 00 00"});
  }
  void refuseThrice(const std::string& write, const std::string& object) {
    refuse(3, write, object);
  }
  /// @return how long the boot took.
  Duration bootPatiently() {
    boot();
    EXPECT_EQ(node->health(), Health::booting);
    const Time begin = now;
    while (node->health() == Health::booting && now < begin + 10s) pass(10ms);
    EXPECT_EQ(node->health(), Health::ready) << node->problem();
    return now - begin;
  }
};

TEST_F(BootStop, comes_right_after_the_identification_frame_by_frame) {
  StartupWrite window;
  window.object = {0x6065, 0};
  window.data = {0x88, 0x13, 0x00, 0x00};
  window.only_if_different = false;
  config.writes.insert(config.writes.begin(), window);
  peer.on("603 23 65 60 00 88 13 00 00", "583 60 65 60 00 00 00 00 00");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  const Lines sent = peer.take();
  EXPECT_EQ(Lines(sent.begin(), sent.begin() + 9),
            (Lines{"000 82 03",                    // reset communication, then boot-up
                   "603 40 00 10 00 00 00 00 00",  // device type
                   "603 40 18 10 01 00 00 00 00",  // identity
                   "603 40 18 10 02 00 00 00 00",  //
                   "603 40 18 10 03 00 00 00 00",  //
                   "603 40 18 10 04 00 00 00 00",  //
                   kStop,                          // before anything else is written
                   "603 23 16 10 01 2C 01 7F 00",  // watch node 127, 300 ms
                   "603 2B 17 10 00 64 00 00 00"}));
  EXPECT_EQ(Lines(sent.end() - 2, sent.end()), (Lines{"603 23 65 60 00 88 13 00 00", "000 01 03"}))
      << "the others come last";
  EXPECT_EQ(std::count(sent.begin(), sent.end(), kStop), 1);
}

TEST_F(BootStop, is_not_sent_to_a_strange_drive) {
  config.serial = 4711;
  boot();
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(writes(), IsEmpty());
}

TEST_F(BootStop, a_refusal_is_told_and_the_boot_goes_on) {
  peer.replace(kStop, "583 80 40 60 00 22 00 00 08");
  boot();
  EXPECT_EQ(node->health(), Health::ready) << node->problem();
  EXPECT_THAT(node->notes(), ElementsAre(HasSubstr("was not told to stop before it was configured: "
                                                   "writing 0x0002 to 6040:00 controlword")));
}

TEST_F(BootStop, a_map_that_is_refused_until_the_drive_has_stopped_is_written_again) {
  // TPDO 1 has one entry, as another master left it.
  peer.replace("603 40 00 1A 00 00 00 00 00", "583 4F 00 1A 00 01 00 00 00");
  refuseThrice("603 23 00 18 01 83 01 00 80", "00 18 01");
  // From then on it shows what was written.
  for (const char* line : {"603 2F 00 1A 00 00 00 00 00", "603 2F 00 1A 00 02 00 00 00"}) {
    peer.on(line, "583 60 00 1A 00 00 00 00 00");
  }
  peer.on("603 23 00 1A 01 10 00 41 60", "583 60 00 1A 01 00 00 00 00");
  peer.on("603 23 00 1A 02 20 00 64 60", "583 60 00 1A 02 00 00 00 00");
  peer.on("603 23 00 18 01 83 01 00 00", "583 60 00 18 01 00 00 00 00");
  for (int i = 0; i < 3; ++i) {
    peer.on("603 40 00 1A 00 00 00 00 00", "583 4F 00 1A 00 01 00 00 00");
  }
  peer.on("603 40 00 1A 00 00 00 00 00", "583 4F 00 1A 00 02 00 00 00");
  EXPECT_EQ(bootPatiently(), 150ms) << "50 ms after each refusal";
  const Lines written = writes();
  EXPECT_EQ(written.front(), kStop);
  EXPECT_EQ(std::count(written.begin(), written.end(), "603 23 00 18 01 83 01 00 80"), 4);
  EXPECT_THAT(node->notes(), IsEmpty());
}

TEST_F(BootStop, a_map_that_stays_refused_fails_the_boot_after_three_seconds) {
  peer.replace("603 40 00 1A 00 00 00 00 00", "583 4F 00 1A 00 01 00 00 00");
  peer.on("603 23 00 18 01 83 01 00 80", "583 80 00 18 01 22 00 00 08");
  boot();
  pass(2900ms);
  EXPECT_EQ(node->health(), Health::booting);
  pass(300ms);
  EXPECT_EQ(node->health(), Health::failed);
  EXPECT_THAT(node->problem(),
              HasSubstr("1800:01 COB-ID of TPDO 1: the drive refused: 0x08000022"));
}

TEST_F(BootStop, pdos_of_nobody_that_stay_refused_share_the_three_seconds) {
  for (const char* pdo : {"01 14", "02 14", "01 18", "02 18"}) {
    const std::string object = std::string(pdo) + " 01";
    peer.replace("603 40 " + object + " 00 00 00 00", {"583 43 " + object + " 33 03 00 00"});
    peer.on("603 23 " + object + " 33 03 00 80", {"583 80 " + object + " 22 00 00 08"});
  }
  const Duration took = bootPatiently();
  EXPECT_LT(took, 3200ms);
  EXPECT_EQ(node->notes().size(), 4U);
}

TEST_F(BootStop, a_cob_id_of_sync_that_is_refused_until_the_drive_has_stopped_is_written_again) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 80 00 00 40");  // it makes SYNC
  refuseThrice("603 23 05 10 00 80 00 00 00", "05 10 00");
  EXPECT_EQ(bootPatiently(), 150ms);
}

TEST_F(BootStop, a_sync_period_that_is_refused_until_the_drive_has_stopped_is_written_again) {
  config.sync_period_us = 4000;
  peer.on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 10 27 00 00");
  refuseThrice("603 23 06 10 00 A0 0F 00 00", "06 10 00");
  EXPECT_EQ(bootPatiently(), 150ms);
}

TEST_F(BootStop, a_heartbeat_time_that_is_refused_until_the_drive_has_stopped_is_written_again) {
  peer.forget("603 2B 17 10 00 64 00 00 00");
  refuseThrice("603 2B 17 10 00 64 00 00 00", "17 10 00");
  EXPECT_EQ(bootPatiently(), 150ms);
  EXPECT_TRUE(node->supervision().watched);
}

// 40 refusals, 50 ms apart, are 2 s of the three that each object has.
TEST_F(BootStop, each_object_that_is_refused_has_its_own_three_seconds) {
  peer.replace("603 40 05 10 00 00 00 00 00", "583 43 05 10 00 80 00 00 40");
  peer.replace("603 40 14 10 00 00 00 00 00", "583 43 14 10 00 83 00 00 80");
  refuse(40, "603 23 05 10 00 80 00 00 00", "05 10 00");
  refuse(40, "603 23 14 10 00 83 00 00 00", "14 10 00");
  EXPECT_EQ(bootPatiently(), 4s);
  EXPECT_THAT(node->notes(), IsEmpty()) << "its emergencies are heard";
}

TEST_F(BootStop, each_sync_object_that_is_refused_has_its_own_three_seconds) {
  config.sync_counter = 10;
  config.sync_period_us = 4000;
  peer.on("603 40 19 10 00 00 00 00 00", "583 4F 19 10 00 00 00 00 00");
  peer.on("603 40 06 10 00 00 00 00 00", "583 43 06 10 00 00 00 00 00");
  refuse(40, "603 2F 19 10 00 0A 00 00 00", "19 10 00");
  refuse(40, "603 23 06 10 00 A0 0F 00 00", "06 10 00");
  EXPECT_EQ(bootPatiently(), 4s);
}

TEST_F(BootStop, each_start_up_write_that_is_refused_has_its_own_three_seconds) {
  for (const std::uint16_t index : {std::uint16_t{0x6065}, std::uint16_t{0x6066}}) {
    StartupWrite write;
    write.object = {index, 0};
    write.data = {0x88, 0x13};
    write.only_if_different = false;
    config.writes.push_back(write);
  }
  refuse(40, "603 2B 65 60 00 88 13 00 00", "65 60 00");
  refuse(40, "603 2B 66 60 00 88 13 00 00", "66 60 00");
  EXPECT_EQ(bootPatiently(), 4s);
}

TEST_F(BootStop, each_pdo_that_is_made_invalid_has_its_own_three_seconds) {
  for (const char* pdo : {"01 18", "02 18"}) {
    const std::string object = std::string(pdo) + " 01";
    const std::string read = "603 40 " + object + " 00 00 00 00";
    peer.forget(read);
    for (int i = 0; i < 41; ++i) peer.on(read, {"583 43 " + object + " 33 03 00 00"});
    peer.on(read, {"583 43 " + object + " 33 03 00 80"});
    refuse(40, "603 23 " + object + " 33 03 00 80", object);
  }
  EXPECT_EQ(bootPatiently(), 4s);
  EXPECT_THAT(node->notes(), IsEmpty());
}

}  // namespace
}  // namespace cia402::canopen
