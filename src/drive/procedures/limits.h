// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drive/axis/axis.h"

namespace cia402::drive {

class AxisCore;

/// A device that boots gets so many times its boot time: it tries again.
inline constexpr int kBootTimes = 3;

/// An axis that coasts gets this long to come to rest. Switched on in motion it would be pulled
/// back to where it was in that moment.
inline constexpr Duration kComeToRest{std::chrono::seconds(10)};

/// The longest that a stop may take, from the limit or from `velocity`, whichever is faster.
/// @param velocity measured, rad/s or m/s; not finite: unknown
Duration stopTime(const AxisConfig& config, double velocity);

/// How long a transition of CiA 402-2 may take of this axis, by what its drive has told of it.
Duration transitionTime(const AxisCore& axis, int number);
/// How long it may take from operation enabled to switch on disabled, by the transitions of the
/// axis' `disabling`: if that is one step, or one after the other.
Duration disablingAtOnce(const AxisCore& axis);
Duration disablingInTurn(const AxisCore& axis);

/// The longest that a procedure may take: what its steps may take, each once. A drive that goes to
/// and fro between states begins the wait of a step again and again, so the whole has a limit.
/// @param device that the axis sits in. @param velocity as for stopTime()
Duration timeLimit(ProcedureKind kind, const AxisConfig& config,
                   const fieldbus::DeviceTimes& device, double velocity);

}  // namespace cia402::drive
