// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "system/field_profile.h"

namespace cia402::field {

using namespace std::chrono_literals;
using drive::ProcedureKind;

/// What a drive does otherwise, and what its profile says of that.
struct Habit {
  const char* name;
  const char* source;
  const char* behaviour;          // keys of the simulated drive, a line each
  const char* mode_change;        // entries of that section of the profile
  const char* profile;            // other keys at its top, or timing/KEY: SECONDS
  bool known_by_profile = false;  // without its keys the driver cannot serve it
};

inline constexpr Habit kHabits[] = {
    {"ShowsItsModeWhenEnabled", "Technosoft iPOS (roboticslab-uc3m/yarp-devices#215), Kinco iSWV",
     "quirks/mode_shown_when_enabled: true", "shown: enabled", "", true},
    {"ForgetsTheModeWhileDisabled", "Laifual (CoE)", "quirks/mode_command: enabled",
     "shown: enabled, again: same", "", true},
    {"WantsModeZeroFirst", "Laifual (CoE)", "quirks/mode_command: change",
     "shown: enabled, again: through_zero", "", true},
    {"EnablesInAModeOnly", "Nanotec PD4-C (ros-industrial/ros_canopen#331)",
     "quirks/mode_needed: true", "", ""},
    {"TakesItsTimeToEnable", "trace of a Technosoft iPOS", "quirks/enabling_time: 0.18", "", ""},
    {"TakesNoModeWhileHalted", "Engel HBI (ros-industrial/ros2_canopen#234)",
     "quirks/halt_blocks_mode: true", "while_halted: false", ""},
    {"FaultsAtAChangeOfMode", "Technosoft iPOS (roboticslab-uc3m/yarp-devices#170)",
     "quirks/mode_faults: [[3, 8]]",
     "detours: {profile_velocity: {cyclic_position: profile_position}}", "", true},
    {"DisablesForAChangeOfMode", "Technosoft iPOS (roboticslab-uc3m/yarp-devices#170)",
     "quirks/mode_faults: [[3, 8]]", "detours: {profile_velocity: {cyclic_position: disabled}}", "",
     true},
    {"ShowsFaultWithBitsOfNoState", "Technosoft iPOS8020 (OpenEtherCATsociety/SOEM#461)",
     "quirks/fault_bits: 0x0040", "", ""},
    {"HasBitsOfItsMaker", "maxon EPOS (machinekit/machinekit#589) and others",
     "quirks/vendor_bits: 0xC100", "", ""},
    {"ShowsNoRemote", "0x8050 (ICube-Robotics/ethercat_driver_ros2#76, CoE)",
     "quirks/vendor_bits: 0x8200", "", ""},
    {"ReachesNoTargetInHoming", "JVL MIS (ros-industrial/ros2_canopen#245)",
     "quirks/homing_reaches_no_target: true", "", "homing without target_reached", true},
    {"HomesInOneWayOnly",
     "Schunk Powerball (fzi-forschungszentrum-informatik/schunk_canopen_driver)",
     "quirks/homing_is_fixed: true\n/dictionary: [[0x6098, 0, homing_method, int8, rw, rt, 17]]",
     "", "homing without parameters", true},
    {"NeedsItsHistoryCleared",
     "Schunk modules (fzi-forschungszentrum-informatik/schunk_canopen_driver)",
     "quirks/fault_reset_needs_empty_history: true", "", "fault_reset_clears_history: true", true},
    {"NeedsSeveralFaultResets", "Schunk modules", "quirks/fault_reset_tries: 5", "",
     "fault_reset_tries: 5", true},
    {"LeavesBit0OfTheErrorRegister", "Leadshine iSV2 (ros-industrial/ros2_canopen#298)",
     "quirks/no_generic_error_bit: true", "", ""},
    {"SaysNothingOfMissingObjects", "the servo of canopen-python/canopen#306",
     "communication/silent_on_missing: true", "", ""},
    {"EchoesWhatIsWritten", "NaviCAN wheel servos", "communication/echoes_writes: true", "", ""},
    {"LeavesRubbishInAnswers", "ros-industrial/ros_canopen#259",
     "communication/leaves_rubbish: true", "", ""},
    {"AnswersFourBytes", "canopen-python/canopen#395", "communication/answers_four_bytes: true", "",
     ""},
    {"HasAFixedNumberOfMappedObjects", "Curtis 1232E (canopen-python/canopen#88)",
     "communication/fixed_map_entries: 8", "", "pdo_rules: {fixed_entries: 8}", true},
    {"ResetsFaultsAfterNmtStopOnly", "Schunk modules", "quirks/fault_reset_needs_stop: 0.1", "",
     "fault_reset_nmt_stop: 0.1", true},
    {"MissesQuickEdgesOfTheReset", "Technosoft (roboticslab-uc3m/yarp-devices#215)",
     "quirks/reset_edge_time: 0.001", "", ""},
    {"ChattersInEmergencies", "Technosoft iPOS; Schunk modules (PilzDE/pilz_robots#151)",
     "quirks/emergency_chatter: true", "", ""},
    {"ReportsOverrunsAfterItsBoot", "Ingenia (ros-industrial/ros2_canopen#36)",
     "communication/overruns_at_boot: 2", "", ""},
    {"StartsInErrorPassive", "maxon EPOS4", "quirks/passive_when_alone: true", "", ""},
    {"ShowsNoModeForSeconds", "Festo CMMP-AS (ros-industrial/ros_canopen#457)",
     "quirks/mode_change_time: 2.5", "", "timing/mode_change: 6.0", true},
    {"ShowsAModeThatNobodyHas", "Nanotec N5; ros-industrial/ros2_canopen#268",
     "quirks/mode_shown_at_start: 2\n/without: [0x6502]", "", ""},
    {"SearchesItsCommutation", "Schunk Powerball",
     "quirks/enabling_time: 3.5\nquirks/sync_needed: true", "", "timing/state_change: 5.0", true},
    {"ShowsQuickStopForAMoment", "canopen-python/canopen#167", "quirks/quick_stop_flashes: true",
     "", ""},
    {"HoldsWithTorqueWhenUnwatched", "Tongyi IxL", "quirks/master_lost_holds: true", "", ""},
    {"WantsItsPowerOffAfterASave", "Yaskawa SGD7S (CoE)", "quirks/needs_power_cycle_to_save: true",
     "", "parameters: {power_cycle_after_save: true}"},
    {"JamsTheBusWhenItIsReset", "Elmo (ros-industrial/ros_canopen#334)",
     "communication/reset_jams_bus: 0.5", "", "nmt_reset_node: false"},
    {"KeepsBit30OfItsCobIds", "Roboteq FBL2360T (canopen-python/canopen#228)",
     "communication/keeps_rtr_bit: true", "", ""},
    {"AnnouncesFourBytes", "canopen-python/canopen#135", "communication/announces_four_bytes: true",
     "", ""},
    {"AnswersOldRequestsAfterItsBoot", "Ingenia (ros-industrial/ros2_canopen#36)",
     "communication/answers_after_boot: true\ncommunication/boot_time: 6.5", "", ""},
    {"BootsInAnotherTimeEachTime", "trace of Technosoft iPOS",
     "communication/boot_time_varies: 0.2", "", ""},
    {"TakesRpdosAtOnce", "Kinco FD (canopen-python/canopen#400)",
     "communication/rpdos_at_once: true", "", ""},
    {"HasTwoStatuswords", "trace of Technosoft iPOS", "communication/stale_statusword: 0.029", "",
     ""},
    {"AnswersLate", "ros-industrial/ros2_canopen#194", "communication/sdo_latency: 0.03", "", ""},
    {"BootsLate", "231 ms in a trace of an unknown maker", "communication/boot_time: 0.231", "",
     ""},
};

inline void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

/// Writes a profile of the generic drive with what the habits ask for. @return its path.
inline std::string profileFor(const std::vector<const Habit*>& habits) {
  std::string text = genericProfileText(), changes;
  for (const Habit* habit : habits) {
    const std::string more = habit->mode_change, key = habit->profile;
    if (!more.empty()) changes += (changes.empty() ? "" : ", ") + more;
    if (key == "homing without target_reached") {
      replace(text, "{target_reached: 10, homing_attained: 12, homing_error: 13}",
              "{homing_attained: 12, homing_error: 13}");
    } else if (key == "homing without parameters") {
      for (const char* object : {"method", "search_velocity", "zero_velocity"}) {
        const std::string name = object;
        replace(text, "    - {object: homing_" + name + ", from: homing." + name + "}\n", "");
      }
    } else if (key.rfind("timing/", 0) == 0) {
      const std::string name = key.substr(7, key.find(':') - 6), line = "  " + name + " ";
      const std::size_t at = text.find(line);
      text.replace(at, text.find('\n', at) - at, "  " + key.substr(7));
    } else if (!key.empty()) {
      text += "\n" + key + "\n";
    }
  }
  if (!changes.empty()) text += "\nmode_change: {" + changes + "}\n";
  replace(text, "  boot: 5.0\n", "  boot: 20.0\n");
  return writeProfile(text);
}

inline std::vector<std::string> linesOf(const char* text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// "quirks/mode_needed: true" of each as one mapping.
inline std::string behaviourOf(const std::vector<const Habit*>& habits) {
  std::map<std::string, std::string> sections;
  for (const Habit* habit : habits) {
    for (const std::string& line : linesOf(habit->behaviour)) {
      std::string& section = sections[line.substr(0, line.find('/'))];
      section += (section.empty() ? "" : ", ") + line.substr(line.find('/') + 1);
    }
  }
  const std::string top = sections[""];
  return "with: {quirks: {" + sections["quirks"] + "}, communication: {" +
         sections["communication"] + "}" + (top.empty() ? "" : ", " + top) + "}";
}

inline std::string robotOf(const std::vector<const Habit*>& habits, bool with_keys = true) {
  return genericPair(
      ", drive: " + profileFor(with_keys ? habits : std::vector<const Habit*>()) +
      ", modes: [csp, pv, pp, hm], homing: {method: 17, search_velocity: 0.5, zero_velocity: 0.1, "
      "acceleration: 4.0, offset: -1.0, required: false}, simulation: {drive: generic_cia402, "
      "lower_limit_switch: -1.0, " +
      behaviourOf(habits) + "}");
}

/// One life of the left axis. @return what went wrong, in the driver's words or of the motor;
/// empty: nothing.
class Life {
 public:
  explicit Life(const std::string& robot) : scene_(loadText(robot)) {}

  std::string live() {
    scene_.robot().start();
    const bool booted = scene_.runUntil([this] { return allReady(scene_.robot()); }, 60s);
    if (!booted) return "no boot: " + scene_.told();
    for (const auto step : {&Life::settle, &Life::enableAndMove, &Life::changeMode, &Life::halt,
                            &Life::quickStop, &Life::haltHoming, &Life::home, &Life::fault}) {
      const std::string wrong = (this->*step)();
      if (!wrong.empty()) return wrong;
    }
    return {};
  }

 private:
  std::string call(ProcedureKind kind, const std::string& mode = {}) {
    const bus::Answer answer = scene_.procedure(kind, "left", mode);
    return answer.success ? "" : std::string(toString(kind)) + ": " + answer.message;
  }
  /// The motor goes by `distance` in `duration`, in cyclic_position.
  std::string moveBy(double distance) {
    const double from = scene_.position("left");
    const double goal = scene_.state("left").position + distance;
    const bus::Answer answer = scene_.move({goal, 0.0}, 1s);
    if (!answer.success) return "move: " + answer.message;
    scene_.run(1500ms);
    const double moved = scene_.position("left") - from;
    if (std::abs(moved - distance) < 0.002) return {};
    return "the motor moved by " + std::to_string(moved) + "; " + scene_.told();
  }
  /// A drive that comes up in fault says so in words, and clear_faults is the cure.
  std::string settle() {
    if (scene_.state("left").state != drive::State::fault) return {};
    const std::string refused = call(ProcedureKind::enable);
    if (refused.find("fault 0x") == std::string::npos) return "no word of the fault: " + refused;
    return call(ProcedureKind::clear_faults);
  }
  std::string enableAndMove() {
    scene_.forget();
    std::string wrong = call(ProcedureKind::enable);
    if (!wrong.empty()) return wrong;
    const bus::Answer right = scene_.procedure(ProcedureKind::enable, "right");
    if (!right.success) return right.message;
    scene_.run(300ms);
    if (scene_.seen("left").travel() > 1e-4) return "enabling moved it";
    if (!scene_.truth("left").power_stage_on) return "it has no power";
    return moveBy(0.3);
  }
  std::string changeMode() {
    std::string wrong = call(ProcedureKind::set_mode, "pv");
    if (!wrong.empty()) return wrong;
    scene_.stream("left", 0.2, 1s);
    if (std::abs(scene_.velocity("left") - 0.2) > 0.02) return "no velocity of 0.2 rad/s";
    scene_.run(1s);
    if (std::abs(scene_.velocity("left")) > 1e-3) return "it did not stop after its stream";
    scene_.forget();
    wrong = call(ProcedureKind::set_mode, "csp");
    if (!wrong.empty()) return wrong;
    scene_.run(200ms);
    if (scene_.seen("left").travel() > 2e-3) return "the change of mode moved it";
    return moveBy(-0.2);
  }
  std::string halt() {
    std::string wrong = call(ProcedureKind::set_mode, "pp");
    if (wrong.empty()) wrong = call(ProcedureKind::halt);
    if (!wrong.empty()) return wrong;
    const std::string refused = call(ProcedureKind::set_mode, "csp");
    // Either it is refused in words, or it is done.
    if (refused.empty() != (scene_.axis("left").modeName() == "cyclic_position")) {
      return "halted: " + refused;
    }
    wrong = call(ProcedureKind::enable);
    if (wrong.empty()) wrong = call(ProcedureKind::set_mode, "csp");
    return wrong.empty() ? moveBy(0.1) : wrong;
  }
  std::string quickStop() {
    std::string wrong = call(ProcedureKind::set_mode, "pv");
    if (!wrong.empty()) return wrong;
    scene_.stream("left", 0.3, 500ms);
    wrong = call(ProcedureKind::quick_stop);
    if (!wrong.empty()) return wrong;
    if (std::abs(scene_.velocity("left")) > 1e-3) return "quick_stop was answered in motion";
    wrong = call(ProcedureKind::set_mode, "csp");
    if (wrong.empty()) wrong = call(ProcedureKind::enable);
    return wrong.empty() ? moveBy(-0.15) : wrong;
  }
  /// The second halt comes while the first one would lead back into the mode from before.
  std::string haltHoming() {
    const auto home = scene_.begin(ProcedureKind::home, "left");
    scene_.run(300ms);
    if (home->has_value()) return "home: " + (*home)->message;
    const auto halt = scene_.begin(ProcedureKind::halt, "left");
    scene_.run(8ms);
    std::string wrong = call(ProcedureKind::halt);
    if (wrong.empty()) wrong = call(ProcedureKind::enable);
    if (!wrong.empty()) return wrong;
    scene_.forget();
    scene_.run(500ms);
    if (scene_.seen("left").travel() > 2e-3) return "it went on with its homing";
    return moveBy(0.1);
  }
  std::string home() {
    const std::string wrong = call(ProcedureKind::home);
    if (!wrong.empty()) return wrong;
    if (std::abs(scene_.velocity("left")) > 1e-3) return "home was answered in motion";
    if (std::abs(scene_.state("left").position - scene_.position("left")) > 0.01) {
      return "homed to " + std::to_string(scene_.state("left").position) + " at " +
             std::to_string(scene_.position("left"));
    }
    return moveBy(0.3);
  }
  std::string fault() {
    scene_.inject("left", "overcurrent");
    scene_.run(500ms);
    if (scene_.state("left").state != drive::State::fault) return "the fault is not seen";
    scene_.inject("left", "clear");
    std::string wrong = call(ProcedureKind::clear_faults);
    if (wrong.empty()) wrong = call(ProcedureKind::recover);
    if (wrong.empty()) wrong = moveBy(-0.1);
    return wrong.empty() ? call(ProcedureKind::disable) : wrong;
  }

  Scene scene_;
};

}  // namespace cia402::field
