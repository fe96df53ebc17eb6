// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "common/text.h"
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

void readValue(yaml::Section& section, const DriveProfile& profile, ModeSpec& mode) {
  if (!section.require("value", "the number that mode_of_operation (6060h) takes")) return;
  const ObjectSpec* object = profile.find("mode_of_operation");
  const DataType type = object != nullptr ? object->type : DataType::int8;
  if (fieldbus::sizeBits(type) != 0) {
    section.readInteger("value", mode.value, lowestOf(type), highestOf(type));
  }
}

void readStatusBits(yaml::Section& mode_section, ModeSpec& mode) {
  const auto value = mode_section.get("status_bits");
  if (!value) return;
  yaml::Section section(*value);
  section.readInteger("target_reached", mode.target_reached_bit, 0, 15);
  section.readInteger("following_error", mode.following_error_bit, 0, 15);
  section.readInteger("set_point_acknowledge", mode.set_point_acknowledge_bit, 0, 15);
  section.readInteger("speed_zero", mode.speed_zero_bit, 0, 15);
  section.readInteger("homing_attained", mode.homing_attained_bit, 0, 15);
  section.readInteger("homing_error", mode.homing_error_bit, 0, 15);
  section.readInteger("follows_command", mode.follows_command_bit, 0, 15);
  section.finish();
}

void readLoop(yaml::Section& section, ModeSpec& mode) {
  const auto value = section.get("position_loop");
  if (!value) return;
  mode.position_loop = readPositionLoop(*value, {});
  if (mode.position_loop->gain <= 0.0) {
    yaml::Section(*value).require("gain", "1/s: of the distance to the set-point, as a velocity");
  }
  if (mode.kind != ControlKind::position || !mode.cyclic) {
    value->problem(
        "closes the loop of a stream of positions: it goes with `control: position` "
        "and `cyclic: true`");
    mode.position_loop.reset();
  }
}

/// Its speed travels as the objects of `mapped` do.
void readStream(yaml::Section& section, const DriveProfile& profile, ModeSpec& mode) {
  const auto value = section.get("set_point_stream");
  if (!value) return;
  drive::SetPointStream stream = readSetPointStream(*value, {}, &profile);
  if (mode.kind != ControlKind::position || !mode.cyclic || mode.position_loop) {
    value->problem(
        "leads the drive along a stream of positions: it goes with `control: position` and "
        "`cyclic: true`, without `position_loop`");
    return;
  }
  if (stream.speed.empty()) return;  // told
  mode.mapped.push_back(stream.speed);
  if (!stream.deceleration.empty()) mode.mapped.push_back(stream.deceleration);
  mode.set_point_stream = std::move(stream);
}

void readTarget(yaml::Section& section, const DriveProfile& profile, ModeSpec& mode) {
  const Quantity quantity =
      mode.position_loop ? Quantity::velocity : drive::targetQuantity(mode.kind);
  if (quantity == Quantity::none) {
    const std::string word = drive::controlKindWords()[static_cast<std::size_t>(mode.kind)];
    if (section.has("target")) section.problem(word + " has no target");
    return;
  }
  const auto value = section.require("target", "the object that takes the mode's set-points");
  const auto text = value ? value->text() : std::nullopt;
  if (!text) return;
  mode.target = *text;
  const ObjectSpec* object = profile.find(*text);
  if (object == nullptr) {
    value->problem("the profile has no object `" + *text + "`" +
                   yaml::suggestion(*text, drive::objectNames(profile)));
  } else if (object->quantity != quantity) {
    value->problem("`" + *text + "` does not measure what the mode " +
                   (mode.position_loop ? "commands, a velocity" : "controls") +
                   "; see its `quantity`");
  } else if (!object->rpdo) {
    value->problem("`" + *text + "` cannot be in an RPDO, so no set-point could reach the drive");
  }
}

constexpr std::int64_t kStateMachineBits = 0x008F;

void readHandoverWords(yaml::Section& section, Handover& handover) {
  const auto value =
      section.require("words", "controlword bits at rest, then those of a set-point");
  if (!value) return;
  for (const yaml::Value& entry : value->list()) {
    const auto word = entry.integer(0, 0xFFFF);
    if (!word) continue;
    if ((*word & kStateMachineBits) != 0) {
      entry.problem("must leave bits 0 to 3 and 7 to the state machine");
    }
    handover.words.push_back(static_cast<std::uint16_t>(*word));
  }
  if (handover.words.size() < 2 || handover.words.size() > 8) {
    value->problem("needs the word at rest and 1 to 7 that hand a set-point over");
    handover.words.clear();
  }
}

Handover readHandover(const yaml::Value& value, bool acknowledged) {
  if (!value.isMap()) {
    const auto index = value.oneOf({"none", "new_set_point"});
    if (index != std::size_t{1}) return {};
    if (!acknowledged) value.problem("new_set_point needs status_bits/set_point_acknowledge");
    return drive::standardHandover(acknowledged);
  }
  Handover handover;
  yaml::Section section(value);
  readHandoverWords(section, handover);
  if (acknowledged) handover.acknowledge = Handover::Acknowledge::level;
  if (const auto how = section.get("acknowledge")) {
    const auto index = how->oneOf({"none", "level", "rise"});
    if (index) handover.acknowledge = static_cast<Handover::Acknowledge>(*index);
    if (!acknowledged && handover.acknowledge != Handover::Acknowledge::none) {
      how->problem("needs status_bits/set_point_acknowledge");
    }
  }
  section.readInteger("each_for", handover.each_for, 1, 10);
  section.finish();
  return handover;
}

void readHandshake(yaml::Section& section, ModeSpec& mode) {
  const auto value = section.get("handshake");
  if (!value) return;
  mode.handover = readHandover(*value, mode.set_point_acknowledge_bit.has_value());
  if (mode.handover.words.empty()) return;
  if (mode.cyclic && !mode.set_point_stream) {
    value->problem("a cyclic mode cannot wait for an acknowledgement of each set-point");
  }
  if (mode.kind != ControlKind::position) {
    value->problem("only positions are handed over one by one (CiA 402-2, profile position mode)");
  }
}

/// What becomes of commands that the drive takes one after the other.
void readOneByOne(yaml::Section& section, const DriveProfile& profile, ModeSpec& mode) {
  Handover& handover = mode.handover;
  section.read("queued", handover.queued);
  section.read("replaces_queue", handover.replaces_queue);
  const auto from = section.get("relative_to");
  const auto index = from ? from->oneOf({"target", "demand", "position"}) : std::nullopt;
  if (index) handover.from = static_cast<Handover::From>(*index + 1);
  if (handover.replaces_queue && !handover.queued)
    section.problem("`replaces_queue` is of `queued`");
  if (!handover.oneByOne()) return;
  const bool standard =
      handover.acknowledge == Handover::Acknowledge::level && handover.words.size() == 2;
  if (handover.queued && !standard) section.problem("`queued` needs `handshake: new_set_point`");
  if (handover.acknowledge == Handover::Acknowledge::none) {
    section.problem("`relative_to` needs a `handshake` whose set-points are acknowledged");
  }
  if (((handover.words.empty() ? 0u : mode.controlword_bits) & 0x0070u) != 0) {
    section.problem("`queued` and `relative_to` leave controlword bits 4 to 6 to the handshake");
  }
  if (handover.queued && !(mode.stop == StopBy::halt || (!mode.stop && profile.halt_supported))) {
    section.problem(
        "`queued` needs a drive that is stopped by the halt bit, which empties its queue, or lets "
        "it "
        "be replaced");
  }
}

void checkSetPointStream(yaml::Section& section, const ModeSpec& mode) {
  if (!mode.set_point_stream) return;
  if (mode.handover.words.empty()) {
    section.problem("`set_point_stream` needs the `handshake` by which set-points are taken");
  }
  if (mode.handover.oneByOne()) {
    section.problem(
        "`set_point_stream` replaces one set-point by the next: leave `queued` and "
        "`relative_to` out");
  }
}

void readStop(yaml::Section& section, ModeSpec& mode) {
  const auto value = section.get("stop");
  const auto index =
      value ? value->oneOf({"set_points", "halt", "quick_stop", "mode"}) : std::nullopt;
  std::string stop_mode;
  section.read("stop_mode", stop_mode);
  mode.stop_mode = drive::canonicalModeName(stop_mode);
  if (index) mode.stop = static_cast<StopBy>(*index);
  if ((mode.stop == StopBy::mode) == stop_mode.empty()) {
    section.problem("`stop: mode` and `stop_mode`, the mode that brakes, go together");
  }
  if (mode.stop == StopBy::set_points && mode.kind == ControlKind::torque) {
    value->problem("a torque of 0 lets the axis coast; write halt, quick_stop or mode");
  }
  if (mode.stop == StopBy::mode && mode.kind != ControlKind::torque) {
    value->problem("another mode brakes torque modes only; write set_points, halt or quick_stop");
  }
}

/// Objects of `entry_writes` that travel while the mode is active.
void readMapped(const yaml::Value& list, const DriveProfile& profile, ModeSpec& mode) {
  for (const yaml::Value& entry : list.list()) {
    const auto name = entry.text();
    if (!name) continue;
    const ObjectSpec* object = profile.find(*name);
    const bool written =
        std::any_of(mode.entry_writes.begin(), mode.entry_writes.end(),
                    [&](const NamedWrite& write) { return write.object == *name; });
    if (object == nullptr || !object->rpdo || !written) {
      entry.problem("`" + *name + "` is no object of `entry_writes` that an RPDO can carry");
    } else {
      mode.mapped.push_back(*name);
    }
  }
}

/// The name of an object that is added to a demand in every cycle; empty: there is none.
void readOffset(yaml::Section& section, const char* key, Quantity quantity,
                const DriveProfile& profile, std::string& offset) {
  const auto value = section.get(key);
  const auto name = value ? value->text() : std::nullopt;
  if (!name) return;
  const ObjectSpec* object = profile.find(*name);
  if (object == nullptr || !object->rpdo || object->quantity != quantity) {
    value->problem("`" + *name + "` is no object of the profile with `quantity: " + key +
                   "` that an RPDO can carry");
  } else {
    offset = *name;
  }
}

void readOffsets(yaml::Section& mode_section, const DriveProfile& profile, ModeSpec& mode) {
  const auto value = mode_section.get("offsets");
  if (!value) return;
  yaml::Section section(*value);
  if (mode.kind == ControlKind::position) {
    readOffset(section, "velocity", Quantity::velocity, profile, mode.offsets.velocity);
  }
  readOffset(section, "torque", Quantity::torque, profile, mode.offsets.torque);
  section.finish();
  const bool led = mode.kind == ControlKind::position || mode.kind == ControlKind::velocity;
  if (!mode.cyclic || !led || mode.position_loop) {
    value->problem("goes with `cyclic: true` and `control: position` or `velocity` of the drive");
  }
}

ModeSpec readMode(const std::string& name, const yaml::Value& value, const DriveProfile& profile) {
  ModeSpec mode;
  mode.name = drive::canonicalModeName(name);
  yaml::Section section(value);
  readValue(section, profile, mode);
  std::string kinds;
  for (const std::string& word : drive::controlKindWords()) append(kinds, word, ", ");
  const auto control = section.require("control", kinds);
  const auto kind = control ? control->oneOf(drive::controlKindWords()) : std::nullopt;
  if (kind) mode.kind = static_cast<ControlKind>(*kind);
  section.read("cyclic", mode.cyclic);
  readLoop(section, mode);
  readStream(section, profile, mode);
  readTarget(section, profile, mode);
  readOffsets(section, profile, mode);
  readStatusBits(section, mode);
  readHandshake(section, mode);
  readStop(section, mode);
  section.readInteger("controlword_bits", mode.controlword_bits, 0, 0xFFFF);
  readOneByOne(section, profile, mode);
  checkSetPointStream(section, mode);
  if ((mode.controlword_bits & kStateMachineBits) != 0) {
    section.problem("controlword_bits must leave bits 0 to 3 and 7 to the state machine");
  }
  section.read("bits_while_stopping", mode.bits_while_stopping);
  if (mode.kind == ControlKind::homing && !mode.homing_attained_bit) {
    section.problem("homing needs status_bits/homing_attained");
  }
  if (const auto writes = section.get("entry_writes")) {
    mode.entry_writes = readWrites(*writes, profile, WriteList::running);
  }
  if (const auto mapped = section.get("mapped")) readMapped(*mapped, profile, mode);
  section.finish();
  return mode;
}

/// @param value the meaning, or `{text: meaning, moves: false}`
drive::HomingMethod readMethod(const yaml::Value& value, int number, const DriveProfile& profile) {
  drive::HomingMethod method;
  method.moves = drive::movesByStandard(number);
  if (!value.isMap()) {
    method.text = value.text().value_or("");
    return method;
  }
  yaml::Section section(value);
  if (section.require("text", "say in words how home is found")) section.read("text", method.text);
  section.read("moves", method.moves);
  if (const auto edge = section.get("edge")) {
    method.edge = readOutputBit(*edge, profile);
    if (method.moves) value.problem("an `edge` takes the present position: write `moves: false`");
  }
  section.finish();
  return method;
}

void readMethods(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [key, text] : section.entries()) {
    const auto number = yaml::parseInteger(key);
    if (!number || *number < -128 || *number > 127) {
      text.problem("a homing method is a number from -128 to 127, not `" + key + "`");
    } else {
      const int method = static_cast<int>(*number);
      profile.homing.methods[method] = readMethod(text, method, profile);
    }
  }
  section.finish();
}

}  // namespace

void readModes(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) {
    const ModeSpec mode = readMode(name, entry, profile);
    if (profile.mode(mode.name) != nullptr) {
      entry.problem("the mode " + mode.name + " is given already");
      continue;
    }
    profile.modes.push_back(mode);
  }
  section.finish();
}

void readHoming(const yaml::Value& value, DriveProfile& profile) {
  HomingSpec& homing = profile.homing;
  yaml::Section section(value);
  const auto kind_value = section.require("kind", "none, drive or declare_zero");
  const auto kind =
      kind_value ? kind_value->oneOf({"none", "drive", "declare_zero"}) : std::nullopt;
  enum Way : std::size_t { none, by_drive, declared };
  const std::size_t way = kind.value_or(none);
  if (const auto methods = section.get("methods")) readMethods(*methods, profile);
  section.read("needs_zero_attained_before_start", homing.needs_zero_attained_before_start);
  if (const auto writes = section.get("writes")) {
    homing.writes = readWrites(*writes, profile, WriteList::running);
  }
  if (way == by_drive && homing.methods.empty()) {
    section.problem("a drive that homes by itself needs `methods`: number and meaning");
  }
  if (way != by_drive && !homing.methods.empty()) {
    section.problem("`methods` are for kind `drive`");
  }
  if (way == by_drive && profile.mode("homing") == nullptr) {
    section.problem("a drive that homes by itself needs a mode `homing`");
  }
  if (way == declared) homing.methods[std::nullopt] = drive::HomingMethod{"declared", false, {}};
  section.finish();
}

}  // namespace cia402::config
