// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/settings.h"

namespace cia402::drive {

/// The axis is enabled, or on the way to it.
bool mayHavePower(const AxisCore& axis);

/// A disabled drive takes the present position as its zero by a rising edge of one bit
/// (HomingMethod::edge), whose object keeps its other bits; the bit is 0 again afterwards. What the
/// drive tells then must be its zero, and the joint reads `homing.offset` there.
class HomeByEdge : public Procedure {
 public:
  /// @param method that is configured, with an edge
  HomeByEdge(const AxisCore& axis, const HomingMethod& method);
  Outcome advance(const Context& context) override;
  /// It is over in a moment, and leaves nothing half done.
  bool cancel(const std::string&, const Context&) override { return phase_ == Phase::begin; }

 private:
  enum class Phase {
    begin,
    comparing,
    opening,
    reading,
    low,
    high,
    settling,
    lowered,
    measuring,
    closing
  };
  void enter(Phase phase, const Context& context, const char* step, const char* what);
  Outcome stand(const Context& context);
  Outcome prepare(const Context& context);
  Outcome open(const Context& context);
  Outcome write(const Context& context);
  void writeBit(const Context& context, bool on);
  Outcome measure(const Context& context);
  Outcome close(const Context& context);
  Outcome failed(const Context& context, const std::string& why) const;

  const ObjectSpec* object_;
  std::uint64_t mask_;
  std::string text_;
  SettingsStep settings_;
  Phase phase_ = Phase::begin;
  fieldbus::Ticket ticket_;
  std::uint64_t others_ = 0;  ///< the other bits of the object
  Time since_{};
};

}  // namespace cia402::drive
