// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/habits.h"

#include <algorithm>
#include <map>
#include <vector>

namespace cia402::campaign {
namespace {

struct Habit {
  const char* about;    ///< one of its kind only
  const char* section;  ///< of the simulated drive's file
  const char* key;
  const char* mode_change;  ///< entries of that section of the profile
  const char* profile;      ///< other keys of it
};

constexpr const char* kForgetful = "shown: enabled, again: same";  // what is told while disabled
constexpr const char* kDisablingDetour = "detours: {profile_velocity: {cyclic_position: disabled}}";

// docs/simulated_drives.md says what each is. Left out is what costs more than a history has time
// for (modes and searches of seconds, a power cycle after each save), what holds the whole bus,
// what hides from the statusword that there is power, what fixes the homing method, which is drawn
// beside (homing_is_fixed), and what only acts where the drive holds a bad COB-ID, which nobody
// here writes (misleading_cob_id_abort).
constexpr Habit kHabits[] = {
    {"mode", "quirks", "mode_shown_when_enabled: true", "shown: enabled", ""},
    {"mode", "quirks", "mode_command: enabled", kForgetful, ""},
    {"mode", "quirks", "mode_command: change", "shown: enabled, again: through_zero", ""},
    {"mode", "quirks", "mode_needed: true", "", ""},
    {"mode", "quirks", "mode_change_time: 0.3", "", ""},
    {"start", "quirks", "mode_shown_at_start: 2", "", ""},
    {"time", "quirks", "enabling_time: 0.18", "", ""},
    {"halt", "quirks", "halt_blocks_mode: true", "while_halted: false", ""},
    {"detour", "quirks", "mode_faults: [[3, 8]]",
     "detours: {profile_velocity: {cyclic_position: profile_position}}", ""},
    {"detour", "quirks", "mode_faults: [[3, 8]]", kDisablingDetour, ""},
    {"fault", "quirks", "fault_bits: 0x0040", "", ""},
    {"vendor", "quirks", "vendor_bits: 0xC100", "", ""},
    {"vendor", "quirks", "vendor_bits: 0x8200", "", ""},
    {"target", "quirks", "homing_reaches_no_target: true", "",
     "modes: {homing: {status_bits: {target_reached: ~}}}"},
    {"reset", "quirks", "fault_reset_tries: 3", "", "fault_reset_tries: 3"},
    {"reset", "quirks", "fault_reset_needs_stop: 0.1", "", "fault_reset_nmt_stop: 0.1"},
    {"history", "quirks", "fault_reset_needs_empty_history: true", "",
     "fault_reset_clears_history: true"},
    {"edge", "quirks", "reset_edge_time: 0.001", "", ""},
    {"register", "quirks", "no_generic_error_bit: true", "", ""},
    {"chatter", "quirks", "emergency_chatter: true", "", ""},
    {"passive", "quirks", "passive_when_alone: true", "", ""},
    {"sync", "quirks", "sync_needed: true", "", ""},
    {"missing", "communication", "silent_on_missing: true", "", ""},
    {"answer", "communication", "echoes_writes: true", "", ""},
    {"answer", "communication", "leaves_rubbish: true", "", ""},
    {"answer", "communication", "answers_four_bytes: true", "", ""},
    {"boot", "communication", "boot_time: 0.231", "", ""},
    {"boot", "communication", "boot_time_varies: 0.2", "", ""},
    {"latency", "communication", "sdo_latency: 0.03", "", ""},
    {"boot", "communication", "answers_after_boot: true", "", ""},
    {"overrun", "communication", "overruns_at_boot: 2", "", ""},
    {"rtr", "communication", "keeps_rtr_bit: true", "", ""},
    {"segments", "communication", "announces_four_bytes: true", "", ""},
    {"rpdo", "communication", "rpdos_at_once: true", "", ""},
    {"map", "communication", "fixed_map_entries: 8", "", "pdo_rules: {fixed_entries: 8}"},
    {"word", "communication", "stale_statusword: 0.029", "", ""},
};

/// A drive that has both could never be brought from the one mode into the other.
bool contradict(const std::string& mode_change, const Habit& habit) {
  const bool forgetful = mode_change.find(kForgetful) != std::string::npos;
  const bool by_disabling = mode_change.find(kDisablingDetour) != std::string::npos;
  return (forgetful && habit.mode_change == kDisablingDetour) ||
         (by_disabling && habit.mode_change == kForgetful);
}

void append(std::string& list, const std::string& more) {
  if (!more.empty()) list += (list.empty() ? "" : ", ") + more;
}

}  // namespace

Habits drawHabits(Random& random) {
  std::vector<std::string> taken;
  std::map<std::string, std::string> sections;
  std::string mode_change;
  Habits habits;
  for (std::size_t left = 1 + random.below(3); left > 0; --left) {
    const Habit& habit = kHabits[random.below(std::size(kHabits))];
    if (std::find(taken.begin(), taken.end(), habit.about) != taken.end()) continue;
    if (contradict(mode_change, habit)) continue;
    taken.emplace_back(habit.about);
    append(sections[habit.section], habit.key);
    append(mode_change, habit.mode_change);
    append(habits.profile, habit.profile);
  }
  for (const auto& [name, keys] : sections) append(habits.simulation, name + ": {" + keys + "}");
  if (!mode_change.empty()) append(habits.profile, "mode_change: {" + mode_change + "}");
  return habits;
}

}  // namespace cia402::campaign
