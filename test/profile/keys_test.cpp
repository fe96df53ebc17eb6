// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Every key of a drive profile with a value of its own, found again where it belongs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drive/profile/fault_text.h"
#include "profile/full_profile.h"

namespace cia402::config {
namespace {

using canopen::CobIdSpec;
using drive::ControlKind;
using drive::DriveProfile;
using drive::Encoding;
using drive::ErrorText;
using drive::Handover;
using drive::HomingSpec;
using drive::ModeSpec;
using drive::ObjectSpec;
using drive::Quantity;
using drive::StopBy;
using drive::UnitSpec;
using fieldbus::DataType;
using fieldbus::ObjectId;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ProfileKeys : public testing::Test {
 protected:
  ProfileKeys() {
    const DriveFamily family =
        parseDriveFamily(std::string(kHead) + kModes + kRest, "full.yaml", problems);
    profile = family.drive;
    device = family.device;
    EXPECT_EQ(problems.text(), "");
  }
  Problems problems;
  DriveProfile profile;
  canopen::DeviceProfile device;
};

TEST_F(ProfileKeys, NamesTheDevice) {
  EXPECT_EQ(profile.name, "full");
  EXPECT_EQ(profile.description, "has it all");
  EXPECT_EQ(device.device_type, 0x00020192U);
  EXPECT_EQ(device.vendor_id, 0x1234U);
  EXPECT_EQ(device.product_code, 0x5678U);
}

TEST_F(ProfileKeys, ObjectsHaveTheirAccessAndMapping) {
  struct Row {
    const char* name;
    ObjectId id;
    DataType type;
    Quantity quantity;
    bool readable, writable, rpdo, tpdo;
  };
  const Row rows[] = {
      {"controlword", {0x6040, 0}, DataType::uint16, Quantity::none, true, true, true, false},
      {"statusword", {0x6041, 0}, DataType::uint16, Quantity::none, true, false, false, true},
      {"mode_display", {0x6061, 0}, DataType::int16, Quantity::none, true, false, false, true},
      {"target_position", {0x607A, 0}, DataType::int32, Quantity::position, true, true, true, true},
      {"target_torque", {0x6071, 0}, DataType::int16, Quantity::torque, false, true, true, false},
      {"profile_velocity",
       {0x6081, 1},
       DataType::uint32,
       Quantity::velocity,
       true,
       true,
       false,
       false},
      {"plain", {0x2000, 0}, DataType::uint8, Quantity::none, true, true, false, false},
  };
  for (const Row& row : rows) {
    const ObjectSpec* object = profile.find(row.name);
    ASSERT_NE(object, nullptr) << row.name;
    EXPECT_EQ(object, profile.find(row.id)) << row.name;
    EXPECT_EQ(object->type, row.type) << row.name;
    EXPECT_EQ(object->quantity, row.quantity) << row.name;
    EXPECT_EQ(object->readable, row.readable) << row.name;
    EXPECT_EQ(object->writable, row.writable) << row.name;
    EXPECT_EQ(object->rpdo, row.rpdo) << row.name;
    EXPECT_EQ(object->tpdo, row.tpdo) << row.name;
  }
  const ObjectSpec* velocity = profile.find("profile_velocity");
  EXPECT_DOUBLE_EQ(velocity->factor, 2.5);
  ASSERT_TRUE(velocity->unit);
  EXPECT_EQ(velocity->unit->base, UnitSpec::Base::turn);
  EXPECT_TRUE(velocity->unit->per_minute);
  EXPECT_EQ(profile.find("nothing"), nullptr);
  EXPECT_EQ(profile.find(ObjectId{0x2000, 1}), nullptr);
}

TEST_F(ProfileKeys, ModesHaveTheirBits) {
  const ModeSpec* pp = profile.mode("pp");
  ASSERT_NE(pp, nullptr);
  EXPECT_EQ(pp->name, "profile_position");
  EXPECT_EQ(pp->value, 1);
  EXPECT_EQ(pp->kind, ControlKind::position);
  EXPECT_FALSE(pp->cyclic);
  EXPECT_EQ(pp->target, "target_position");
  EXPECT_THAT(pp->handover.words, ElementsAre(0x0020, 0x0030));
  EXPECT_EQ(pp->handover.acknowledge, Handover::Acknowledge::level);
  EXPECT_EQ(pp->handover.each_for, 2);
  EXPECT_EQ(pp->controlword_bits, 0x0020);
  EXPECT_EQ(pp->target_reached_bit, 10);
  EXPECT_EQ(pp->set_point_acknowledge_bit, 12);
  EXPECT_EQ(pp->following_error_bit, 13);
  EXPECT_EQ(pp->stop, StopBy::halt);
  EXPECT_FALSE(pp->speed_zero_bit || pp->homing_attained_bit || pp->homing_error_bit ||
               pp->follows_command_bit);
  const ModeSpec* pt = profile.mode("pt");
  ASSERT_NE(pt, nullptr);
  EXPECT_EQ(pt->kind, ControlKind::torque);
  EXPECT_EQ(pt->speed_zero_bit, 9);
  EXPECT_EQ(pt->follows_command_bit, 14);
  EXPECT_EQ(pt->stop, StopBy::quick_stop);
  EXPECT_EQ(pt->stop_mode, "");
  ASSERT_EQ(pt->entry_writes.size(), 1U);
  EXPECT_EQ(pt->entry_writes[0].object, "profile_velocity");
  EXPECT_EQ(pt->entry_writes[0].from, "limits.velocity");
  EXPECT_DOUBLE_EQ(pt->entry_writes[0].times, 1.5);
  EXPECT_TRUE(pt->entry_writes[0].optional);
  const ModeSpec* csp = profile.mode("csp");
  ASSERT_NE(csp, nullptr);
  EXPECT_EQ(csp->value, 300) << "6060h has 16 bits here";
  EXPECT_TRUE(csp->cyclic);
  EXPECT_EQ(csp->stop, StopBy::set_points);
  const ModeSpec* homing = profile.mode("homing");
  ASSERT_NE(homing, nullptr);
  EXPECT_EQ(homing->kind, ControlKind::homing);
  EXPECT_EQ(homing->target_reached_bit, 10);
  EXPECT_EQ(homing->homing_attained_bit, 12);
  EXPECT_EQ(homing->homing_error_bit, 13);
  EXPECT_FALSE(homing->stop);
}

TEST_F(ProfileKeys, BehaviourIsAsWritten) {
  EXPECT_TRUE(profile.output_shaft);
  EXPECT_FALSE(profile.halt_supported);
  EXPECT_TRUE(profile.warning_stops);
  EXPECT_FALSE(profile.has_warning_bit);
  EXPECT_EQ(profile.status_words[7], "bit 7");
  EXPECT_EQ(profile.status_words[8], "abnormal stop");
  EXPECT_EQ(profile.status_words[14], "");
  EXPECT_EQ(profile.status_words[15], "homed");
  EXPECT_TRUE(profile.mode_change.needs_disabling);
  EXPECT_THAT(profile.quick_stop_holds, ElementsAre(5, -6));
  EXPECT_EQ(device.sync_counter, 12);
  EXPECT_TRUE(device.has_sync_counter_object);
  EXPECT_FALSE(device.has_sync_period_object);
  EXPECT_EQ(device.sync_period_step, milliseconds(1));
  EXPECT_FALSE(device.heartbeat_supported);
  EXPECT_FALSE(device.heartbeat_consumer_supported);
  EXPECT_TRUE(device.node_guarding_supported);
  EXPECT_EQ(device.boot_time, milliseconds(1500));
  EXPECT_EQ(profile.timing.state_change, milliseconds(2500));
  EXPECT_EQ(profile.timing.transition(3), milliseconds(2500)) << "as it has no time of its own";
  EXPECT_EQ(profile.timing.transition(4), milliseconds(4250));
  EXPECT_EQ(profile.timing.transition(16), milliseconds(125));
  EXPECT_THAT(profile.signals, ElementsAre("plain"));
  EXPECT_EQ(profile.timing.mode_change, milliseconds(3500));
  EXPECT_EQ(profile.timing.brake_release, milliseconds(250));
  EXPECT_EQ(device.sdo.timeout, milliseconds(750));
  EXPECT_EQ(device.sdo.retries, 3);
  EXPECT_THAT(profile.parameters.save, ElementsAre(2, 3));
  EXPECT_THAT(profile.parameters.restore, ElementsAre(4));
  EXPECT_EQ(profile.parameters.timeout, milliseconds(4500));
  EXPECT_TRUE(profile.parameters.power_cycle_after_save);
  EXPECT_EQ(profile.fault_reset.tries, 4);
  EXPECT_EQ(profile.fault_reset.pause, milliseconds(150));
}

TEST_F(ProfileKeys, WritesAreAsWritten) {
  ASSERT_EQ(profile.homing.methods.size(), 3U);
  EXPECT_FALSE(profile.homing.methods.at(-2).moves);
  EXPECT_EQ(profile.homing.methods.at(-1).text, "to the stop");
  EXPECT_TRUE(profile.homing.methods.at(-1).moves);
  EXPECT_EQ(profile.homing.methods.at(35).text, "here");
  EXPECT_FALSE(profile.homing.methods.at(35).moves) << "CiA 402-2: on the present position";
  EXPECT_TRUE(profile.homing.needs_zero_attained_before_start);
  ASSERT_EQ(profile.homing.writes.size(), 1U);
  EXPECT_EQ(profile.homing.writes[0].raw, 7);
  ASSERT_EQ(profile.startup.size(), 2U);
  EXPECT_EQ(profile.startup[0].object, "2001:02");
  EXPECT_EQ(profile.startup[0].type, DataType::uint16);
  EXPECT_EQ(profile.startup[0].raw, 0x1FF);
  EXPECT_FALSE(profile.startup[0].optional || profile.startup[0].when_homed);
  EXPECT_EQ(profile.startup[1].value, 9.0);
  EXPECT_DOUBLE_EQ(profile.startup[1].times, 1.0);
  ASSERT_EQ(profile.before_enable.size(), 1U);
  EXPECT_EQ(profile.before_enable[0].from, "position_actual");
}

TEST_F(ProfileKeys, PdosAreAsWritten) {
  EXPECT_EQ(device.max_rpdos, 5U);
  EXPECT_EQ(device.max_tpdos, 6U);
  EXPECT_EQ(device.max_pdo_entries, 3U);
  EXPECT_TRUE(device.pdo_map_count_may_be_read_only);
  EXPECT_EQ(device.fixed_pdo_entries, 6U);
  EXPECT_TRUE(device.cob_ids_of_drive);
  EXPECT_TRUE(device.rpdo_deadline);
  ASSERT_EQ(device.fixed_pdos.size(), 1U);
  EXPECT_EQ(device.fixed_pdos[0].number, 6U);
  ASSERT_EQ(device.pdos.size(), 4U);
  const canopen::PdoLayout& plain = device.pdos[0];
  EXPECT_EQ(plain.direction, canopen::PdoDirection::rpdo);
  EXPECT_EQ(plain.transmission, 1);
  EXPECT_EQ(plain.cob_id.kind, CobIdSpec::Kind::predefined);
  EXPECT_THAT(plain.objects, ElementsAre("controlword", "target_position"));
  const canopen::PdoLayout& fifth = device.pdos[1];
  EXPECT_EQ(fifth.number, 5U);
  EXPECT_EQ(fifth.transmission, 254);
  EXPECT_EQ(fifth.event_timer, 123);
  EXPECT_EQ(fifth.inhibit, 0);
  EXPECT_EQ(fifth.refresh_every, 7);
  EXPECT_EQ(fifth.cob_id.kind, CobIdSpec::Kind::absolute);
  EXPECT_EQ(fifth.cob_id.value, 0x1A5);
  const canopen::PdoLayout& sampled = device.pdos[2];
  EXPECT_EQ(sampled.direction, canopen::PdoDirection::tpdo);
  EXPECT_EQ(sampled.transmission, 0);
  EXPECT_EQ(sampled.inhibit, 456);
  EXPECT_EQ(sampled.cob_id.kind, CobIdSpec::Kind::node_id);
  EXPECT_EQ(sampled.cob_id.value, 0x1A0);
  const canopen::PdoLayout& asked = device.pdos[3];
  EXPECT_EQ(asked.transmission, 253);
  EXPECT_EQ(asked.request_every, 8);
  EXPECT_EQ(asked.cob_id.kind, CobIdSpec::Kind::drive);
  EXPECT_THAT(profile.default_modes, ElementsAre("cyclic_position", "profile_position"));
  EXPECT_THAT(profile.feedback, ElementsAre("mode_display", "target_position"));
}

TEST_F(ProfileKeys, ErrorsHaveWords) {
  ASSERT_EQ(profile.errors.size(), 3U);
  EXPECT_EQ(profile.errors[0x2310].reset, ErrorText::Reset::by_bit);
  EXPECT_EQ(profile.errors[0x2310].wait, Duration::zero());
  EXPECT_EQ(profile.errors[0xFF0B].reset, ErrorText::Reset::power_cycle);
  EXPECT_EQ(profile.errors[0xFF0B].wait, std::chrono::seconds(60));
  EXPECT_EQ(profile.errors[0x2310].text, "too much current");
  EXPECT_EQ(profile.errors[0x2310].missing, ErrorText::Missing::nothing);
  EXPECT_EQ(profile.errors[0x8250].text, "late");
  EXPECT_EQ(profile.errors[0x8250].cause, "nobody sent");
  EXPECT_EQ(profile.errors[0x8250].remedy, "send");
  EXPECT_EQ(profile.errors[0x8250].missing, ErrorText::Missing::outputs);
}

TEST(ProfileWarnings, HaveWordsAndAReaction) {
  using Reaction = drive::WarningText::Reaction;
  Problems problems;
  DriveFamily family = parseDriveFamily(
      std::string(kHead) +
          "  csp: {value: 8, control: position, target: target_position}\n"
          "warnings:\n"
          "  0x2310: nearly too much current\n"
          "  0xFF0C: {text: stalled, cause: load, remedy: less of it, reaction: holds}\n"
          "  0xFF0D: {text: warm, reaction: goes_on}\n"
          "  0xFF0E: {text: hot, reaction: stops}\n",
      "full.yaml", problems);
  ASSERT_EQ(problems.text(), "");
  DriveProfile& profile = family.drive;
  ASSERT_EQ(profile.warnings.size(), 4U);
  EXPECT_EQ(profile.warnings[0x2310].text, "nearly too much current");
  EXPECT_FALSE(profile.warnings[0x2310].reaction.has_value());
  EXPECT_EQ(profile.warnings[0xFF0C].cause, "load");
  EXPECT_EQ(profile.warnings[0xFF0C].remedy, "less of it");
  EXPECT_EQ(profile.warnings[0xFF0C].reaction, Reaction::holds);
  EXPECT_EQ(profile.warnings[0xFF0D].reaction, Reaction::goes_on);
  EXPECT_EQ(profile.warnings[0xFF0E].reaction, Reaction::stops);
}

TEST(ProfileErrors, SayWhatTheDriveDoesWithTheMotor) {
  using Reaction = ErrorText::Reaction;
  Problems problems;
  DriveFamily family =
      parseDriveFamily(std::string(kHead) +
                           "  csp: {value: 8, control: position, target: target_position}\n"
                           "fault_reaction: brakes\n"
                           "errors:\n"
                           "  0x2310: too much current\n"
                           "  0xFF0C: {text: bridge broken, reaction: coasts}\n",
                       "full.yaml", problems);
  ASSERT_EQ(problems.text(), "");
  const DriveProfile& profile = family.drive;
  EXPECT_EQ(profile.fault_reaction, Reaction::brakes);
  EXPECT_FALSE(profile.errors.at(0x2310).reaction.has_value());
  EXPECT_EQ(profile.errors.at(0xFF0C).reaction, Reaction::coasts);
  EXPECT_EQ(drive::reactionText(profile, 0x2310), "; the drive brakes the motor");
  EXPECT_EQ(drive::reactionText(profile, 0xFF0C), "; the drive lets the motor coast");
  EXPECT_EQ(drive::reactionText(DriveProfile{}, 0x2310), "");
}

TEST(ProfileDefaults, AreThoseOfTheStandards) {
  Problems problems;
  const DriveFamily family = parseDriveFamily(
      std::string(kHead) + "  csp: {value: 8, control: position, target: target_position}\n",
      "full.yaml", problems);
  const DriveProfile& profile = family.drive;
  const canopen::DeviceProfile& device = family.device;
  EXPECT_EQ(problems.text(), "");
  EXPECT_TRUE(profile.halt_supported);
  EXPECT_TRUE(profile.has_warning_bit);
  EXPECT_EQ(profile.status_words, drive::StatusWords());
  EXPECT_FALSE(profile.output_shaft || profile.warning_stops ||
               profile.mode_change.needs_disabling);
  EXPECT_THAT(profile.quick_stop_holds, IsEmpty());
  EXPECT_FALSE(device.sync_counter);
  EXPECT_TRUE(device.has_sync_counter_object && device.has_sync_period_object);
  EXPECT_EQ(device.sync_period_step, microseconds(1));
  EXPECT_TRUE(device.heartbeat_supported && device.heartbeat_consumer_supported);
  EXPECT_FALSE(device.node_guarding_supported);
  EXPECT_EQ(device.max_rpdos, 4U);
  EXPECT_EQ(device.max_tpdos, 4U);
  EXPECT_EQ(device.max_pdo_entries, 8U);
  EXPECT_EQ(device.fixed_pdo_entries, 0U);
  EXPECT_FALSE(device.pdo_map_count_may_be_read_only || device.cob_ids_of_drive ||
               device.cob_ids_of_node || device.rpdo_deadline);
  EXPECT_TRUE(device.remote_requests);
  EXPECT_EQ(device.error_control_min, Duration::zero());
  EXPECT_EQ(profile.fault_reset.tries, 1);
  EXPECT_EQ(profile.fault_reset.pause, Duration::zero());
  EXPECT_FALSE(profile.parameters.power_cycle_after_save);
  EXPECT_TRUE(profile.homing.methods.empty());
  EXPECT_FALSE(profile.mode("csp")->cyclic);
  EXPECT_TRUE(profile.mode("csp")->handover.words.empty());
}

}  // namespace
}  // namespace cia402::config
