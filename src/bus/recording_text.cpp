// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/recording_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <ostream>

#include "common/text.h"
#include "decode/value_text.h"
#include "drive/axis/axis.h"

namespace cia402::bus {
namespace {

using std::chrono::nanoseconds;

nanoseconds onWall(Time time, nanoseconds wall) { return time.time_since_epoch() + wall; }

const char* directionText(can::Direction direction) {
  return direction == can::Direction::transmitted ? "tx" : "rx";
}

std::string numbers(const AxisRecord& record, const drive::AxisConfig& axis) {
  const struct {
    const char* name;
    float value;
    drive::Quantity quantity;
  } values[] = {{"at", record.position, drive::Quantity::position},
                {"velocity", record.velocity, drive::Quantity::velocity},
                {"effort", record.effort, drive::Quantity::torque},
                {"following error", record.following_error, drive::Quantity::distance}};
  std::string text;
  for (const auto& [name, value, quantity] : values) {
    if (std::isnan(value)) continue;
    append(text,
           std::string(name) + " " + numberText(static_cast<double>(value), 5) + " " +
               decode::unitOf(quantity, axis),
           ", ");
  }
  return text.empty() ? "no feedback" : text;
}

/// Flags whose change is told, and the words for both ways.
constexpr struct {
  AxisRecord::Flag flag;
  const char *on, *off;
} kFlags[] = {
    {AxisRecord::homed, "homed", "no longer homed"},
    {AxisRecord::warning, "warning", "warning gone"},
    {AxisRecord::internal_limit, "internal limit active", "internal limit left"},
    {AxisRecord::ready_for_motion, "ready for motion", "not ready for motion"},
    {AxisRecord::moving, "set-points begin to move", "set-points at rest"},
};

std::string procedureText(const AxisRecord& record) {
  const std::string name = drive::toString(static_cast<drive::ProcedureKind>(record.procedure));
  if ((record.flags & AxisRecord::running) != 0) return "procedure " + name + " begins";
  return "procedure " + name +
         ((record.flags & AxisRecord::succeeded) != 0 ? " succeeded" : " failed");
}

template <typename Value>
void addChange(std::string& text, const char* what, bool first, Value before, Value now,
               std::string (*words)(Value, const drive::AxisConfig&),
               const drive::AxisConfig& axis) {
  if (first) {
    append(text, what + words(now, axis));
  } else if (before != now) {
    append(text, what + words(before, axis) + " -> " + words(now, axis));
  }
}

std::string stateWords(std::uint8_t state, const drive::AxisConfig&) {
  return drive::toString(static_cast<drive::State>(state));
}
std::string healthWords(std::uint8_t health, const drive::AxisConfig&) {
  return fieldbus::toString(static_cast<fieldbus::Health>(health));
}
std::string modeWords(std::int16_t mode, const drive::AxisConfig& axis) {
  return decode::modeText(mode, *axis.profile);
}
std::string errorWords(std::uint16_t code, const drive::AxisConfig& axis) {
  return decode::errorText(code, *axis.profile);
}

/// The configuration with the COB-IDs that the PDOs really had.
canopen::MasterConfig asItWas(canopen::MasterConfig master, const Recording& recording) {
  for (const PdoIdentifier& known : recording.identifiers) {
    for (canopen::NodeConfig& node : master.nodes) {
      if (node.node_id != known.node) continue;
      for (canopen::PdoConfig& pdo : node.pdos) {
        const bool same = pdo.direction == known.direction && pdo.number == known.number;
        if (same) pdo.cob_id = known.cob_id;
      }
    }
  }
  return master;
}

/// Writes the lines of a recording in the order of time.
class Teller {
 public:
  Teller(std::ostream& out, const Recording& recording, const config::RobotConfig& robot,
         const canopen::MasterConfig& master, nanoseconds wall)
      : out_(out),
        recording_(recording),
        robot_(robot),
        wall_(wall),
        decoder_(robot, asItWas(master, recording)),
        last_(robot.axes.size(), nullptr) {}

  void tell() {
    auto frame = recording_.frames.begin();
    auto axis = recording_.axes.begin();
    auto note = recording_.notes.begin();
    for (; frame != recording_.frames.end(); ++frame) {
      tellUntil(frame->stamp(), axis, note);
      line(frame->stamp(), directionText(frame->direction()), decoder_.decode(frame->frame()));
    }
    tellUntil(kNever, axis, note);
  }

 private:
  using Axes = std::vector<AxisRecord>::const_iterator;
  using Notes = std::vector<NoteRecord>::const_iterator;

  void tellUntil(Time time, Axes& axis, Notes& note) {
    while (true) {
      const Time next_axis = axis != recording_.axes.end() ? axis->stamp : kNever;
      const Time next_note = note != recording_.notes.end() ? note->stamp : kNever;
      const bool axis_first = next_axis <= next_note;
      const Time next = axis_first ? next_axis : next_note;
      if (next == kNever || next >= time) return;
      if (axis_first) {
        tellAxis(*axis++);
      } else {
        tellNote(*note++);
      }
    }
  }
  std::string nameOf(std::size_t axis) const {
    if (axis >= robot_.axes.size()) return "";
    const drive::AxisConfig& config = robot_.axes[axis];
    return drive::whoIs(config, std::to_string(robot_.deviceOf(config).node_id));
  }
  void tellAxis(const AxisRecord& record) {
    if (record.axis >= robot_.axes.size()) return;
    line(record.stamp, "--",
         {"axis", nameOf(record.axis),
          axisText(last_[record.axis], record, robot_.axes[record.axis])});
    last_[record.axis] = &record;
  }
  void tellNote(const NoteRecord& note) {
    const char* kind = note.kind == NoteRecord::Kind::step    ? "step"
                       : note.kind == NoteRecord::Kind::group ? "group"
                                                              : "event";
    line(note.stamp, "--", {kind, nameOf(note.axis), std::string(note.view())});
  }
  void line(Time time, const char* direction, const decode::DecodedFrame& decoded) {
    const double relative = toSeconds(time - recording_.triggers.front().stamp);
    out_ << decode::formatDecoded(onWall(time, wall_), relative, direction, decoded) << '\n';
  }

  std::ostream& out_;
  const Recording& recording_;
  const config::RobotConfig& robot_;
  nanoseconds wall_;
  decode::FrameDecoder decoder_;
  std::vector<const AxisRecord*> last_;
};

}  // namespace

std::string axisText(const AxisRecord* before, const AxisRecord& record,
                     const drive::AxisConfig& axis) {
  const bool first = before == nullptr;
  const AxisRecord& old = first ? record : *before;
  std::string text;
  addChange(text, "", first, old.state, record.state, stateWords, axis);
  addChange(text, "node ", first, old.health, record.health, healthWords, axis);
  addChange(text, "mode ", first, old.mode, record.mode, modeWords, axis);
  addChange(text, "error ", first, old.error_code, record.error_code, errorWords, axis);
  const std::uint8_t changed = first ? record.flags : old.flags ^ record.flags;
  for (const auto& [flag, on, off] : kFlags) {
    if ((changed & flag) != 0) append(text, (record.flags & flag) != 0 ? on : off);
  }
  const bool another = record.procedure != old.procedure;
  if ((changed & AxisRecord::running) != 0 || (another && !first)) {
    append(text, procedureText(record));
  }
  append(text, numbers(record, axis));
  return text;
}

std::string timeStamp(nanoseconds since_1970) {
  const auto milliseconds =
      std::chrono::duration_cast<std::chrono::milliseconds>(std::max(since_1970, nanoseconds(0)));
  const auto seconds = static_cast<std::time_t>(milliseconds.count() / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{}, all{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H-%M-%S", &utc);
  std::snprintf(all.data(), all.size(), "%.20s.%03dZ", text.data(),
                static_cast<int>(milliseconds.count() % 1000));
  return all.data();
}

void writeFrames(std::ostream& out, const Recording& recording, const std::string& interface,
                 nanoseconds wall) {
  can::LogWriter writer(out);
  can::LogEntry entry;
  entry.interface = interface;
  for (const can::FrameRecord& record : recording.frames) {
    entry.stamp = onWall(record.stamp(), wall);
    entry.frame = record.frame();
    entry.direction = record.direction();
    writer.write(entry);
  }
}

void writeText(std::ostream& out, const Recording& recording, const config::RobotConfig& robot,
               const canopen::MasterConfig& master, nanoseconds wall) {
  out << "# Flight recording of " << robot.bus.interface << ", "
      << timeStamp(onWall(recording.begin, wall)) << " to "
      << timeStamp(onWall(recording.end, wall)) << ", " << recording.frames.size() << " frames\n";
  for (const RecordingTrigger& trigger : recording.triggers) {
    out << "# " << timeStamp(onWall(trigger.stamp, wall)) << " " << triggerText(trigger, robot)
        << '\n';
  }
  out << "# s since 1970, s from the first of these, direction (rx, tx; -- is no frame), service, "
         "node, text\n";
  Teller(out, recording, robot, master, wall).tell();
}

}  // namespace cia402::bus
