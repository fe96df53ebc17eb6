// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Which objects of an axis travel by PDO.
#include <algorithm>
#include <iterator>

#include "config/pdo_planner.h"
#include "config/profile/parts.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

using canopen::DeviceConfig;
using drive::AxisConfig;

constexpr Duration kFresh = std::chrono::milliseconds(10);  // age of velocities, or one joint_state
constexpr Duration kLeastRpdoTimeout = std::chrono::milliseconds(100);
constexpr int kRpdoTimeoutCycles = 10;
/// What is shown of an axis beside what it needs; most important first.
const char* const kFeedback[] = {"velocity_actual", "torque_actual", "error_code", "digital_inputs",
                                 "following_error"};

std::vector<std::string> allModes(const DriveProfile& profile) {
  std::vector<std::string> names;
  for (const ModeSpec& mode : profile.modes) names.push_back(mode.name);
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> feedbackOf(const DriveProfile& profile) {
  if (!profile.feedback.empty()) return profile.feedback;
  return {std::begin(kFeedback), std::end(kFeedback)};
}

/// Does the drive's own description say that an object is not there, or in no PDO?
bool ruledOut(const AxisConfig& axis, const std::string& name) {
  if (contains(axis.lacks, name)) return true;
  const drive::ObjectSpec* object = axis.profile->find(name);
  if (axis.description == nullptr || object == nullptr) return false;
  const fieldbus::DictionaryEntry* entry = axis.description->dictionary.find(object->id);
  return entry == nullptr || !entry->mappable;
}

template <class Unwanted>
void leaveOut(std::vector<std::string>& names, const Unwanted& unwanted) {
  names.erase(std::remove_if(names.begin(), names.end(), unwanted), names.end());
}

Duration freshness(const RobotConfig& robot) {
  return std::min(kFresh, fromSeconds(1.0 / robot.joint_state_rate));
}

/// What is in the plan though nobody asked for it: default feedback, and the targets of default
/// modes but that of the mode to start in.
std::vector<std::string> defaultObjects(const AxisDraft& draft, const PdoNeeds& needs) {
  const AxisConfig& axis = draft.axis;
  std::vector<std::string> names;
  if (!needs.feedback_required) names = needs.feedback;
  const std::vector<std::string>& riders = draft.pdos().riders;
  names.insert(names.end(), riders.begin(), riders.end());
  names.emplace_back("mode_of_operation");
  if (needs.modes_required) return names;
  const ModeSpec* start = axis.profile->mode(needs.mode);
  for (const std::string& name : axis.modes) {
    const ModeSpec* mode = axis.profile->mode(name);
    if (mode == nullptr || mode->target.empty() || mode->target == start->target) continue;
    names.push_back(mode->target);
  }
  return names;
}

/// What brakes in a mode, that to start in included, is planned with it.
void addStopModes(const AxisConfig& axis, std::vector<std::string>& names) {
  std::vector<std::string> pushing = names;
  pushing.push_back(axis.mode);
  for (const std::string& name : pushing) {
    const ModeSpec* mode = axis.profile->mode(name);
    if (mode == nullptr || mode->stop_mode.empty()) continue;
    const bool there = std::find(names.begin(), names.end(), mode->stop_mode) != names.end();
    if (!there) names.push_back(mode->stop_mode);
  }
}

/// What the PDOs bring to the drive in every cycle.
void setOutputs(AxisConfig& axis, const canopen::PdoSet& set) {
  axis.outputs.clear();
  for (const canopen::PdoLayout& pdo : set.pdos) {
    if (pdo.direction != canopen::PdoDirection::rpdo) continue;
    for (const std::string& name : pdo.objects) {
      const ObjectSpec* object = drive::findObject(*axis.profile, name);
      if (object != nullptr) axis.outputs.push_back(object->name);
    }
  }
}

/// Where all axes of a device have the same PDOs, each gets its part of them.
PdoNeeds::Share shareOf(const DeviceConfig& device, unsigned device_axis, unsigned axes,
                        canopen::PdoDirection direction) {
  PdoNeeds::Share share;
  const canopen::DeviceProfile& family = *device.profile;
  if (family.pdos_per_axis != 0 || axes < 2) return share;
  unsigned planned = 0;
  for (unsigned other = 0; other < device.axes.size(); ++other) {
    if (other == device_axis || device.axes[other].pdos.empty()) continue;
    ++planned;
    for (const canopen::PdoLayout& pdo : device.axes[other].pdos) {
      if (pdo.direction == direction) share.taken.push_back(pdo.number);
    }
  }
  const std::size_t all =
      direction == canopen::PdoDirection::rpdo ? family.max_rpdos : family.max_tpdos;
  const std::size_t left = all - std::min(all, share.taken.size());
  share.most = left / (axes - std::min(planned, axes - 1));
  return share;
}

void setShares(PdoNeeds& needs, const DeviceConfig& device, unsigned device_axis, unsigned axes) {
  needs.rpdos = shareOf(device, device_axis, axes, canopen::PdoDirection::rpdo);
  needs.tpdos = shareOf(device, device_axis, axes, canopen::PdoDirection::tpdo);
}

bool plan(yaml::Section& section, AxisDraft& draft, RobotConfig& robot, PdoNeeds needs) {
  AxisConfig& axis = draft.axis;
  const DriveProfile& profile = *axis.profile;
  const auto modes = section.get("modes");
  needs.mode = axis.mode;
  needs.cycle = axis.cycle;
  needs.feed_forward = axis.feed_forward;
  needs.fresh = freshness(robot);
  const Result<PdoPlan> planned = planPdos(profile, *draft.device.profile, needs);
  if (!planned) {
    const auto at = modes ? *modes : section.get("mode").value_or(section.value());
    at.problem("profile " + profile.name + ": " + planned.error().message);
    return false;
  }
  if (const auto feedback = section.get("feedback")) {
    for (const std::string& name : planned->by_sdo) {
      robot.warnings.push_back(feedback->path() + ": `" + name +
                               "` finds no room in the TPDOs and is read by SDO, which is slow");
    }
  }
  draft.pdos().pdos = planned->pdos;
  draft.pdos().planned = true;
  axis.modes = planned->modes;
  draft.pdos().riders = planned->riders;
  draft.pdos().default_objects = defaultObjects(draft, needs);
  for (const std::string& name : planned->modes) {
    const std::vector<std::string>& mapped = profile.mode(name)->mapped;
    auto& defaults = draft.pdos().default_objects;
    defaults.insert(defaults.end(), mapped.begin(), mapped.end());
  }
  return true;
}

/// Objects that an axis cannot do without.
const char* const kNeeded[] = {"controlword", "statusword", "position_actual"};

void readLacks(yaml::Section& section, AxisConfig& axis) {
  const auto lacks = section.get("lacks");
  if (!lacks) return;
  for (const yaml::Value& entry : lacks->list()) {
    const auto name = entry.text();
    if (!name) continue;
    const drive::ObjectSpec* object = drive::findObject(*axis.profile, *name);
    const bool needed =
        std::find(std::begin(kNeeded), std::end(kNeeded), *name) != std::end(kNeeded);
    if (object == nullptr) {
      entry.problem("profile " + axis.profile->name + " has no object `" + *name + "`" +
                    yaml::suggestion(*name, drive::objectNames(*axis.profile)));
    } else if (needed) {
      entry.problem("no axis can do without `" + *name + "`");
    } else {
      axis.lacks.push_back(object->name);
    }
  }
}

void readRpdoTimeout(yaml::Section& section, DeviceConfig& device, Duration cycle) {
  if (device.profile->rpdo_deadline) {
    device.rpdo_timeout = std::max(kLeastRpdoTimeout, kRpdoTimeoutCycles * cycle);
  }
  double timeout = toSeconds(device.rpdo_timeout);
  if (!section.read("rpdo_timeout", timeout, yaml::Range{0.0, 65.535, false})) return;
  device.rpdo_timeout = fromSeconds(timeout);
  if (timeout > 0.0 && device.rpdo_timeout < 2 * cycle) {
    section.get("rpdo_timeout")
        ->problem("must be 0 (none) or at least two cycles, " +
                  std::to_string(2.0 * toSeconds(cycle)) + " s");
  } else if (device.rpdo_timeout % std::chrono::milliseconds(1) != Duration(0)) {
    section.get("rpdo_timeout")
        ->problem("must be a whole number of milliseconds, as 1400h:05 counts in them");
  }
}

/// The drive's own deadline stands on the RPDO that carries the controlword in every cycle.
void setRpdoTimeout(canopen::PdoSet& set, Duration timeout) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(timeout).count();
  for (canopen::PdoLayout& pdo : set.pdos) {
    const auto& objects = pdo.objects;
    const bool commands = std::find(objects.begin(), objects.end(), "controlword") != objects.end();
    if (pdo.direction != canopen::PdoDirection::rpdo || !commands || pdo.event_timer != 0) continue;
    pdo.event_timer = static_cast<std::uint16_t>(ms);
    return;
  }
}

/// `pdos: none`: what is planned for PDOs goes by SDO.
void readNoPdos(const yaml::Value& value, AxisDraft& draft, unsigned axes) {
  if (!value.oneOf({"none"})) return;
  draft.pdos().by_sdo = true;
  if (axes > 1) value.problem("a drive of several axes is not served without PDOs");
}

/// @param needs with the numbers that other axes of the device have
void checkShared(const yaml::Value& at, const AxisDraft& draft, const PdoNeeds& needs) {
  for (const canopen::PdoLayout& pdo : draft.pdos().pdos) {
    const bool rpdo = pdo.direction == canopen::PdoDirection::rpdo;
    const std::vector<unsigned>& taken = rpdo ? needs.rpdos.taken : needs.tpdos.taken;
    if (std::find(taken.begin(), taken.end(), pdo.number) == taken.end()) continue;
    at.problem(std::string(rpdo ? "rpdo" : "tpdo") + std::to_string(pdo.number) +
               " carries objects of another axis of this drive already: its axes share their PDOs");
  }
}

}  // namespace

bool choosePdos(yaml::Section& section, AxisDraft& draft, RobotConfig& robot, unsigned axes) {
  AxisConfig& axis = draft.axis;
  DeviceConfig& device = draft.device;
  auto pdos = section.get("pdos");
  if (pdos && pdos->isScalar()) {
    readNoPdos(*pdos, draft, axes);
    pdos.reset();
  }
  const auto modes = section.get("modes");
  const auto feedback = section.get("feedback");
  if (draft.first) section.readInteger("stale_after", device.stale_after, 1, 1000);
  if (!axis.profile || !device.profile) {
    for (const char* key : {"lacks", "rpdo_timeout"}) section.get(key);
    return false;
  }
  const DriveProfile& profile = *axis.profile;
  readLacks(section, axis);
  if (draft.first) readRpdoTimeout(section, device, axis.cycle);
  PdoNeeds needs;
  setShares(needs, device, axis.device_axis, axes);
  needs.modes_required = modes.has_value();
  needs.modes = modes ? readModeNames(*modes, profile) : profile.default_modes;
  if (!modes && needs.modes.empty()) needs.modes = allModes(profile);
  addStopModes(axis, needs.modes);
  needs.feedback_required = feedback.has_value();
  needs.feedback = feedback ? readFeedbackNames(*feedback, profile) : feedbackOf(profile);
  if (!feedback) needs.if_room = profile.feedback_if_room;
  const auto ruled_out = [&](const std::string& name) { return ruledOut(axis, name); };
  const auto unreachable = [&](const std::string& name) {
    const ModeSpec* mode = profile.mode(name);
    return mode != nullptr && ruledOut(axis, mode->target);
  };
  if (!feedback) leaveOut(needs.feedback, ruled_out);
  leaveOut(needs.if_room, ruled_out);
  if (!modes) leaveOut(needs.modes, unreachable);
  if (pdos && feedback) feedback->problem("says nothing beside `pdos`: keep one of them");
  const bool shared = device.profile->pdos_per_axis == 0;  // the profile's PDOs are axis 0's then
  const bool given = !device.profile->pdos.empty() && (axis.device_axis == 0 || !shared);
  if (!pdos && feedback && given) {
    feedback->problem("says nothing here: profile " + profile.name +
                      " has PDOs of its own; give the axis `pdos` instead");
  }
  if (pdos || given) {
    draft.pdos().pdos = pdos ? readPdos(*pdos, profile, *device.profile) : device.profile->pdos;
    axis.modes = needs.modes;
    if (shared && pdos) checkShared(*pdos, draft, needs);
  } else {
    const ModeSpec* start = profile.mode(axis.mode);
    const bool known =
        std::all_of(needs.modes.begin(), needs.modes.end(),
                    [&](const std::string& m) { return profile.mode(m) != nullptr; });
    if (start == nullptr || start->kind == drive::ControlKind::homing) {
      return true;  // checkMode() tells
    }
    if (!known || !plan(section, draft, robot, needs)) return false;
  }
  setRpdoTimeout(draft.pdos(), device.rpdo_timeout);
  setOutputs(axis, draft.pdos());
  return true;
}

namespace {

/// What `axis` was planned for, but for what travels only because there was room; its objects are
/// those that found room.
PdoNeeds needsOf(const AxisConfig& axis, const RobotConfig& robot) {
  const canopen::PdoSet& set = robot.pdosOf(axis);
  PdoNeeds needs;
  needs.mode = axis.mode;
  needs.modes = axis.modes;
  for (const canopen::PdoLayout& pdo : set.pdos) {
    if (pdo.direction != canopen::PdoDirection::tpdo) continue;
    std::copy_if(pdo.objects.begin(), pdo.objects.end(), std::back_inserter(needs.feedback),
                 [&](const std::string& name) { return !contains(set.riders, name); });
  }
  needs.cycle = axis.cycle;
  needs.fresh = freshness(robot);
  return needs;
}

/// Another plan finds room where this one did: of the device's PDOs it gets no more.
void plan(AxisConfig& axis, RobotConfig& robot) {
  const DeviceConfig& device = robot.deviceOf(axis);
  canopen::PdoSet& set = robot.pdosOf(axis);
  PdoNeeds needs = needsOf(axis, robot);
  const auto axes = static_cast<unsigned>(
      std::count_if(robot.axes.begin(), robot.axes.end(),
                    [&](const AxisConfig& other) { return other.device == axis.device; }));
  setShares(needs, device, axis.device_axis, axes);
  const Result<PdoPlan> planned = planPdos(*axis.profile, *device.profile, needs);
  if (!planned) return;
  set.pdos = planned->pdos;
  set.riders = planned->riders;
  setRpdoTimeout(set, device.rpdo_timeout);
  setOutputs(axis, set);
}

}  // namespace

void planAgain(RobotConfig& robot, Duration cycle) {
  robot.bus.sync_period = cycle;
  for (AxisConfig& axis : robot.axes) {
    axis.cycle = cycle;
    if (robot.pdosOf(axis).planned) plan(axis, robot);
  }
}

void leaveRiders(RobotConfig& robot) {
  for (AxisConfig& axis : robot.axes) {
    if (!robot.pdosOf(axis).riders.empty()) plan(axis, robot);
  }
}

}  // namespace cia402::config
