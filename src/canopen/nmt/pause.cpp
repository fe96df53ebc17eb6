// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/nmt/pause.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kBlindStarts = 3;

}  // namespace

void NmtPause::begin(Duration stopped, Duration patience, bool told, Time now) {
  told_ = told;
  starting_ = false;
  starts_ = 0;
  // Counted from the last command: the first may be lost.
  start_at_ = now + kRepeat + stopped;
  give_up_at_ = start_at_ + patience;
  sink_.send(nmtFrame(NmtCommand::stop, node_));
  next_ = now + kRepeat;
}

void NmtPause::heard(NmtState state) {
  if (starting_ && state == NmtState::operational) end();
}

bool NmtPause::tick(Time now) {
  if (now < next_) return true;
  if (now < start_at_) {
    sink_.send(nmtFrame(NmtCommand::stop, node_));
    next_ = start_at_;
    return true;
  }
  if (!told_ && starts_ == kBlindStarts) {
    end();
    return true;
  }
  if (starting_ && now >= give_up_at_) {
    end();
    return false;
  }
  starting_ = true;
  ++starts_;
  sink_.send(nmtFrame(NmtCommand::start, node_));
  next_ = now + kRepeat;
  return true;
}

}  // namespace cia402::canopen
