// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording.h"

#include <algorithm>

#include "common/text.h"
#include "decode/value_text.h"

namespace cia402::bus {
namespace {

using Kind = RecordingTrigger::Kind;

const char* words(Kind kind) {
  switch (kind) {
    case Kind::request:
      return "asked for";
    case Kind::fault:
      return "fault";
    case Kind::emergency:
      return "emergency";
    case Kind::node_lost:
      return "node lost";
    case Kind::node_failed:
      return "boot failed or taken out of operation";
    case Kind::bus_off:
      return "bus-off";
    case Kind::interface_lost:
      break;
  }
  return "interface lost";
}

const char* shortName(Kind kind) {
  switch (kind) {
    case Kind::request:
      return "requested";
    case Kind::fault:
      return "fault";
    case Kind::emergency:
      return "emergency";
    case Kind::node_lost:
      return "node_lost";
    case Kind::node_failed:
      return "node_failed";
    case Kind::bus_off:
      return "bus_off";
    case Kind::interface_lost:
      break;
  }
  return "interface_lost";
}

}  // namespace

bool namesAxis(Kind kind) {
  return kind == Kind::fault || kind == Kind::emergency || kind == Kind::node_lost ||
         kind == Kind::node_failed;
}

NoteRecord::NoteRecord(Kind what, std::size_t which, std::string_view words_given, Time when)
    : stamp(when), axis(static_cast<std::uint16_t>(which)), kind(what) {
  append(words_given);
}

void NoteRecord::append(std::string_view more) {
  const std::size_t room = text.size() - size;
  const std::size_t count = std::min(more.size(), room);
  std::copy_n(more.data(), count, text.begin() + size);
  size = static_cast<std::uint8_t>(size + count);
  if (more.size() > room) std::fill_n(text.end() - 3, 3, '.');
}

std::string triggerText(const RecordingTrigger& trigger, const config::RobotConfig& robot) {
  std::string text = words(trigger.kind);
  if (!namesAxis(trigger.kind) || trigger.axis >= robot.axes.size()) return text;
  const drive::AxisConfig& axis = robot.axes[trigger.axis];
  text = drive::whoIs(axis) + ": " + text;
  return trigger.code == 0 ? text : text + " " + decode::errorText(trigger.code, *axis.profile);
}

std::string triggerName(const RecordingTrigger& trigger, const config::RobotConfig& robot) {
  std::string name = shortName(trigger.kind);
  if (!namesAxis(trigger.kind) || trigger.axis >= robot.axes.size()) return name;
  name = robot.axes[trigger.axis].name + "_" + name;
  return trigger.code == 0 ? name : name + "_" + hexText(trigger.code, 4).substr(2);
}

}  // namespace cia402::bus
