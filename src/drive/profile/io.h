// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace cia402::drive {

/// A bit of an object that the profile names.
struct ObjectBit {
  std::string object;
  unsigned bit = 0;  ///< below the object's width
  std::uint64_t mask() const { return std::uint64_t{1} << bit; }
};

/// A digital output that can be set (CiA 402-2, 60FEh).
struct DigitalOutput {
  ObjectBit value;
  std::string terminal;           ///< object that says what the terminal shows; empty: always this
  std::int64_t function = 0;      ///< ... and what it says then
  std::optional<ObjectBit> mask;  ///< lets the output through to the terminal; absent: nothing does
};

/// A digital input in words (CiA 402-2, 60FDh).
struct DigitalInput {
  ObjectBit value;
  bool active_low = false;  ///< a 0 is the active level
};

/// The objects that hold what touch probes have stored (CiA 402-2, 60B8h to 60BDh, 60D5h to 60D8h),
/// by their names in the profile.
struct TouchProbes {
  static constexpr unsigned kMost = 2;
  /// What is stored at one edge of one probe.
  struct Edge {
    std::string position;  ///< empty: this edge cannot be stored
    std::string counter;   ///< of the edges so far; empty: there is none
  };
  struct Probe {
    Edge rising, falling;
  };
  std::string function, status;
  std::array<Probe, kMost> probes;  ///< probe 1 and 2
};

}  // namespace cia402::drive
