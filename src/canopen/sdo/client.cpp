// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/sdo/client.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "canopen/sdo/block.h"
#include "cia402_driver/fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

// Client command specifiers and flags of CiA 301, 7.2.4.3: the first byte.
constexpr std::uint8_t kRequestUpload = 0x40;
constexpr std::uint8_t kRequestDownloadSegmented = 0x21;  // size indicated
constexpr std::uint8_t kRequestDownloadExpedited = 0x23;  // size indicated
constexpr std::uint8_t kRequestBlockUpload = 0xA4;        // CRC supported
constexpr std::uint8_t kRequestBlockDownload = 0xC6;      // CRC supported, size indicated
constexpr std::uint8_t kAbort = 0x80;
constexpr std::size_t kMostExpedited = 4;  // bytes in the request itself

/// Command of an expedited download of 1 to 4 bytes.
std::uint8_t expedited(std::size_t size) {
  return static_cast<std::uint8_t>(kRequestDownloadExpedited | (kMostExpedited - size) << 2U);
}

/// Up to here the server may answer a block upload by an ordinary one: that is fewer frames.
constexpr std::uint32_t kSwitchThreshold = 28;  // bytes

// Both never change while the device runs, so that even a late answer would be right.
constexpr ObjectId kDeviceType{0x1000, 0}, kIdentityCount{0x1018, 0};

constexpr Time kAtOnce{};  // the beginning of time, but no number that overflows in a subtraction

std::string hexBytes(const Bytes& bytes) {
  constexpr std::size_t kShown = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(bytes.size(), kShown); ++i) {
    std::array<char, 4> byte{};
    std::snprintf(byte.data(), byte.size(), i == 0 ? "%02X" : " %02X",
                  static_cast<unsigned>(bytes[i]));
    text += byte.data();
  }
  if (bytes.size() > kShown) text += " ... (" + std::to_string(bytes.size()) + " bytes)";
  return text;
}

std::string milliseconds(Duration duration) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration);
  return std::to_string(ms.count()) + " ms";
}

}  // namespace

SdoClient::SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults, SdoChannel channel,
                     can::Pacer* pacer)
    : node_(node),
      sink_(sink),
      pacer_(pacer),
      defaults_(defaults),
      request_id_(channel.request != 0 ? channel.request : 0x600U + node),
      answer_id_(channel.answer != 0 ? channel.answer : 0x580U + node) {}

SdoTicket SdoClient::upload(ObjectId object, std::string name, std::optional<SdoOptions> options) {
  auto transfer = std::make_shared<SdoTransfer>();
  transfer->object_ = object;
  transfer->name_ = std::move(name);
  return enqueue(std::move(transfer), options);
}

SdoTicket SdoClient::download(ObjectId object, Bytes data, std::string name,
                              std::optional<SdoOptions> options) {
  auto transfer = std::make_shared<SdoTransfer>();
  transfer->object_ = object;
  transfer->name_ = std::move(name);
  transfer->direction_ = SdoTransfer::Direction::download;
  transfer->data_ = std::move(data);
  return enqueue(std::move(transfer), options);
}

SdoTicket SdoClient::downloadUrgent(ObjectId object, Bytes data, const std::string& name) {
  auto transfer = std::make_shared<SdoTransfer>();
  transfer->object_ = object;
  transfer->name_ = name;
  transfer->direction_ = SdoTransfer::Direction::download;
  transfer->data_ = std::move(data);
  transfer->urgent_ = true;
  makeWay(toString(object) + (name.empty() ? "" : " " + name));
  return enqueue(std::move(transfer), {});
}

bool SdoClient::post(ObjectId object, const Bytes& data) {
  if (phase_ != Phase::idle || data.empty() || data.size() > kMostExpedited) return false;
  sendRequest(expedited(data.size()), object, static_cast<std::uint32_t>(toUnsigned(data)));
  if (!abandoned_) {  // else the fence that is due holds this answer back as well
    abandoned_ = object;
    fences_left_ = 1;
  }
  return true;
}

/// The transfer on the wire, unless it is urgent itself, is none any more.
void SdoClient::makeWay(const std::string& urgent) {
  if (phase_ == Phase::idle || queue_.front()->urgent_) return;
  if (phase_ == Phase::fence) {  // nothing of the transfer itself was sent: it can wait
    attempt_ = 1;
    fell_back_ = false;
    return;
  }
  sendAbort(abort_code::kGeneral);
  abandon();
  finish(*queue_.front(), SdoTransfer::Failure::cancelled, 0,
         "cancelled: it made way for an urgent write to " + urgent);
  queue_.pop_front();
  phase_ = Phase::idle;
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

SdoTicket SdoClient::enqueue(Transfer transfer, const std::optional<SdoOptions>& options) {
  transfer->options_ = options.value_or(defaults_);
  const auto place = transfer->urgent_
                         ? std::find_if(queue_.begin(), queue_.end(),
                                        [](const Transfer& queued) { return !queued->urgent_; })
                         : queue_.end();
  queue_.insert(place, transfer);
  if (queued_ != nullptr) *queued_ = true;
  return transfer;
}

void SdoClient::tick(Time now) {
  if (phase_ == Phase::idle) {
    startNext(now);
  } else if (phase_ == Phase::block_download_segments && now >= feed_at_) {
    feedBlock(now);
  } else if (now >= deadline_) {
    onTimeout(now);
  }
}

Time SdoClient::nextDeadline() const {
  if (phase_ == Phase::block_download_segments) return std::min(deadline_, feed_at_);
  if (phase_ != Phase::idle) return deadline_;
  if (queue_.empty()) return kNever;
  return queue_.front()->urgent_ ? kAtOnce : std::max(kAtOnce, held_until_);
}

bool SdoClient::idle() const { return queue_.empty(); }

void SdoClient::startNext(Time now) {
  if (queue_.empty() || (now < held_until_ && !queue_.front()->urgent_)) return;
  attempt_ = 0;
  fell_back_ = false;
  started_at_ = now;
  attempt(now);
}

void SdoClient::attempt(Time now) {
  ++attempt_;
  if (abandoned_) {
    sendFence(now);
  } else {
    initiate(now);
  }
}

void SdoClient::initiate(Time now) {
  toggle_ = false;
  offset_ = 0;
  announced_.reset();
  received_.clear();
  block_ = Block();
  if (queue_.front()->direction_ == SdoTransfer::Direction::upload) {
    initiateUpload(now);
  } else {
    initiateDownload(now);
  }
}

bool SdoClient::wantsBlock() const {
  const SdoTransfer& transfer = *queue_.front();
  if (fell_back_ || block_refused_) return false;
  const bool upload = transfer.direction_ == SdoTransfer::Direction::upload;
  switch (transfer.options_.block) {
    case SdoOptions::Block::never:
      return false;
    case SdoOptions::Block::automatic:
      return !upload && transfer.data_.size() > transfer.options_.block_threshold;
    case SdoOptions::Block::always:
      return upload || !transfer.data_.empty();
  }
  return false;
}

void SdoClient::initiateUpload(Time now) {
  if (wantsBlock()) {
    sendInitiate(kRequestBlockUpload,
                 std::uint32_t{sdo_block::kMostSegments} | kSwitchThreshold << 8U);
    await(Phase::block_upload_initiate, now);
  } else {
    sendInitiate(kRequestUpload, 0);
    await(Phase::upload_initiate, now);
  }
}

void SdoClient::initiateDownload(Time now) {
  const Bytes& data = queue_.front()->data_;
  const auto size = static_cast<std::uint32_t>(data.size());
  if (wantsBlock()) {
    sendInitiate(kRequestBlockDownload, size);
    await(Phase::block_download_initiate, now);
    return;
  }
  if (size >= 1 && size <= kMostExpedited) {
    sendInitiate(expedited(size), static_cast<std::uint32_t>(toUnsigned(data)));
  } else {
    sendInitiate(kRequestDownloadSegmented, size);
  }
  await(Phase::download_initiate, now);
}

void SdoClient::await(Phase phase, Time now) {
  phase_ = phase;
  asked_at_ = now;
  deadline_ = now + queue_.front()->options_.timeout;
}

void SdoClient::answered(Time now) {
  const Duration latency = std::max(now - asked_at_, Duration::zero());
  ++counters_.answers;
  counters_.last_latency = latency;
  counters_.longest_latency = std::max(counters_.longest_latency, latency);
  counters_.total_latency += latency;
  repetition_seen_ = false;
}

void SdoClient::sendRequest(std::uint8_t command, ObjectId object, std::uint32_t data) {
  sink_.send(can::Frame(
      request_id_, {command, static_cast<std::uint8_t>(object.index),
                    static_cast<std::uint8_t>(object.index >> 8), object.subindex,
                    static_cast<std::uint8_t>(data), static_cast<std::uint8_t>(data >> 8),
                    static_cast<std::uint8_t>(data >> 16), static_cast<std::uint8_t>(data >> 24)}));
}

void SdoClient::sendInitiate(std::uint8_t command, std::uint32_t data) {
  sendRequest(command, queue_.front()->object_, data);
}

void SdoClient::sendAbort(std::uint32_t code) { sendInitiate(kAbort, code); }

/// The transfer on the wire is given up, but its answer may still be under way.
void SdoClient::abandon() {
  abandoned_ = queue_.front()->object_;
  // Segments of a block upload carry data behind a first byte that can be any: one of them could
  // look like the answer to a read, hardly like that to one and later like that to another.
  const bool anything = phase_ == Phase::block_upload_segments || phase_ == Phase::block_upload_end;
  fences_left_ = anything ? 2 : 1;
}

ObjectId SdoClient::fenceObject() const {
  const bool other = abandoned_->index == kDeviceType.index || fences_left_ > 1;
  return other && abandoned_->index != kIdentityCount.index ? kIdentityCount : kDeviceType;
}

void SdoClient::sendFence(Time now) {
  ++counters_.fences;
  sendRequest(kRequestUpload, fenceObject(), 0);
  await(Phase::fence, now);
}

void SdoClient::serverRestarted() {
  abandoned_.reset();
  block_refused_ = false;
}

void SdoClient::onTimeout(Time now) {
  const SdoOptions options = queue_.front()->options_;
  ++counters_.timeouts;
  if (resumeBlockUpload(now)) return;
  const bool at_fence = phase_ == Phase::fence;
  if (at_fence) {
    // The first abort may have been lost, and a server in the middle of a block takes all for data.
    sendRequest(kAbort, *abandoned_, abort_code::kTimeout);
  } else {
    sendAbort(abort_code::kTimeout);
    abandon();
  }
  // Servers without block transfer should refuse it, but some do not answer at all.
  if (phase_ == Phase::block_download_initiate || phase_ == Phase::block_upload_initiate) {
    fell_back_ = true;
  }
  if (attempt_ <= options.retries) {
    ++counters_.retries;
    attempt(now);
    return;
  }
  const bool answers_others = attempt_ > 1 && !at_fence;  // the fence before the last request
  if (answers_others && options.silence_is_missing) {
    fail(SdoTransfer::Failure::aborted_by_server, abort_code::kNoSuchObject,
         "no answer to " + std::to_string(attempt_) +
             " requests, though the drive answers for other objects: it counts as missing",
         now);
    return;
  }
  std::string reason = "no answer within " + milliseconds(options.timeout);
  if (attempt_ > 1) reason += ", asked " + std::to_string(attempt_) + " times";
  if (at_fence && attempt_ == 1) reason += ", the device has been silent since an earlier request";
  fail(SdoTransfer::Failure::timed_out, abort_code::kTimeout, std::move(reason), now);
}

void SdoClient::abortTransfer(std::uint32_t code, const std::string& why, Time now) {
  sendAbort(code);
  abandon();
  fail(SdoTransfer::Failure::protocol_error, code,
       "the answer breaks the SDO protocol: " + why + "; aborted with " + abortText(code), now);
}

void SdoClient::succeed(Time now) {
  ++counters_.completed;
  counters_.bytes += queue_.front()->data_.size();
  counters_.busy += std::max(now - started_at_, Duration::zero());
  block_refused_ = block_refused_ || fell_back_;
  finish(*queue_.front(), SdoTransfer::Failure::none, 0, {});
  queue_.pop_front();
  phase_ = Phase::idle;
  startNext(now);
}

void SdoClient::fail(SdoTransfer::Failure failure, std::uint32_t code, std::string reason,
                     Time now) {
  if (failure != SdoTransfer::Failure::timed_out) ++counters_.aborted;
  finish(*queue_.front(), failure, code, std::move(reason));
  queue_.pop_front();
  phase_ = Phase::idle;
  startNext(now);
}

void SdoClient::finish(SdoTransfer& transfer, SdoTransfer::Failure failure, std::uint32_t code,
                       std::string reason) {
  transfer.done_ = true;
  transfer.failure_ = failure;
  transfer.abort_code_ = code;
  if (failure == SdoTransfer::Failure::none) return;
  transfer.reason_ = std::move(reason);
  std::string what = "node " + std::to_string(node_) + ", object " + toString(transfer.object_);
  if (!transfer.name_.empty()) what += " " + transfer.name_;
  what += transfer.direction_ == SdoTransfer::Direction::upload
              ? std::string(", read")
              : ", write " + hexBytes(transfer.data_);
  transfer.message_ = what + ": " + transfer.reason_;
}

void SdoClient::cancelAll(const std::string& reason) {
  if (phase_ != Phase::idle && phase_ != Phase::fence) {
    sendAbort(abort_code::kGeneral);
    abandon();
  }
  phase_ = Phase::idle;
  for (const Transfer& transfer : queue_) {
    finish(*transfer, SdoTransfer::Failure::cancelled, 0, "cancelled: " + reason);
  }
  queue_.clear();
}

}  // namespace cia402::canopen
