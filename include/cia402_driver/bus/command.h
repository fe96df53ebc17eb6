// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cia402_driver/canopen/emcy/error_history.h"
#include "cia402_driver/canopen/lss/protocol.h"
#include "cia402_driver/canopen/sdo/client.h"
#include "cia402_driver/drive/axis.h"
#include "cia402_driver/motion/trajectory.h"

namespace cia402::bus {

/// What a command came to, for a service answer.
struct Answer {
  bool success = false;
  std::string message;                                       ///< a sentence
  fieldbus::Bytes data;                                      ///< read_object: wire order
  double number = std::numeric_limits<double>::quiet_NaN();  ///< read_object: in device units
  std::string text;  ///< read_object: value with unit; DcfDraft: the file
  std::vector<canopen::lss::Identity> devices;  ///< lss_scan: without a node-ID
  std::vector<std::string> device_axes;         ///< lss_scan: the axis of each device, or empty
  canopen::ErrorHistory history;                ///< error_history
};

inline Answer answerOf(bool success, std::string message) {
  Answer answer;
  answer.success = success;
  answer.message = std::move(message);
  return answer;
}

/// Called once, in the bus thread, when a command has ended. Must not block.
using Reply = std::function<void(const Answer&)>;
inline void give(const Reply& reply, const Answer& answer) {
  if (reply) reply(answer);
}
inline void refuse(const Reply& reply, std::string message) {
  give(reply, answerOf(false, std::move(message)));
}
inline std::string noSuchAxis(const std::string& name) {
  return "there is no axis \"" + name + "\"";
}

/// A procedure on one axis, or on all that are concerned where `axis` is empty.
struct ProcedureCommand {
  std::string axis;
  drive::ProcedureRequest request;
};

/// A set-point of the axis' active mode, rad or m, per s, N m or N. Answered only if refused.
struct SetpointCommand {
  std::size_t axis = 0;  ///< index in the configuration
  double value = 0.0;
};

/// A trajectory for a group; without points: stop. Answered once it was accepted or refused.
struct TrajectoryCommand {
  std::string group;
  std::vector<std::string> joints;
  std::vector<motion::TrajectoryPoint> points;
  std::optional<Time> start_time;
};

/// Reads an object by profile name or "6041:00".
struct ReadObjectCommand {
  std::string axis, object;
};

/// Writes an object: a number in device units (decimal, or 0x... as the bit pattern; a float where
/// the object carries one), or a text for strings.
struct WriteObjectCommand {
  std::string axis, object, value;
};

/// An NMT command by its word ("stop", see NmtJob) to one axis' node, or to all where `axis` is
/// empty.
struct NmtServiceCommand {
  std::string axis, command;
};

/// Reads the error history (1003h) of an axis' drive.
struct ErrorHistoryCommand {
  std::string axis;
};

/// Finds all devices without a node-ID; refused while something is in motion.
struct LssScanCommand {
  Duration window{std::chrono::milliseconds(20)};  ///< for each answer, see LssOptions
};

/// Gives the device of an identity a node-ID.
struct LssAssignCommand {
  canopen::lss::Identity identity;
  int node_id = 0;
  bool store = false;
};

/// Sets the bit timing of one axis' drive, or of all where `axis` is empty; with `activate` all
/// devices on the bus take it.
struct LssBitTimingCommand {
  std::string axis;
  unsigned kbit_per_s = 0;
  bool store = false, activate = false;
  Duration delay{std::chrono::seconds(1)};  ///< of silence before and after the change
};

struct DcfReading;
/// Reads the objects of a drive that a DCF is to hold; made by DcfDraft.
struct SaveDcfCommand {
  std::string axis;
  std::shared_ptr<DcfReading> reading;  ///< not nullptr; complete once answered with success
};

/// Runs a function in the bus thread, e.g. to inject a fault into a simulated drive.
struct CallCommand {
  std::function<Answer(Time)> function;
};

struct Command {
  std::variant<ProcedureCommand, SetpointCommand, TrajectoryCommand, ReadObjectCommand,
               WriteObjectCommand, NmtServiceCommand, LssScanCommand, LssAssignCommand,
               LssBitTimingCommand, ErrorHistoryCommand, SaveDcfCommand, CallCommand>
      body;
  Reply reply;  ///< may be empty
};

}  // namespace cia402::bus
