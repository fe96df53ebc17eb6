// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "sim/drive/moving_axis.h"

namespace cia402::sim {

/// The two touch probes of an axis (CiA 402-2, 60B8h to 60BDh, 60D5h to 60D8h): they store where
/// the rotor is at an edge of their inputs, or at the index pulse.
class TouchProbes {
 public:
  /// @param axis must outlive it.
  explicit TouchProbes(const MovingAxis& axis) : axis_(axis) {}

  /// Power or reset.
  void start();
  /// 60B8h was written.
  void command();
  /// @param probe 1 or 2; others do not exist
  void setInput(unsigned probe, bool active);
  /// The rotor has turned from `from` turns to where it is.
  void turned(double from);

 private:
  static constexpr unsigned kProbes = 2, kEdges = 2;  // rising, falling
  struct Probe {
    bool input = false;
    unsigned function = 0;  ///< the six bits of 60B8h that are its own
    unsigned stored = 0;    ///< bits 1 and 2 of 60B9h
    unsigned taken = 0;     ///< the same, since it was armed
  };

  void command(Probe& probe, unsigned function) const;
  void store(unsigned probe, unsigned edge, double turns);
  void publish();

  const MovingAxis& axis_;
  std::array<Probe, kProbes> probes_;
};

}  // namespace cia402::sim
