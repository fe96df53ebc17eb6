// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "can/frame_record.h"
#include "canopen/config.h"
#include "cia402_driver/common/time.h"
#include "config/robot.h"

namespace cia402::bus {

/// An axis as the flight recorder keeps it: at every change of what is no number, and ten times a
/// second.
struct AxisRecord {
  enum Flag : std::uint8_t {
    homed = 1,
    warning = 2,
    internal_limit = 4,
    ready_for_motion = 8,
    running = 16,    ///< a procedure
    succeeded = 32,  ///< the last procedure
    moving = 64,     ///< set-points of the axis' own command are on their way
  };
  Time stamp{};
  float position = 0, velocity = 0, effort = 0, following_error = 0, target = 0;  ///< joint units
  std::uint16_t axis = 0;  ///< index in the configuration
  std::uint16_t statusword = 0, error_code = 0;
  std::int16_t mode = 0;
  std::uint8_t state = 0;      ///< drive::State
  std::uint8_t health = 0;     ///< fieldbus::Health
  std::uint8_t procedure = 0;  ///< drive::ProcedureKind
  std::uint8_t flags = 0;
};
static_assert(sizeof(AxisRecord) == 40 && std::is_trivially_copyable<AxisRecord>::value, "ring");

/// A sentence about something that happened: an event, a step of a procedure, a group's motion.
struct NoteRecord {
  static constexpr std::uint16_t kNoAxis = 0xFFFF;
  enum class Kind : std::uint8_t { event, step, group };
  Time stamp{};
  std::uint16_t axis = kNoAxis;
  std::uint8_t size = 0;
  Kind kind = Kind::event;
  std::array<char, 244> text{};

  NoteRecord() = default;
  /// Longer texts are cut and end in "...".
  NoteRecord(Kind what, std::size_t which, std::string_view words, Time when);
  void append(std::string_view more);
  std::string_view view() const { return {text.data(), size}; }
};
static_assert(sizeof(NoteRecord) == 256 && std::is_trivially_copyable<NoteRecord>::value, "ring");

/// Why a recording is written.
struct RecordingTrigger {
  enum class Kind : std::uint8_t {
    request,      ///< a person asked for it
    fault,        ///< an axis entered fault or fault reaction active
    emergency,    ///< EMCY with an error code
    node_lost,    ///< or rebooted
    node_failed,  ///< its boot
    bus_off,
    interface_lost,  ///< went down or missing
  };
  Kind kind = Kind::request;
  std::uint16_t axis = 0;  ///< of fault, emergency, node_lost, node_failed
  std::uint16_t code = 0;  ///< of fault, emergency; 0: not known
  Time stamp{};
};

/// Does this kind of trigger belong to one axis?
bool namesAxis(RecordingTrigger::Kind kind);
/// "shoulder (node 1): fault 0x8611 following error".
std::string triggerText(const RecordingTrigger& trigger, const config::RobotConfig& robot);
/// The same for a file name: "shoulder_fault_8611", "bus_off".
std::string triggerName(const RecordingTrigger& trigger, const config::RobotConfig& robot);

/// The COB-ID of a PDO; some drives keep one of their own.
struct PdoIdentifier {
  canopen::NodeId node = 0;
  canopen::PdoDirection direction = canopen::PdoDirection::tpdo;
  unsigned number = 1;
  std::uint16_t cob_id = 0;
};

/// What a flight recorder held at a moment.
struct Recording {
  Time begin{}, end{};
  std::vector<RecordingTrigger> triggers;  ///< in their order, at least one
  std::vector<can::FrameRecord> frames;    ///< by stamp
  std::vector<AxisRecord> axes;            ///< by stamp
  std::vector<NoteRecord> notes;           ///< by stamp
  std::vector<PdoIdentifier> identifiers;  ///< of all PDOs, as they were last
};

}  // namespace cia402::bus
