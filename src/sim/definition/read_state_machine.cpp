// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_state_machine.h"

#include "fieldbus/object.h"
#include "yaml/reader.h"

namespace cia402::sim {
namespace {

const std::vector<std::pair<const char*, RangeUse>> kRangeUses = {
    {"none", RangeUse::none}, {"farther", RangeUse::farther}, {"greater", RangeUse::greater}};
const std::vector<std::pair<const char*, ConnectionLoss>> kConnectionLoss = {
    {"none", ConnectionLoss::none},
    {"fault", ConnectionLoss::fault},
    {"disable_voltage", ConnectionLoss::disable_voltage},
    {"quick_stop", ConnectionLoss::quick_stop}};
void readOptionTable(DefinitionReader& parent, const std::string& key, OptionTable& out) {
  parent.section(key, [&](DefinitionReader& reader) {
    out.options.clear();
    reader.read("default", out.fallback, -32768, 32767);
    reader.each("values", [&](const std::string& number, const yaml::Value& entry) {
      DefinitionReader row(entry);
      StopOption option;
      const auto value = yaml::parseInteger(number);
      if (!value) reader.problem("values", "'" + number + "' is no option code");
      row.read("ramp", option.ramp, rampWords());
      row.read("hold", option.hold);
      out.options[value.value_or(0)] = option;
    });
  });
}

void readSupervision(DefinitionReader& reader, DriveDefinition& out) {
  if (reader.has("homed_bit")) {
    std::int64_t bit = 15;
    reader.read("homed_bit", bit, 0, 15);
    out.homed_bit = static_cast<std::uint16_t>(1U << bit);
  }
  if (reader.has("sync_tolerances")) out.sync_tolerances.clear();
  reader.list("sync_tolerances", [&](const yaml::Value& item) {
    out.sync_tolerances.push_back(item.number({0.0, 10.0, false}).value_or(0.0));
  });
  reader.read("position_range", out.range_use, kRangeUses);
  if (reader.has("position_limits")) out.limit_uses.clear();
  reader.list("position_limits", [&](const yaml::Value& item) {
    const auto index = item.oneOf({"off", "on", "homed"});
    out.limit_uses.push_back(static_cast<LimitUse>(index.value_or(1)));
  });
}

}  // namespace

const std::vector<std::pair<const char*, Ramp>>& rampWords() {
  static const std::vector<std::pair<const char*, Ramp>> kRamps = {
      {"coast", Ramp::coast},
      {"dynamic_brake", Ramp::dynamic_brake},
      {"slow_down", Ramp::slow_down},
      {"quick_stop", Ramp::quick_stop},
      {"limit", Ramp::limit}};
  return kRamps;
}

// CiA 402-2, tables of 605Ah to 605Eh.
void applyStandardOptions(DriveDefinition& out) {
  const StopOption coast{Ramp::coast, false};
  const StopOption slow{Ramp::slow_down, false};
  const StopOption quick{Ramp::quick_stop, false};
  const StopOption limit{Ramp::limit, false};
  out.quick_stop = {2,
                    {{0, coast},
                     {1, slow},
                     {2, quick},
                     {3, limit},
                     {4, limit},
                     {5, {Ramp::slow_down, true}},
                     {6, {Ramp::quick_stop, true}},
                     {7, {Ramp::limit, true}},
                     {8, {Ramp::limit, true}}}};
  out.shutdown = {0, {{0, coast}, {1, slow}}};
  out.disable_operation = {1, {{0, coast}, {1, slow}}};
  out.halt_option = {1, {{1, slow}, {2, quick}, {3, limit}, {4, limit}}};
  out.fault_reaction = {2, {{0, coast}, {1, slow}, {2, quick}, {3, limit}, {4, limit}}};
}

void readStateMachine(DefinitionReader& reader, DriveDefinition& out) {
  reader.read("initialisation", out.initialisation);
  reader.read("enable_in_one_step", out.enable_in_one_step);
  reader.read("direct_enable", out.direct_enable);
  reader.read("stores_while_enabled", out.stores_while_enabled);
  reader.read("mode_change_while_enabled", out.mode_change_while_enabled);
  reader.read("resume_quick_stop_while_moving", out.resume_quick_stop_while_moving);
  reader.read("halt", out.halt);
  reader.read("internal_limit_bit", out.internal_limit_bit);
  reader.read("warning_stops", out.warning_stops);
  reader.read("enables_below", out.enables_below, 0.0, 1e3);
  reader.read("following_error_is_fault", out.following_error_is_fault);
  reader.read("limit_switch_is_fault", out.limit_switch_is_fault);
  reader.read("position_step", out.position_step, 0.0, 1e6);
  reader.read("master_lost", out.master_lost, kConnectionLoss);
  reader.read("stops_outside_operational", out.stops_outside_operational);
  reader.read("interpolates_over_sync_period", out.follows_sync_period);
  reader.read("edges_while_enabling", out.edges_while_enabling);
  reader.read("brake_loses_commands", out.brake_loses_commands);
  reader.read("ramps_of_mode", out.ramps_of_mode);
  reader.read("locked_ramp_holds_stops", out.locked_ramp_holds_stops);
  readSupervision(reader, out);
  readOptionTable(reader, "quick_stop", out.quick_stop);
  readOptionTable(reader, "shutdown", out.shutdown);
  readOptionTable(reader, "disable_operation", out.disable_operation);
  readOptionTable(reader, "halt_option", out.halt_option);
  readOptionTable(reader, "fault_reaction", out.fault_reaction);
  if (!reader.has("locked_while_enabled")) return;
  out.locked_while_enabled.clear();
  for (const YAML::Node& item : reader.node("locked_while_enabled")) {
    const auto object = item.IsScalar() ? fieldbus::parseObjectId(item.Scalar()) : std::nullopt;
    if (object)
      out.locked_while_enabled.push_back(*object);
    else
      reader.problem("locked_while_enabled", "must be a list of objects like \"6083:00\"");
  }
}

}  // namespace cia402::sim
