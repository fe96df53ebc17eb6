// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drive/axis/core.h"

namespace cia402::drive {

/// Asks the drive beside the cycle for what its profile wants watched, at each boot for what it
/// wants told of the drive, and at each fault for what says more of it; tells people. A request
/// allocates.
class Inquiry {
 public:
  static constexpr Duration kInterval{std::chrono::seconds(1)};

  explicit Inquiry(AxisCore& axis);  ///< @param axis must outlive this
  /// Once a cycle.
  void advance(Time now) {
    if (concerned_) step(now);
  }

 private:
  struct Watched {
    const ValueWatch* watch = nullptr;
    const ObjectSpec* object = nullptr;
    bool outside = false;
  };
  struct Asked {
    ObjectId id;
    std::string name;
  };
  void step(Time now);
  void ask(Time now);
  void take(const fieldbus::Transfer& answer);
  void judge(Watched& watched, const fieldbus::Transfer& answer);
  void describe(const fieldbus::Transfer& answer);
  void introduce(const fieldbus::Transfer& answer);
  void tellIntroduction();
  void mindZero();

  AxisCore& axis_;
  std::vector<Watched> watched_;
  std::vector<Asked> at_fault_;
  std::vector<const ObjectSpec*> at_boot_;
  bool concerned_;
  fieldbus::Ticket ticket_;
  enum class Asks : std::uint8_t { watched, at_fault, at_boot };
  Asks asks_ = Asks::watched;   ///< of which the ticket is
  std::size_t next_ = 0;        ///< of watched_
  std::size_t fault_next_ = 0;  ///< of at_fault_
  std::size_t boot_next_ = 0;   ///< of at_boot_, since the drive is ready
  bool described_ = false;      ///< the present fault
  std::string description_, introduction_;
  std::uint32_t notices_ = 0;  ///< of the axis, in the cycle before
  bool zero_minded_ = false;   ///< the present fault has cost the axis its zero
  Time next_round_{};
};

}  // namespace cia402::drive
