// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/home_by_drive.h"
#include "drive/procedures/home_by_edge.h"
#include "drive/procedures/procedure.h"
#include "drive/procedures/steps/declare.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

/// For drives without homing: the present position is declared to be the configured offset.
class DeclareZero : public Procedure {
 public:
  explicit DeclareZero(double offset)
      : declaring_(offset, "homing by declaring the present position") {}

  Outcome advance(const Context& context) override {
    AxisCore& axis = context.axis;
    const Outcome declared = declaring_.advance(context);
    if (!declared.isDone()) return declared;
    const double offset = axis.config().homing->atHome();
    const bool prismatic = axis.config().geometry.prismatic();
    return Outcome::done(jointName(axis.config()) +
                         ": homed by declaring the present position to be " +
                         length(offset, prismatic) + "; nothing moved" + declaring_.remark());
  }

 private:
  DeclareStep declaring_;
};

Result<std::unique_ptr<Procedure>> makeDriveHoming(AxisCore& axis) {
  const auto& methods = axis.profile().homing.methods;
  const ModeChannel* homing = axis.objects().homingChannel();
  if (homing == nullptr) {
    return Error{axis.who() + ": cannot home: the drive profile " + axis.profile().name +
                 " has no homing mode"};
  }
  if (!axis.config().homing->method) {
    return Error{axis.who() +
                 ": cannot home: no homing method is configured; set homing: "
                 "{method: ...}"};
  }
  const bool homes = axis.mode().spec().kind == ControlKind::homing;
  const bool in_the_way = axis.state().halted && axis.control().halt() && !homes;
  if (in_the_way && !axis.profile().mode_change.while_halted) {
    return Error{axis.who() +
                 ": cannot home: it is halted, and the drive takes no mode then; enable releases "
                 "the halt"};
  }
  if (axis.generator().moving()) {
    return Error{axis.who() + ": homing is only started at standstill (velocity " +
                 number(axis.state().velocity) + ")"};
  }
  const auto method = methods.find(axis.config().homing->method);
  return std::unique_ptr<Procedure>(std::make_unique<DriveHoming>(
      axis, *homing, method != methods.end() ? method->second : HomingMethod()));
}

}  // namespace

Result<std::unique_ptr<Procedure>> makeHome(AxisCore& axis) {
  if (!axis.config().homing) {
    return Error{axis.who() + ": cannot home: no homing is configured; add homing: {...}"};
  }
  const std::string refusal = deviceRefusal(axis, "home");
  if (!refusal.empty()) return Error{refusal};
  if (axis.faulted()) return Error{"cannot home: " + axis.faults().text()};
  const auto& methods = axis.profile().homing.methods;
  if (methods.empty()) {
    return Error{axis.who() + ": cannot home: the drive family " + axis.profile().name +
                 " knows no homing; set_position declares the present position"};
  }
  const auto method = methods.find(axis.config().homing->method);
  if (method != methods.end() && method->second.edge) {
    if (mayHavePower(axis)) return Error{axis.who() + ": cannot home: " + calibrationRefusal(axis)};
    return std::unique_ptr<Procedure>(std::make_unique<HomeByEdge>(axis, method->second));
  }
  const bool declared = !axis.config().homing->method && methods.count(std::nullopt) != 0;
  if (!declared) return makeDriveHoming(axis);
  return std::unique_ptr<Procedure>(std::make_unique<DeclareZero>(axis.config().homing->atHome()));
}

}  // namespace cia402::drive
