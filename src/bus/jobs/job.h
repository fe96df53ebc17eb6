// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cia402_driver/common/time.h"
#include "drive/axis/axis.h"

namespace cia402::bus {

/// Something that was asked for and takes more than a cycle. It owes its reply, or its news, once.
class Job {
 public:
  /// In this order jobs take their steps in a cycle, those of one turn in the order in which they
  /// came.
  enum class Turn : std::uint8_t {
    procedure,  ///< commands axes
    object,     ///< accesses an object of a device
    device,     ///< commands devices
    history,    ///< reads what a device keeps of its past
    last,
  };
  /// When the end of the program ends it.
  enum class Ends : std::uint8_t {
    at_once,     ///< what waits for its turn must not begin any more
    with_motion  ///< it may go on until the axes are disabled
  };

  virtual ~Job() = default;
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  /// Begins what is due and watches what runs. @return true once the reply was given.
  virtual bool step(Time now) = 0;
  /// Gives a failed reply, for the reason `why`; for the end of the program.
  virtual void abandon(const std::string& why) = 0;

  /// Somebody wants the axis to stop, by that procedure: what has not begun on it does not begin
  /// any more.
  virtual void withdraw(const drive::Axis& /*axis*/, drive::ProcedureKind /*by*/) {}
  /// The same on all axes, for the reason `why`, if it would enable them.
  virtual void withdrawEnabling(const std::string& /*why*/) {}
  /// Whoever has called it by that id wants it to end: what runs is stopped and watched to its end,
  /// what has not begun does not begin.
  virtual void cancel(std::uint64_t /*id*/, Time /*now*/) {}
  /// It homes that axis: it does, has, or is going to.
  virtual bool homes(const drive::Axis& /*axis*/) const { return false; }
  /// It begins nothing before release().
  virtual bool held() const { return false; }
  virtual void release() {}

  Turn turn() const { return turn_; }
  Ends ends() const { return ends_; }

 protected:
  Job(Turn turn, Ends ends) : turn_(turn), ends_(ends) {}

 private:
  Turn turn_;
  Ends ends_;
};

}  // namespace cia402::bus
