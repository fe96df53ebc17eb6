// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/reload.h"

namespace cia402::config {
namespace {

constexpr ChangeTime kRunning = ChangeTime::running, kDisabled = ChangeTime::disabled,
                     kRestart = ChangeTime::restart;

constexpr char kAsItBoots[] = "it is written into the drive, or agreed with it, as it boots";
constexpr char kPdos[] = "the drive's PDOs are made for it";
constexpr char kPlace[] = "where the joint stands is counted by it";
constexpr char kOtherDrive[] = "it says which drive is driven, and how";
constexpr char kHomed[] = "whether an axis is homed, and where its zero is, hangs on it";
constexpr char kCoupled[] =
    "the joints, their limits and how a skew is taken back are worked out with it";
constexpr char kTf[] = "tf is told of it at the start";
constexpr char kStart[] = "it is read at the start alone";

}  // namespace

const std::vector<ReloadRule>& reloadRules() {
  // clang-format off
  static const std::vector<ReloadRule> kRules = {
      {"joint_state_rate", kRunning, ""},
      {"axes/*/command_timeout", kRunning, ""},
      {"axes/*/position_loop/*", kRunning, ""},
      {"groups/*/constraints/goal_time", kRunning, ""},
      {"groups/*/constraints/stopped_velocity_tolerance", kRunning, ""},
      {"groups/*/constraints/*/trajectory", kRunning, ""},
      {"groups/*/constraints/*/goal", kRunning, ""},
      {"groups/*/stop_trajectory_duration", kRunning, ""},
      {"groups/*/allow_partial_joints_goal", kRunning, ""},

      {"axes/*/limits/*", kDisabled, ""},
      {"axes/*/homing/search_velocity", kDisabled, ""},
      {"axes/*/homing/zero_velocity", kDisabled, ""},
      {"axes/*/homing/acceleration", kDisabled, ""},
      {"axes/*/homing/timeout", kDisabled, ""},
      {"axes/*/homing/order", kDisabled, ""},
      {"groups/*/stop_group_on_fault", kDisabled, ""},

      {"axes/*/homing/*", kRestart, kHomed},
      {"axes/*/type", kRestart, kPlace},
      {"axes/*/counts_per_turn", kRestart, kPlace},
      {"axes/*/gear_ratio", kRestart, kPlace},
      {"axes/*/output_shaft", kRestart, kPlace},
      {"axes/*/unit_system", kRestart, kPlace},
      {"axes/*/lead", kRestart, kPlace},
      {"axes/*/direction", kRestart, kPlace},
      {"axes/*/position_offset", kRestart, kPlace},
      {"axes/*/rated_torque", kRestart, "efforts are counted by it"},
      {"axes/*/joint", kRestart, "topics, groups and frames know the joint by its name"},
      {"axes/*/node_id", kRestart, "the identifiers of all its frames are made of it"},
      {"axes/*/device_axis", kRestart, kOtherDrive},
      {"axes/*/drive", kRestart, kOtherDrive},
      {"axes/*/eds", kRestart, kOtherDrive},
      {"axes/*/pdos/**", kRestart, kPdos},
      {"axes/*/modes", kRestart, kPdos},
      {"axes/*/feedback", kRestart, kPdos},
      {"axes/*/feed_forward/**", kRestart, kPdos},
      {"axes/*/set_point_stream/**", kRestart, "the way to lead the drive is planned with it"},
      {"axes/*/frame/**", kRestart, kTf},
      {"axes/*/simulation/**", kRestart, "the simulated drives are made at the start"},
      {"axes/*/**", kRestart, kAsItBoots},
      {"groups/**", kRestart, "topics, services and actions are offered for it"},
      {"bus/**", kRestart, "the bus was opened, and the drives were configured, with it"},
      {"couplings", kRestart, kCoupled},
      {"recorder/**", kRestart, "its memory and files are laid out at the start"},
      {"static_frames", kRestart, kTf},
      {"publish_tf", kRestart, kTf},
      {"**", kRestart, kStart},
  };
  // clang-format on
  return kRules;
}

}  // namespace cia402::config
