// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>

#include "drive/axis/axis.h"
#include "drive/fake_device.h"

namespace cia402::drive::test {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;

inline ObjectSpec object(std::string name, std::uint16_t index, DataType type,
                         Quantity quantity = Quantity::none, std::uint8_t subindex = 0) {
  ObjectSpec spec;
  spec.name = std::move(name);
  spec.id = {index, subindex};
  spec.type = type;
  spec.quantity = quantity;
  return spec;
}

inline ModeSpec modeSpec(std::string name, int value, ControlKind kind, bool cyclic,
                         std::string target) {
  ModeSpec mode;
  mode.name = std::move(name);
  mode.value = value;
  mode.kind = kind;
  mode.cyclic = cyclic;
  mode.target = std::move(target);
  return mode;
}

inline NamedWrite from(std::string name, std::string source) {
  NamedWrite write;
  write.object = std::move(name);
  write.from = std::move(source);
  return write;
}

/// 1 count = 0.0001 rad at the joint; velocities likewise.
inline DriveProfile testProfile() {
  DriveProfile profile;
  profile.name = "test_drive";
  profile.output_shaft = true;
  UnitSpec position;
  position.base = UnitSpec::Base::radian;
  position.scale = 1e-4;
  profile.units[Quantity::position] = position;
  position.per_seconds = 1;
  profile.units[Quantity::velocity] = position;
  position.per_seconds = 2;
  profile.units[Quantity::acceleration] = position;
  UnitSpec torque;
  torque.base = UnitSpec::Base::per_mille_of_rated;
  profile.units[Quantity::torque] = torque;
  profile.objects = {
      object("controlword", 0x6040, DataType::uint16),
      object("statusword", 0x6041, DataType::uint16),
      object("mode", 0x6060, DataType::int8),
      object("mode_display", 0x6061, DataType::int8),
      object("error_code", 0x603F, DataType::uint16),
      object("quick_stop_option", 0x605A, DataType::int16),
      object("position_actual", 0x6064, DataType::int32, Quantity::position),
      object("velocity_actual", 0x606C, DataType::int32, Quantity::velocity),
      object("torque_actual", 0x6077, DataType::int16, Quantity::torque),
      object("target_position", 0x607A, DataType::int32, Quantity::position),
      object("target_velocity", 0x60FF, DataType::int32, Quantity::velocity),
      object("target_torque", 0x6071, DataType::int16, Quantity::torque),
      object("home_offset", 0x607C, DataType::int32, Quantity::position),
      object("homing_method", 0x6098, DataType::int8),
      object("homing_search_velocity", 0x6099, DataType::uint32, Quantity::velocity, 1),
      object("profile_velocity", 0x6081, DataType::uint32, Quantity::velocity),
      object("interpolation_target", 0x60C1, DataType::int32, Quantity::position, 1),
  };
  ModeSpec pp = modeSpec("profile_position", 1, ControlKind::position, false, "target_position");
  pp.handover = standardHandover(true);
  pp.set_point_acknowledge_bit = 12;
  pp.target_reached_bit = 10;
  ModeSpec pv = modeSpec("profile_velocity", 3, ControlKind::velocity, false, "target_velocity");
  ModeSpec hm = modeSpec("homing", 6, ControlKind::homing, false, "");
  hm.homing_attained_bit = 12;
  hm.homing_error_bit = 13;
  hm.target_reached_bit = 10;
  ModeSpec ip =
      modeSpec("interpolated_position", 7, ControlKind::position, true, "interpolation_target");
  ModeSpec csp = modeSpec("cyclic_position", 8, ControlKind::position, true, "target_position");
  ModeSpec csv = modeSpec("cyclic_velocity", 9, ControlKind::velocity, true, "target_velocity");
  profile.modes = {pp, pv, hm, ip, csp, csv};
  profile.homing.methods[17] = {"negative limit switch", true, {}};
  profile.homing.methods[37] = {"present position", false, {}};
  profile.homing.writes = {from("homing_method", "homing.method"),
                           from("homing_search_velocity", "homing.search_velocity"),
                           from("home_offset", "homing.offset")};
  profile.errors[0x8611] = {"following error", "the axis is blocked or the gains are too low",
                            "check the mechanics and 6065:00"};
  return profile;
}

inline AxisConfig testConfig(DriveProfile profile = testProfile()) {
  AxisConfig config;
  config.name = config.joint = "shoulder";
  config.place = "node 3";
  config.profile = std::make_shared<const DriveProfile>(std::move(profile));
  config.geometry.rated_torque = 2.0;
  config.limits.lower = -3.1;
  config.limits.upper = 3.1;
  config.limits.velocity = 2.0;
  config.limits.acceleration = 8.0;
  config.limits.effort = 4.0;
  config.mode = "cyclic_position";
  return config;
}

/// Two groups each way.
inline Layout testLayout() {
  Layout layout;
  layout.outputs = {
      {"RPDO 1 (COB-ID 0x203)", {{{0x6040, 0}, 16}, {{0x6060, 0}, 8}, {{0x607A, 0}, 32}}},
      {"RPDO 2 (COB-ID 0x303)", {{{0x60FF, 0}, 32}, {{0x6071, 0}, 16}}}};
  layout.inputs = {
      {"TPDO 1 (COB-ID 0x183)", {{{0x6041, 0}, 16}, {{0x6064, 0}, 32}, {{0x6061, 0}, 8}}},
      {"TPDO 2 (COB-ID 0x283)", {{{0x606C, 0}, 32}, {{0x6077, 0}, 16}, {{0x603F, 0}, 16}}}};
  return layout;
}

/// An input that comes besides those, whenever the test brings it.
inline Group thirdInput(fieldbus::ObjectId object, unsigned bits) {
  Group group;
  group.name = "TPDO 3 (COB-ID 0x383)";
  group.objects = {{object, bits}};
  group.by_test = true;
  return group;
}

/// One axis, its device, one fake drive and a clock that only the test moves.
class Bench {
 public:
  explicit Bench(AxisConfig config = testConfig(), const Layout& layout = testLayout())
      : device_(layout, drive), axis(std::move(config), device_) {}

  /// Boots the device. @return whether it became ready.
  bool boot() {
    device_.boot(now, true);
    return runUntil([&] { return device_.health() == fieldbus::Health::ready; }) &&
           runUntil([&] { return axis.state().feedback_valid; });
  }

  void cycle() { pass(true); }
  /// A cycle in which no output leaves, such as of a bus that is full: the drive goes by the last.
  void cycleWithoutOutputs() { pass(false); }
  void run(Duration time) {
    for (const Time end = now + time; now < end;) cycle();
  }
  bool runUntil(const std::function<bool()>& condition, Duration limit = std::chrono::seconds(60)) {
    for (const Time end = now + limit; now < end;) {
      cycle();
      if (condition()) return true;
    }
    return false;
  }
  /// Starts a procedure and runs it to its end.
  const ProcedureStatus& perform(ProcedureKind kind, const std::string& mode = {},
                                 double position = 0.0) {
    const auto id = axis.start({kind, mode, position}, now);
    EXPECT_TRUE(id.ok()) << (id.ok() ? "" : id.error().message);
    EXPECT_TRUE(runUntil([&] { return !axis.procedure().running; })) << axis.procedure().step;
    return axis.procedure();
  }
  std::string refusal(ProcedureKind kind, const std::string& mode = {}, double position = 0.0) {
    const auto id = axis.start({kind, mode, position}, now);
    return id.ok() ? std::string("was not refused") : id.error().message;
  }
  /// From now on gives `value` as set-point in every cycle.
  void follow(double value) {
    each_cycle = [this, value] { static_cast<void>(axis.setTarget(value)); };
  }
  /// The set-point of the next cycle. @return whether it was taken
  bool give(double value) {
    bool taken = false;
    each_cycle = [&] { taken = axis.setTarget(value); };
    cycle();
    each_cycle = nullptr;
    return taken;
  }
  bool enable() {
    const ProcedureStatus& status = perform(ProcedureKind::enable);
    EXPECT_TRUE(status.success) << status.message;
    return status.success;
  }
  /// An input comes, or more of them at once, as if the drive had sent it.
  void bring(fieldbus::ObjectId object, std::uint64_t raw) { bring({{object, raw}}); }
  void bring(const Values& values) { device_.bring(values, true, now); }
  /// Whether the drive notices that the driver is gone.
  void noticeLostMaster(bool notices) { device_.noticeLostMaster(notices); }
  /// The drive starts anew, which nobody has asked for.
  void reboot() {
    drive.reboot();
    tell([&] { device_.restarted(now); });
  }
  /// An emergency comes.
  void emergency(std::uint16_t code) {
    device_.hearEmergency(code, now);
    axis.onEmergency(*device_.lastEmergency(), now);
  }
  /// The drive fails, and says so by an emergency.
  void fail(std::uint16_t code) {
    drive.fail(code);
    emergency(code);
  }
  FakeDevice& device() { return device_; }

  static constexpr Duration kCycle = milliseconds(4);
  FakeDrive drive;
  Time now{std::chrono::seconds(1)};
  std::function<void()> each_cycle;

 private:
  void pass(bool outputs_leave) {
    now += kCycle;
    if (now - last_sign_ >= milliseconds(50) && !drive.dead) {
      last_sign_ = now;
      tell([&] { device_.hear(now); });
    }
    device_.age();
    device_.bring(drive.cycle(toSeconds(kCycle)), false, now);
    axis.readFeedback(now);
    axis.update(now);
    if (each_cycle) each_cycle();
    axis.writeCommands(now);
    if (outputs_leave) device_.send();
    tell([&] { device_.exchange(now); });
    device_.supervise(now);
  }
  /// What the device hears may change its health, of which the axis is told.
  void tell(const std::function<void()>& news) {
    const auto before = device_.health();
    news();
    if (before != device_.health()) axis.onHealthChange();
  }

  FakeDevice device_;
  Time last_sign_{};  ///< of life

 public:
  Axis axis;
};

}  // namespace cia402::drive::test
