// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_quirks.h"

namespace cia402::sim {

void readQuirks(DefinitionReader& reader, DriveQuirks& out) {
  reader.read("mode_shown_when_enabled", out.mode_shown_when_enabled);
  reader.read<ModeCommand>("mode_command", out.mode_command,
                           {{"any", ModeCommand::any},
                            {"enabled", ModeCommand::enabled},
                            {"change", ModeCommand::change}});
  reader.read("mode_needed", out.mode_needed);
  reader.read("enabling_time", out.enabling_time);
  reader.read("mode_ignored_while_enabled", out.mode_ignored_while_enabled);
  if (reader.has("refused_transitions")) out.refused_transitions.clear();
  reader.list("refused_transitions", [&](const yaml::Value& item) {
    out.refused_transitions.push_back(item.integer(2, 16).value_or(2));
  });
  reader.read("halt_blocks_mode", out.halt_blocks_mode);
  std::int64_t bits = out.fault_bits;
  reader.read("fault_bits", bits, 0, 0xFFFF);
  out.fault_bits = static_cast<std::uint16_t>(bits);
  reader.read("fault_keeps_mode_bits", out.fault_keeps_mode_bits);
  bits = out.vendor_bits;
  reader.read("vendor_bits", bits, 0, 0xFFFF);
  out.vendor_bits = static_cast<std::uint16_t>(bits);
  reader.read("homing_reaches_no_target", out.homing_reaches_no_target);
  reader.read("homing_result_stays", out.homing_result_stays);
  reader.read("homing_is_fixed", out.homing_is_fixed);
  reader.read("fault_reset_tries", out.fault_reset_tries, 1, 20);
  reader.read("fault_reset_needs_empty_history", out.fault_reset_needs_empty_history);
  reader.read("fault_reset_by_object", out.fault_reset_by_object);
  reader.read("fault_reset_needs_stop", out.fault_reset_needs_stop);
  reader.read("local_from", out.local_from);
  reader.read("local_until", out.local_until);
  reader.read("reset_edge_time", out.reset_edge_time);
  reader.read("no_generic_error_bit", out.no_generic_error_bit);
  reader.read("emergency_chatter", out.emergency_chatter);
  reader.read("passive_when_alone", out.passive_when_alone);
  reader.read("mode_change_time", out.mode_change_time);
  reader.read("mode_shown_at_start", out.mode_shown_at_start, -128, 127);
  reader.read("sync_needed", out.sync_needed);
  reader.read("quick_stop_flashes", out.quick_stop_flashes);
  reader.read("master_lost_holds", out.master_lost_holds);
  reader.read("needs_power_cycle_to_save", out.needs_power_cycle_to_save);
  reader.read("shows_no_state", out.shows_no_state);
  if (!reader.has("mode_faults")) return;
  out.mode_faults.clear();
  for (const YAML::Node& item : reader.node("mode_faults")) {
    if (item.IsSequence() && item.size() == 2) {
      out.mode_faults.emplace_back(item[0].as<std::int64_t>(0), item[1].as<std::int64_t>(0));
    } else {
      reader.problem("mode_faults", "must be a list of pairs of modes like [3, 8]");
    }
  }
}

}  // namespace cia402::sim
