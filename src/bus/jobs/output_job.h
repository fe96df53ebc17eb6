// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/jobs/bit_change.h"
#include "bus/jobs/job.h"
#include "bus/jobs/object_claims.h"
#include "bus/reply.h"

namespace cia402::bus {

class AxisCycle;

/// Sets digital outputs of a drive by the names of its profile.
struct SetOutputsCommand {
  using Answer = bus::Answer;
  std::string axis;
  std::vector<std::string> names;
  std::vector<bool> values;  ///< as many; true: on

  void begin(AxisCycle& cycle, const Reply<>& reply, Time now) const;
};

/// Outputs that have their bits in one object, and so are set by one write.
struct OutputGroup {
  const drive::ObjectSpec* value = nullptr;
  const drive::ObjectSpec* mask = nullptr;  ///< lets them through; nullptr: nothing does
  std::uint64_t changed = 0, bits = 0;      ///< of `value`, and what they become
  std::uint64_t opened = 0;                 ///< of `mask`
};
/// What a terminal must show for an output to be seen there.
struct OutputTerminal {
  std::string output;  ///< its name
  const drive::ObjectSpec* object = nullptr;
  std::int64_t function = 0;
};

/// What is to be written; or why nothing is: a name that the profile does not have or that is given
/// twice, an object that travels in every cycle.
Result<std::vector<OutputGroup>> outputGroups(drive::Axis& axis, const SetOutputsCommand& command);

/// Sets outputs, object by object. The mask of an object is looked at first. Where it holds an
/// output back, the output gets its value before the mask is opened, so that no older one shows for
/// a moment, and after it once more, as a drive may take none before.
class OutputJob final : public Job {
 public:
  /// @param axis, @param claims must outlive it. @param text what is done, "do1 on, do2 off"
  OutputJob(drive::Axis& axis, ObjectClaims& claims, std::vector<OutputGroup> groups,
            std::string text, Reply<> reply);
  /// Looked at before anything is written; one that shows something else fails it.
  void lookAt(std::vector<OutputTerminal> terminals) { terminals_ = std::move(terminals); }

  bool step(Time now) override;
  void abandon(const std::string& why) override { fail(why); }

 private:
  enum class Stage : std::uint8_t { looking, preparing, opening, setting };

  bool lookAtTerminal();
  std::string terminalRefusal(const OutputTerminal& terminal) const;
  bool beginGroup();
  void begin(Stage stage);
  bool fail(const std::string& why);

  drive::Axis* axis_;
  ObjectClaims* claims_;
  std::vector<OutputTerminal> terminals_;
  std::size_t terminal_ = 0;
  fieldbus::Ticket ticket_;
  std::vector<OutputGroup> groups_;
  std::size_t group_ = 0;
  Stage stage_ = Stage::looking;
  std::string text_;
  ObjectClaims::Claim claim_;
  std::optional<BitChange> change_;
  Reply<> reply_;
};

}  // namespace cia402::bus
