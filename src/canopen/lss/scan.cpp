// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/lss/scan.h"

#include <algorithm>
#include <utility>

#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr int kStartTries = 6;  // silent starts that are believed: nobody is left
constexpr int kBitTries = 6;    // questions for 0 and for 1, each
constexpr int kMoveTries = 3;
constexpr int kFollowTries = 2;
constexpr int kRestarts = 5;  // devices that fell silent under way, or were found again
constexpr int kLostHere = 3;  // times in a row at the same bit: it does not come any further
constexpr std::size_t kMostDevices = 127;

std::string count(std::size_t devices) {
  return devices == 1 ? "1 device" : std::to_string(devices) + " devices";
}

}  // namespace

LssTask::Status LssScanTask::question(LssMaster& master, Time now, std::string step,
                                      const can::Frame& frame) {
  LssRequest request;
  request.frames = {frame};
  request.answer = lss::Command::identified;
  request.question = true;
  return ask(master, now, std::move(step), std::move(request));
}

LssTask::Status LssScanTask::proceed(LssMaster& master, Time now) {
  switch (phase_) {
    case Phase::begin:
      phase_ = Phase::starting;
      return ask(master, now, "switching all devices to the waiting state", lssWaitingRequest());
    case Phase::starting:
      return start(master, now);
    case Phase::following:
      return judgeFollowing(master, now);
    case Phase::bits:
      return judgeBit(master, now);
    case Phase::moving:
      return judgeMove(master, now);
    case Phase::confirming:
      return confirm(master, now);
    case Phase::leaving:
      break;
  }
  return finish();
}

/// Asks whether there is anybody (left).
LssTask::Status LssScanTask::start(LssMaster& master, Time now) {
  if (tries_ > 0 && !master.silent()) return beginDevice(master, now);
  if (tries_ >= kStartTries || candidates_.size() >= kMostDevices) {
    return beginConfirming(master, now);
  }
  ++tries_;
  return question(master, now, "asking whether there is a device without a node-ID",
                  lss::fastscan(0, lss::kFastscanStart, 0, 0));
}

/// All that take part wait for the vendor id.
LssTask::Status LssScanTask::beginDevice(LssMaster& master, Time now) {
  part_ = 0;
  tries_ = 0;
  return follow(master, now);
}

/// Asks for the parts that are known as a whole, and goes on behind them bit by bit.
LssTask::Status LssScanTask::follow(LssMaster& master, Time now) {
  if (part_ == lss::kParts) return foundAgain(master, now);
  if (part_ == follow_) {
    bit_ = resume_bit_;
    if (bit_ == 31) scanned_.setPart(part_, 0);  // what is there is of the last device
    asked_one_ = false;
    phase_ = Phase::bits;
    return askBit(master, now);
  }
  phase_ = Phase::following;
  ++tries_;
  const auto next = static_cast<std::uint8_t>((part_ + 1) % lss::kParts);
  return question(master, now, std::string("asking for the same ") + lss::partName(part_),
                  lss::fastscan(scanned_.part(part_), 0, part_, next));
}

LssTask::Status LssScanTask::judgeFollowing(LssMaster& master, Time now) {
  if (!master.silent()) {
    tries_ = 0;
    ++part_;
    return follow(master, now);
  }
  if (tries_ < kFollowTries) return follow(master, now);
  // Nobody has this number, or the one that has it went on and its answer was lost.
  follow_ = part_;
  resume_bit_ = 31;
  tries_ = 0;
  phase_ = Phase::starting;
  return start(master, now);
}

LssTask::Status LssScanTask::askBit(LssMaster& master, Time now) {
  const std::uint32_t mask = 1U << bit_;
  const std::uint32_t known = scanned_.part(part_);
  return question(master, now,
                  std::string("scanning bit ") + std::to_string(bit_) + " of the " +
                      lss::partName(part_) + " of device " + std::to_string(candidates_.size() + 1),
                  lss::fastscan(asked_one_ ? known | mask : known, bit_, part_, part_));
}

LssTask::Status LssScanTask::judgeBit(LssMaster& master, Time now) {
  if (master.silent()) {
    if (asked_one_ && ++tries_ >= kBitTries) return lostTrack(master, now);
    asked_one_ = !asked_one_;
    return askBit(master, now);
  }
  if (asked_one_) scanned_.setPart(part_, scanned_.part(part_) | 1U << bit_);
  asked_one_ = false;
  tries_ = 0;
  if (bit_ == 0) return move(master, now);
  --bit_;
  return askBit(master, now);
}

/// Those that have this very number go on to the next part; after the last one to the
/// configuration state, where they do not take part any more.
LssTask::Status LssScanTask::move(LssMaster& master, Time now) {
  phase_ = Phase::moving;
  ++tries_;
  const auto next = static_cast<std::uint8_t>((part_ + 1) % lss::kParts);
  return question(master, now, std::string("confirming the ") + lss::partName(part_),
                  lss::fastscan(scanned_.part(part_), 0, part_, next));
}

LssTask::Status LssScanTask::judgeMove(LssMaster& master, Time now) {
  // A lost request and a lost answer look alike. Where the device did not go on, it will be silent
  // to the next question, or be found again.
  if (master.silent() && tries_ < kMoveTries) return move(master, now);
  tries_ = 0;
  if (part_ + 1U == lss::kParts) return candidateFound(master, now);
  ++part_;
  bit_ = 31;
  scanned_.setPart(part_, 0);
  phase_ = Phase::bits;
  return askBit(master, now);
}

/// Where others are left, they may be of the same kind.
LssTask::Status LssScanTask::candidateFound(LssMaster& master, Time now) {
  const bool known =
      std::find(candidates_.begin(), candidates_.end(), scanned_) != candidates_.end();
  if (known) return foundAgain(master, now);
  candidates_.push_back(scanned_);
  lost_here_ = 0;
  follow_ = lss::kParts;
  phase_ = Phase::starting;
  return start(master, now);
}

/// It may not have heard that it was found.
LssTask::Status LssScanTask::foundAgain(LssMaster& master, Time now) {
  tries_ = 0;
  if (++restarts_ > kRestarts) {
    trouble_ = "a device goes on answering after it was found (" + lss::toString(scanned_) +
               "): its LSS does not follow CiA 305, or two devices have the same identity";
    return beginConfirming(master, now);
  }
  follow_ = lss::kParts;
  phase_ = Phase::starting;
  return start(master, now);
}

LssTask::Status LssScanTask::lostTrack(LssMaster& master, Time now) {
  tries_ = 0;
  const bool here = lost_here_ > 0 && part_ == lost_part_ && bit_ == lost_bit_;
  lost_here_ = here ? lost_here_ + 1 : 1;
  lost_part_ = part_;
  lost_bit_ = bit_;
  if (++restarts_ > kRestarts || lost_here_ >= kLostHere) {
    trouble_ =
        "while " + step() +
        ": nobody answers any more, neither to 0 nor to 1, again and again: frames are lost, "
        "a device takes longer to answer than the window of " +
        std::to_string(
            std::chrono::duration_cast<std::chrono::milliseconds>(master.options().window)
                .count()) +
        " ms, or its LSS does not follow CiA 305; check the cable, scan with a longer window, or "
        "give it its node-ID by its identity (lss_assign)";
    return beginConfirming(master, now);
  }
  follow_ = part_;
  resume_bit_ = bit_;
  phase_ = Phase::starting;
  return start(master, now);
}

LssTask::Status LssScanTask::beginConfirming(LssMaster& master, Time now) {
  phase_ = Phase::confirming;
  return confirm(master, now);
}

LssTask::Status LssScanTask::confirm(LssMaster& master, Time now) {
  while (confirming_ < candidates_.size()) {
    const lss::Identity& candidate = candidates_[confirming_];
    if (!selection_) selection_.emplace(candidate);
    const LssSelection::Status status = selection_->advance(master, now);
    show(selection_->step());
    if (status == LssSelection::Status::running) return Status::running;
    if (status == LssSelection::Status::done) {
      const std::uint8_t node = selection_->nodeId();
      if (lss::isNodeId(node)) {
        configured_ += "; " + toString(candidate) + " has node-ID " + std::to_string(node) +
                       " and answers fastscan all the same, against CiA 305";
      } else {
        found_.push_back(candidate);
      }
    } else {
      append(trouble_, "what looked like a device was not confirmed, " + selection_->error() +
                           "; scan again, with a longer window");
    }
    ++confirming_;
    selection_.reset();
  }
  return leave(master, now);
}

LssTask::Status LssScanTask::leave(LssMaster& master, Time now) {
  phase_ = Phase::leaving;
  return ask(master, now, "leaving the configuration state", lssWaitingRequest());
}

LssTask::Status LssScanTask::finish() {
  std::string text = count(found_.size()) + " without a node-ID" + configured_;
  if (!trouble_.empty()) text += ", but there may be more: " + trouble_;
  return incomplete() && found_.empty() ? fail(trouble_) : done(std::move(text));
}

}  // namespace cia402::canopen
