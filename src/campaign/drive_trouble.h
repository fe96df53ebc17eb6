// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "campaign/session.h"

namespace cia402::campaign {

/// What goes wrong with the drives.
class DriveTrouble {
 public:
  explicit DriveTrouble(Session& session)
      : session_(session),
        cuts_(session.stage.drives().size()),
        dead_(session.stage.drives().size()) {}

  /// @return false if the words are no trouble of drives.
  bool act(const Words& words);
  /// All drives are well again, with cables and power.
  void calm();

 private:
  using Action = void (DriveTrouble::*)(std::size_t axis, const Words& words);
  static Action find(const std::string& verb);

  // Actions, on each axis that they name: what it has for itself happens to it alone, what is its
  // drive's to all axes in there.
  void fault(std::size_t axis, const Words& words);      ///< fault A NAME
  void clear(std::size_t axis, const Words& words);      ///< clear A
  void cutPower(std::size_t axis, const Words& words);   ///< power A SECONDS: none for so long
  void silence(std::size_t axis, const Words& words);    ///< silent A SECONDS: deaf and mute
  void mute(std::size_t axis, const Words& words);       ///< mute A SECONDS: answers no SDO
  void block(std::size_t axis, const Words& words);      ///< block A SECONDS: the rotor
  void limitHere(std::size_t axis, const Words& words);  ///< switch A lower|upper SECONDS

  const sim::AxisPlace& place(std::size_t axis) const { return session_.stage.axes()[axis].place; }
  void inject(std::size_t axis, const std::string& what);
  void clearLater(std::size_t axis, Duration delay);

  Session& session_;
  std::vector<unsigned> cuts_;  ///< of each drive's power that have not ended
  std::vector<bool> dead_;      ///< drives with a fault that only the power switch ends
  std::map<const double*, double> switches_;  ///< where those that were moved belong
};

}  // namespace cia402::campaign
