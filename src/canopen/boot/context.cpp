// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/context.h"

#include <utility>

#include "canopen/boot/text.h"
#include "common/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

constexpr Duration kStateRetry = std::chrono::milliseconds(50);
constexpr Duration kStatePatience = std::chrono::seconds(3);  // a drive stops and disables in that

}  // namespace

void BootContext::reset() {
  found = BootFindings();
  ticket.reset();
  deadline = kNever;
  absent_at = kNever;
  resetting = braking = false;
  resets_left = 0;
  error.clear();
  failure = BootFailure::none;
  ask_state = false;
  notes.clear();
  remarks.clear();
}

void BootContext::read(ObjectId object, const std::string& name, Time now,
                       std::optional<SdoOptions> options) {
  step = "reading " + objectText(object, name);
  ticket = sdo.upload(object, name, options);
  submit(now);
}

void BootContext::write(ObjectId object, Bytes data, const std::string& name, Time now,
                        std::optional<SdoOptions> options) {
  step = "writing " + valueText(data) + " to " + objectText(object, name);
  ticket = sdo.download(object, std::move(data), name, options);
  submit(now);
}

void BootContext::submit(Time now) {
  asked = now;
  sdo.holdUntil(pacer.turn(now));
  sdo.tick(now);
}

bool BootContext::refused() const {
  return ticket->failure() == fieldbus::Transfer::Failure::aborted_by_server;
}

bool BootContext::refusedAsMissing() const {
  return refused() && (ticket->abortCode() == abort_code::kNoSuchObject ||
                       ticket->abortCode() == abort_code::kNoSuchSubindex);
}

Progress BootContext::fail(BootFailure kind, const std::string& reason) {
  failure = kind;
  error = reason;
  return Progress::failed;
}

Progress BootContext::failTransfer(const std::string& remedy) {
  const bool mute = ticket->failure() == fieldbus::Transfer::Failure::timed_out;
  return fail(refused() ? BootFailure::refused : BootFailure::timed_out,
              "boot failed while " + step + ": " + ticket->reason() + (mute ? muteText() : "") +
                  (remedy.empty() ? "" : "; " + remedy));
}

std::string BootContext::muteText() const {
  if (!found.heartbeat_heard || found.heartbeat_at < asked) return {};
  return std::string("; its heartbeat goes on (NMT state ") + toString(found.heartbeat_state) +
         "): " + kMuteAdvice;
}

Progress BootContext::failStopped() {
  return fail(BootFailure::timed_out,
              "boot failed: it says that it is stopped (NMT state), still after " +
                  std::to_string(found.wake_ups) + " commands to enter pre-operational within " +
                  secondsText(found.stopped_last - found.stopped_since) +
                  ", and a stopped drive answers no SDO; look for another NMT master that stops "
                  "it, and whether the drive hears this one (wiring); then switch it off and on, "
                  "or recover");
}

void BootContext::noteTransfer(const std::string& what) {
  notes.push_back(what + ": " + step + ": " + ticket->reason());
}

bool StatePatience::grant(BootContext& boot, std::uint32_t abort, Time now) {
  if (abort != abort_code::kDeviceState) return false;
  if (until_ == kNever) until_ = now + kStatePatience;
  if (now >= until_) return false;
  repeat_at_ = boot.deadline = now + kStateRetry;
  return true;
}

std::optional<Progress> StatePatience::rest(BootContext& boot, Time now) {
  if (repeat_at_ == kNever) return {};
  if (now < repeat_at_) return Progress::waiting;
  repeat_at_ = boot.deadline = kNever;
  return Progress::again;
}

}  // namespace cia402::canopen
