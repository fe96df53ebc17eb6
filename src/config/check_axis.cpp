// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/text.h"
#include "config/pdo_planner.h"
#include "config/robot_parts.h"
#include "drive/profile/conversion.h"
#include "drive/profile/named_write.h"
#include "drive/profile/outputs.h"

namespace cia402::config {
namespace {

using canopen::PdoDirection;
using drive::AxisConfig;
using drive::AxisGeometry;
using drive::Conversion;
using drive::DriveProfile;
using drive::ModeSpec;
using drive::Quantity;
using drive::UnitSpec;
using Base = UnitSpec::Base;

bool counts(const DriveProfile& profile, Quantity quantity, Base base) {
  const auto unit = profile.units.find(quantity);
  return unit != profile.units.end() && unit->second.base == base;
}

void checkGeometry(yaml::Section& section, const AxisConfig& axis) {
  const bool needs_counts = counts(*axis.profile, Quantity::position, Base::count) ||
                            counts(*axis.profile, Quantity::velocity, Base::count);
  if (needs_counts && !section.has("counts_per_turn")) {
    section.problem("`counts_per_turn` is missing: the drive's position counts per motor turn");
  }
  const bool prismatic = axis.geometry.prismatic();
  if (prismatic && !section.has("lead")) {
    section.problem("`lead` is missing: metres per screw turn of a prismatic axis");
  }
  if (!prismatic && section.has("lead")) {
    section.get("lead")->problem("is for prismatic axes; write `type: prismatic` or leave it out");
  }
}

bool maps(const canopen::PdoSet& set, PdoDirection direction, const std::string& object) {
  return std::any_of(set.pdos.begin(), set.pdos.end(), [&](const canopen::PdoLayout& pdo) {
    return pdo.direction == direction &&
           std::find(pdo.objects.begin(), pdo.objects.end(), object) != pdo.objects.end();
  });
}

std::vector<std::string> startModes(const DriveProfile& profile) {
  std::vector<std::string> names;
  for (const ModeSpec& mode : profile.modes) {
    if (mode.kind != drive::ControlKind::homing) names.push_back(mode.name);
  }
  return names;
}

void checkMode(yaml::Section& section, const AxisDraft& draft) {
  const AxisConfig& axis = draft.axis;
  const auto at = section.get("mode").value_or(section.value());
  const ModeSpec* mode = axis.profile->mode(axis.mode);
  if (mode == nullptr || mode->kind == drive::ControlKind::homing) {
    at.problem("profile " + axis.profile->name + " has no mode `" + axis.mode + "` to start in" +
               yaml::suggestion(axis.mode, startModes(*axis.profile)));
    return;
  }
  if (!maps(draft.pdos(), PdoDirection::rpdo, mode->target)) {
    at.problem("mode `" + axis.mode + "` needs `" + mode->target +
               "` in an RPDO; add it to `pdos`, or choose a mode whose target is mapped");
  }
  for (const std::string& name : section.has("modes") ? axis.modes : std::vector<std::string>()) {
    const ModeSpec* other = axis.profile->mode(name);
    if (other == nullptr || other->target.empty()) continue;
    if (maps(draft.pdos(), PdoDirection::rpdo, other->target)) continue;
    section.get("modes")->problem("mode `" + name + "` needs `" + other->target +
                                  "` in an RPDO; add it to `pdos`, or leave the mode out");
  }
  if (mode->kind == drive::ControlKind::torque && axis.geometry.rated_torque <= 0.0 &&
      counts(*axis.profile, Quantity::torque, Base::per_mille_of_rated)) {
    at.problem("mode `" + axis.mode + "` needs `rated_torque` (N m at the motor shaft)");
  }
}

void checkCyclicObjects(yaml::Section& section, const canopen::PdoSet& pdos) {
  const auto at = section.get("pdos").value_or(section.value());
  const auto need = [&](PdoDirection direction, const char* object, const char* kind) {
    if (!maps(pdos, direction, object)) {
      at.problem("`" + std::string(object) + "` must be in " + kind + ": the axis needs it in " +
                 "every cycle");
    }
  };
  need(PdoDirection::rpdo, "controlword", "an RPDO");
  need(PdoDirection::tpdo, "statusword", "a TPDO");
  need(PdoDirection::tpdo, "position_actual", "a TPDO");
}

// What an RPDO carries is sent in every cycle, over whatever an SDO wrote: a torque limit that
// nobody sets would be 0 and drop the load. So the node learns what the drive holds, where PDOs
// are.
void checkRpdoObjects(yaml::Section& section, const AxisDraft& draft) {
  if (!draft.pdos().by_sdo) return;
  const auto at = section.get("pdos").value_or(section.value());
  for (const canopen::PdoLayout& pdo : draft.pdos().pdos) {
    if (pdo.direction != PdoDirection::rpdo) continue;
    for (const std::string& object : pdo.objects) {
      const DriveProfile& profile = *draft.axis.profile;
      if (const auto type = profile.find(object)->transmission) {
        at.problem(
            "`" + object + "` must come in an RPDO of transmission type " + std::to_string(*type) +
            " (its `transmission` in " + drive::sourceOf(profile) +
            "), which `pdos: none` does not have: give the axis PDOs, or `modes` without it");
      }
      if (drive::isSetByAxis(profile, object) || drive::isSetByPeople(profile, object)) continue;
      at.problem("`" + object +
                 "` would be sent as 0 in every cycle, as nothing sets it: take it " +
                 "out of the RPDO; `write` sets it by SDO when the drive boots");
    }
  }
}

// Set-points are only slowed down by limits that are there.
void warnOfMissingLimits(yaml::Section& section, const AxisConfig& axis, RobotConfig& robot) {
  const bool velocity = axis.limits.velocity.has_value();
  if (velocity && axis.limits.acceleration) return;
  robot.warnings.push_back(section.value().path() + "/limits: no " +
                           (velocity ? "acceleration" : "velocity") +
                           " limit: the axis follows set-points however fast they are");
}

/// By an edge of a bit instead of homing mode.
bool homedByEdge(const AxisConfig& axis) {
  const auto& methods = axis.profile->homing.methods;
  const auto method = methods.find(axis.homing->method);
  return method != methods.end() && method->second.edge.has_value();
}

/// Not refused: where a drive counts its homing speeds in a unit of its own, that is how they are
/// given.
void warnOfHomingSpeeds(yaml::Section& homing, const AxisConfig& axis, RobotConfig& robot) {
  const std::optional<double>& limit = axis.limits.velocity;
  const auto warn = [&](const char* key, double value) {
    if (!limit || value <= *limit) return;
    robot.warnings.push_back(homing.get(key)->path() + ": " + numberText(value) +
                             " is beyond `limits/velocity` " + numberText(*limit) +
                             ": the drive searches faster than the joint may move else");
  };
  warn("search_velocity", axis.homing->search_velocity);
  warn("zero_velocity", axis.homing->zero_velocity);
}

void checkHoming(yaml::Section& section, const AxisConfig& axis, RobotConfig& robot) {
  if (!axis.homing) return;
  const drive::HomingSpec& spec = axis.profile->homing;
  const auto homing = *section.get("homing");
  yaml::Section homing_section(homing);
  warnOfHomingSpeeds(homing_section, axis, robot);
  const auto method = homing_section.get("method");
  const bool by_driver = spec.methods.count(std::nullopt) != 0;
  const bool by_drive = spec.methods.size() > (by_driver ? 1 : 0);
  if (spec.methods.empty()) {
    homing.problem("profile " + axis.profile->name + " has no homing; remove the section");
  } else if (!by_drive && method) {
    method->problem(
        "this drive has no homing methods: the present position is declared to be "
        "`offset`; remove the method");
  } else if (!by_driver && !method) {
    homing.problem("`method` is missing: the number of a homing method of the drive");
  } else if (axis.homing->method && method && spec.methods.count(*axis.homing->method) == 0) {
    std::string known;
    for (const auto& entry : spec.methods) {
      if (entry.first) append(known, std::to_string(*entry.first), ", ");
    }
    method->problem("profile " + axis.profile->name + " has no method " +
                    std::to_string(*axis.homing->method) + "; it has " + known);
  }
  for (const drive::NamedWrite& write : spec.writes) {
    const std::string key = write.from.substr(write.from.find('.') + 1);
    // The method is known beside, and the driver counts an offset itself.
    if (key == "method" || key == "offset" || !homing_section.has(key)) continue;
    if (!drive::saidToLack(axis, write.object)) continue;
    homing_section.get(key)->problem("`lacks` says that the drive has no `" + write.object +
                                     "` to take it; remove one of the two");
  }
  if (axis.homing->kept_by_drive && !axis.profile->homed_bit) {
    homing_section.get("kept_by_drive")
        ->problem("profile " + axis.profile->name +
                  " has no bit by which its drives say that they know their home (`homed_bit`)");
  } else if (axis.homing->kept_by_drive && homedByEdge(axis)) {
    homing_section.get("kept_by_drive")
        ->problem("method " + std::to_string(*axis.homing->method) +
                  " is no homing of the drive, which does not know its home by it");
  }
  const double offset = axis.homing->atHome();
  if ((axis.limits.lower && offset < *axis.limits.lower) ||
      (axis.limits.upper && offset > *axis.limits.upper)) {
    robot.warnings.push_back(homing.path() +
                             "/offset lies outside the axis' limits: after homing "
                             "the axis will stand where it may not be");
  }
}

// Positions beyond what the object holds would wrap around.
void checkRange(yaml::Section& section, const AxisConfig& axis) {
  for (const char* name : {"position_actual", "target_position"}) {
    const drive::ObjectSpec* object = axis.profile->find(name);
    if (object == nullptr) continue;
    const auto conversion = Conversion::create(*object, *axis.profile, axis.geometry);
    if (!conversion) continue;  // told by checkGeometry() already
    const bool low = axis.limits.lower && *axis.limits.lower < conversion->lowest();
    const bool high = axis.limits.upper && *axis.limits.upper > conversion->highest();
    if (!low && !high) continue;
    section.get("limits")->problem("`" + std::string(name) + "` holds " +
                                   std::to_string(conversion->lowest()) + " to " +
                                   std::to_string(conversion->highest()) +
                                   " and would wrap around inside these limits; reduce "
                                   "counts_per_turn or the limits");
    return;
  }
}

// What cannot be had is told, not replaced.
void checkQuickStop(yaml::Section& section, const AxisConfig& axis) {
  if (!axis.quick_stop_holds) return;
  const auto at = section.get("quick_stop").value_or(section.value());
  const auto chooses = [](const std::vector<drive::NamedWrite>& writes) {
    return std::any_of(writes.begin(), writes.end(), [](const drive::NamedWrite& write) {
      return write.from == "quick_stop.hold";
    });
  };
  const DriveProfile& profile = *axis.profile;
  const bool chosen = chooses(profile.startup) || chooses(profile.before_enable);
  if (profile.quick_stop_holds.empty() || !chosen) {
    at.problem("profile " + profile.name +
               " does not say how its drives hold after a quick stop (`quick_stop_holds`, and a "
               "write `from: quick_stop.hold`); write `disable` or leave it out");
    return;
  }
  const drive::ObjectSpec* option = profile.find(profile.own({0x605A, 0}));
  if (axis.description == nullptr || option == nullptr) return;
  if (axis.description->dictionary.find(option->id) != nullptr) return;
  at.problem("the drive cannot hold after a quick stop: " + axis.description->file + " has no " +
             fieldbus::toString(option->id) + "; write `disable` or leave it out");
}

void checkWrites(yaml::Section& section, const AxisConfig& axis) {
  const auto check = [&](const std::vector<drive::NamedWrite>& writes, const yaml::Value& at) {
    for (const drive::NamedWrite& write : writes) {
      const auto resolved = drive::resolveWrite(write, axis);
      if (!resolved) at.problem(resolved.error().message);
    }
  };
  if (axis.quick_stop_holds && axis.profile->quick_stop_holds.empty()) return;  // told already
  check(axis.profile->startup, section.get("limits").value_or(section.value()));
  check(axis.writes, section.get("write").value_or(section.value()));
  const ModeSpec* mode = axis.profile->mode(axis.mode);
  if (mode != nullptr) check(mode->entry_writes, section.get("limits").value_or(section.value()));
  if (axis.homing) check(axis.profile->homing.writes, *section.get("homing"));
}

}  // namespace

void checkAxis(yaml::Section& section, const AxisDraft& draft, RobotConfig& robot) {
  const AxisConfig& axis = draft.axis;
  checkGeometry(section, axis);
  checkMode(section, draft);
  const bool planned =
      !draft.pdos().pdos.empty() || section.has("pdos");  // else checkMode() has told why
  if (planned) checkCyclicObjects(section, draft.pdos());
  checkRpdoObjects(section, draft);
  warnOfMissingLimits(section, axis, robot);
  checkHoming(section, axis, robot);
  checkQuickStop(section, axis);
  checkRange(section, axis);
  const bool geometry_known = !counts(*axis.profile, Quantity::position, Base::count) ||
                              axis.geometry.counts_per_turn > 0.0;
  const bool lead_known =
      axis.geometry.type != AxisGeometry::Type::prismatic || axis.geometry.lead > 0.0;
  if (geometry_known && lead_known) checkWrites(section, axis);
  if (axis.limits.effort && axis.geometry.rated_torque <= 0.0 &&
      counts(*axis.profile, Quantity::torque, Base::per_mille_of_rated)) {
    robot.warnings.push_back(section.value().path() +
                             "/limits/effort is not sent to the drive, which counts in 1/1000 of "
                             "its rated torque; give `rated_torque`");
  }
}

}  // namespace cia402::config
