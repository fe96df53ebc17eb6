// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/modes/cyclic_position.h"

namespace cia402::drive {

CyclicPosition::CyclicPosition(const ModeChannel& channel, const Context& context)
    : PositionControl(channel, context), limiter_(jointOf(context.axis.config)) {}

void CyclicPosition::beginStream(const Stream& stream, Time at) {
  limiter_.limitTo(limitsOf(axis().config));
  limiter_.reset({sent().value(), sent().velocity(), 0.0}, at);
  if (stream.command) (void)limiter_.command(*stream.command);  // finite, so it is taken
}

void CyclicPosition::takeCommand(Stream& stream) { (void)limiter_.command(*stream.command); }

std::optional<double> CyclicPosition::follow(Stream& stream, Time) {
  const motion::MotionState state = limiter_.step(stream.clock);
  stream.at_rest = state.velocity == 0.0;
  stream.command = limiter_.goal();
  return state.position;
}

}  // namespace cia402::drive
