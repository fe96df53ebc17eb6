// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/sdo/client.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "canopen/sdo/frames.h"
#include "common/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

using Direction = SdoTransfer::Direction;
using Failure = SdoTransfer::Failure;

std::string milliseconds(Duration duration) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration);
  return std::to_string(ms.count()) + " ms";
}

}  // namespace

SdoClient::SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults, SdoChannel channel,
                     can::Pacer* pacer, std::string lock)
    : node_(node),
      defaults_(defaults),
      lock_(std::move(lock)),
      answer_id_(channel.answer != 0 ? channel.answer : 0x580U + node),
      exchange_(sink, pacer, channel.request != 0 ? channel.request : 0x600U + node) {}

SdoTicket SdoClient::upload(ObjectId object, std::string name, std::optional<SdoOptions> options) {
  auto transfer = std::make_shared<SdoTransfer>(Direction::upload, object, std::move(name), Bytes(),
                                                options.value_or(defaults_), false);
  queue_.add(transfer);
  return transfer;
}

SdoTicket SdoClient::download(ObjectId object, Bytes data, std::string name,
                              std::optional<SdoOptions> options) {
  auto transfer = std::make_shared<SdoTransfer>(
      Direction::download, object, std::move(name),
      widths_.toDrive(object, half_floats_.narrowed(object, std::move(data))),
      options.value_or(defaults_), false);
  queue_.add(transfer);
  return transfer;
}

SdoTicket SdoClient::downloadUrgent(ObjectId object, Bytes data, const std::string& name) {
  makeWay(toString(object) + (name.empty() ? "" : " " + name));
  auto transfer = std::make_shared<SdoTransfer>(
      Direction::download, object, name,
      widths_.toDrive(object, half_floats_.narrowed(object, std::move(data))), defaults_, true);
  queue_.add(transfer);
  return transfer;
}

bool SdoClient::post(ObjectId object, const Bytes& data) {
  if (!SdoDownload::isExpedited(data.size())) return false;
  const auto* upload = std::get_if<SdoUpload>(&wire_);
  const bool asked = upload != nullptr && upload->initiating();
  if (!isIdle() && !isAtFence() && !asked) return false;
  SdoDownload::sendExpedited(exchange_, object, widths_.toDrive(object, data));
  fence_.expectNothingOf(object);
  if (isAtFence() && fence_.expectMore()) askFence();
  return true;
}

/// The transfer on the wire, unless it is urgent itself, is none any more.
void SdoClient::makeWay(const std::string& urgent) {
  if (isIdle() || queue_.front().urgent()) return;
  if (isAtFence()) {  // nothing of the transfer itself was sent: it can wait
    attempt_ = 1;
    blocks_.begin();
    return;
  }
  abandon(abort_code::kGeneral);
  wire_ = Idle();
  queue_.front().fail(node_, Failure::cancelled, 0,
                      "cancelled: it made way for an urgent write to " + urgent);
  queue_.pop();
}

std::optional<SdoOptions> SdoClient::completed(
    const std::optional<fieldbus::AccessOptions>& options) const {
  if (!options) return std::nullopt;
  SdoOptions all = defaults_;
  static_cast<fieldbus::AccessOptions&>(all) = *options;
  return all;
}

SdoTicket SdoClient::queueUpload(ObjectId object, std::string name,
                                 const std::optional<fieldbus::AccessOptions>& options) {
  return upload(object, std::move(name), completed(options));
}

SdoTicket SdoClient::queueDownload(ObjectId object, Bytes data, std::string name,
                                   const std::optional<fieldbus::AccessOptions>& options) {
  return download(object, std::move(data), std::move(name), completed(options));
}

bool SdoClient::idle() const { return queue_.empty(); }

void SdoClient::tick(Time now) {
  auto* blocks = std::get_if<SdoBlockDownload>(&wire_);
  if (isIdle()) {
    startNext(now);
  } else if (blocks != nullptr && now >= blocks->feedAt()) {
    blocks->feed(now);
  } else if (now >= exchange_.deadline()) {
    onTimeout(now);
  }
}

Time SdoClient::nextDeadline() const {
  if (isIdle()) return queue_.nextStart();
  const auto* blocks = std::get_if<SdoBlockDownload>(&wire_);
  return blocks != nullptr ? std::min(exchange_.deadline(), blocks->feedAt())
                           : exchange_.deadline();
}

void SdoClient::startNext(Time now) {
  if (queue_.empty() || now < queue_.nextStart()) return;
  attempt_ = 0;
  blocks_.begin();
  started_at_ = now;
  attempt(now);
}

void SdoClient::attempt(Time now) {
  ++attempt_;
  if (fence_.isUp()) {
    sendFence(now);
  } else {
    initiate(now);
  }
}

void SdoClient::sendFence(Time now) {
  askFence();
  exchange_.await(queue_.front().options().timeout, now);
  wire_ = AtFence();
}

void SdoClient::askFence() {
  ++exchange_.counters().fences;
  exchange_.sendRequest(sdo::kRequestUpload, fence_.object(), 0);
}

void SdoClient::initiate(Time now) {
  SdoTransfer& transfer = queue_.front();
  const bool blocks = blocks_.wanted(transfer);
  if (transfer.isUpload()) {
    if (blocks) return wire_.emplace<SdoBlockUpload>(exchange_, transfer).initiate(now);
    return wire_.emplace<SdoUpload>(exchange_, transfer).initiate(now);
  }
  if (blocks) return wire_.emplace<SdoBlockDownload>(exchange_, transfer).initiate(now);
  wire_.emplace<SdoDownload>(exchange_, transfer).initiate(now);
}

bool SdoClient::initiatesBlocks() const {
  if (const auto* upload = std::get_if<SdoBlockUpload>(&wire_)) return upload->initiating();
  const auto* download = std::get_if<SdoBlockDownload>(&wire_);
  return download != nullptr && download->initiating();
}

void SdoClient::receive(const can::Frame& frame, Time now) {
  const bool ours = frame.id == answer_id_ && !frame.extended && !frame.remote && !frame.error;
  // CiA 301, 7.2.4.3: an SDO is always eight bytes long.
  const SdoReaction reaction =
      ours && frame.size == 8 ? dispatch(frame, now) : SdoReaction::stray();
  if (reaction.kind == SdoReaction::Kind::stray) {
    ++exchange_.counters().stray_frames;
    return;
  }
  act(reaction, now);
  exchange_.remember(frame);
}

SdoReaction SdoClient::dispatch(const can::Frame& frame, Time now) {
  if (isIdle()) return SdoReaction::stray();
  if (isAtFence()) return onFenceAnswer(frame, now);
  if (auto* upload = std::get_if<SdoUpload>(&wire_)) return upload->receive(frame, now);
  if (auto* download = std::get_if<SdoDownload>(&wire_)) return download->receive(frame, now);
  if (auto* blocks = std::get_if<SdoBlockDownload>(&wire_)) return blocks->receive(frame, now);
  const SdoReaction reaction = std::get<SdoBlockUpload>(wire_).receive(frame, now);
  if (reaction.kind != SdoReaction::Kind::ordinary) return reaction;
  return wire_.emplace<SdoUpload>(exchange_, queue_.front()).receive(frame, now);
}

/// Everything that comes before it is the past of an abandoned transfer.
SdoReaction SdoClient::onFenceAnswer(const can::Frame& frame, Time now) {
  if (!fence_.isAnswer(frame)) return SdoReaction::stray();
  exchange_.answered(now);
  if (fence_.pass()) {
    initiate(now);
  } else {
    sendFence(now);
  }
  return SdoReaction::taken();
}

std::string SdoClient::refusalText(std::uint32_t abort_code) const {
  std::string text = "the drive refused: " + abortText(abort_code);
  const bool forbidden = !queue_.front().isUpload() && abort_code::saysForbidden(abort_code);
  if (forbidden && !lock_.empty()) append(text, lock_);
  return text;
}

void SdoClient::act(const SdoReaction& reaction, Time now) {
  switch (reaction.kind) {
    case SdoReaction::Kind::completed:
      return succeed(now);
    case SdoReaction::Kind::refused:
      exchange_.answered(now);
      if (initiatesBlocks() && blocks_.refused(reaction.code)) return initiate(now);
      return fail(Failure::aborted_by_server, reaction.code, refusalText(reaction.code), now);
    case SdoReaction::Kind::broken:
      abandon(reaction.code);
      return fail(Failure::protocol_error, reaction.code,
                  "the answer breaks the SDO protocol: " + reaction.why + "; aborted with " +
                      abortText(reaction.code),
                  now);
    case SdoReaction::Kind::stray:
    case SdoReaction::Kind::taken:
    case SdoReaction::Kind::ordinary:
      return;
  }
}

/// Tells the server that the transfer on the wire is given up; its answer may still be under way.
void SdoClient::abandon(std::uint32_t abort_code) {
  const ObjectId object = queue_.front().object();
  exchange_.sendRequest(sdo::kAbort, object, abort_code);
  const auto* upload = std::get_if<SdoBlockUpload>(&wire_);
  fence_.abandon(object, upload != nullptr && upload->looksLikeAnything());
}

bool SdoClient::resumes(Time now) {
  auto* upload = std::get_if<SdoBlockUpload>(&wire_);
  return upload != nullptr && upload->resume(now);
}

void SdoClient::onTimeout(Time now) {
  ++exchange_.counters().timeouts;
  if (resumes(now)) return;
  if (isAtFence()) {
    // The first abort may have been lost, and a server in the middle of a block takes all for data.
    exchange_.sendRequest(sdo::kAbort, fence_.abandoned(), abort_code::kTimeout);
  } else {
    abandon(abort_code::kTimeout);
  }
  if (initiatesBlocks()) blocks_.unanswered();
  if (attempt_ > queue_.front().options().retries) return giveUp(now);
  ++exchange_.counters().retries;
  attempt(now);
}

void SdoClient::giveUp(Time now) {
  const SdoOptions& options = queue_.front().options();
  const bool at_fence = isAtFence();
  const bool answers_others = attempt_ > 1 && !at_fence;  // the fence before the last request
  if (answers_others && options.silence_is_missing) {
    return fail(Failure::aborted_by_server, abort_code::kNoSuchObject,
                "no answer to " + std::to_string(attempt_) +
                    " requests, though the drive answers for other objects: it counts as missing",
                now);
  }
  std::string reason = "no answer within " + milliseconds(options.timeout);
  if (attempt_ > 1) reason += ", asked " + std::to_string(attempt_) + " times";
  if (at_fence && attempt_ == 1) reason += ", the device has been silent since an earlier request";
  fail(Failure::timed_out, abort_code::kTimeout, std::move(reason), now);
}

void SdoClient::succeed(Time now) {
  SdoTransfer& transfer = queue_.front();
  ++exchange_.counters().completed;
  exchange_.counters().bytes += transfer.data().size();
  exchange_.counters().busy += std::max(now - started_at_, Duration::zero());
  blocks_.succeeded();
  wire_ = Idle();
  if (half_floats_.has(transfer.object())) {
    transfer.setData(half_floats_.widened(transfer.object(), transfer.data()));
  } else {
    transfer.setData(widths_.fromDrive(transfer.object(), transfer.data()));
  }
  transfer.succeed();
  if (written_ && !transfer.isUpload()) written_(transfer.object(), transfer.data());
  queue_.pop();
  startNext(now);
}

void SdoClient::fail(Failure failure, std::uint32_t code, std::string reason, Time now) {
  if (failure != Failure::timed_out) ++exchange_.counters().aborted;
  wire_ = Idle();
  queue_.front().fail(node_, failure, code, std::move(reason));
  queue_.pop();
  startNext(now);
}

void SdoClient::cancelAll(const std::string& reason) {
  if (!isIdle() && !isAtFence()) abandon(abort_code::kGeneral);
  wire_ = Idle();
  queue_.cancelAll(node_, reason);
}

void SdoClient::serverRestarted() {
  fence_.clear();
  blocks_.serverRestarted();
}

}  // namespace cia402::canopen
