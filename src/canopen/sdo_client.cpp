// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/sdo_client.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include "cia402_driver/canopen/abort_code.h"

namespace cia402::canopen {
namespace {

// Command specifiers of CiA 301, 7.2.4.3: bits 7..5 of the first byte.
constexpr std::uint8_t kRequestUpload = 0x40;
constexpr std::uint8_t kRequestDownloadSegmented = 0x21;  // size indicated
constexpr std::uint8_t kRequestDownloadExpedited = 0x23;  // size indicated
constexpr std::uint8_t kAbort = 0x80;

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

SdoClient::SdoClient(NodeId node, can::Sink& sink, SdoOptions defaults)
    : node_(node), sink_(sink), defaults_(defaults) {}

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

SdoTicket SdoClient::enqueue(Transfer transfer, const std::optional<SdoOptions>& options) {
  transfer->options_ = options.value_or(defaults_);
  queue_.push_back(transfer);
  return transfer;
}

void SdoClient::tick(Time now) {
  if (phase_ == Phase::idle) {
    startNext(now);
  } else if (now >= deadline_) {
    onTimeout(now);
  }
}

Time SdoClient::nextDeadline() const {
  if (phase_ != Phase::idle) return deadline_;
  return queue_.empty() ? kNever : std::max(kAtOnce, held_until_);
}

bool SdoClient::idle() const { return queue_.empty(); }

void SdoClient::startNext(Time now) {
  if (queue_.empty() || now < held_until_) return;
  attempt_ = 0;
  initiate(now);
}

void SdoClient::initiate(Time now) {
  const SdoTransfer& transfer = *queue_.front();
  ++attempt_;
  toggle_ = false;
  offset_ = 0;
  announced_.reset();
  received_.clear();
  if (transfer.direction_ == SdoTransfer::Direction::upload) {
    sendInitiate(kRequestUpload, 0);
    await(Phase::upload_initiate, now);
    return;
  }
  const std::size_t size = transfer.data_.size();
  if (size >= 1 && size <= 4) {
    const auto unused = static_cast<std::uint8_t>((4 - size) << 2);
    sendInitiate(static_cast<std::uint8_t>(kRequestDownloadExpedited | unused),
                 static_cast<std::uint32_t>(toUnsigned(transfer.data_)));
  } else {
    sendInitiate(kRequestDownloadSegmented, static_cast<std::uint32_t>(size));
  }
  await(Phase::download_initiate, now);
}

void SdoClient::await(Phase phase, Time now) {
  phase_ = phase;
  deadline_ = now + queue_.front()->options_.timeout;
}

void SdoClient::sendInitiate(std::uint8_t command, std::uint32_t data) {
  const ObjectId object = queue_.front()->object_;
  sink_.send(
      can::Frame(0x600U + node_,
                 {command, static_cast<std::uint8_t>(object.index),
                  static_cast<std::uint8_t>(object.index >> 8), object.subindex,
                  static_cast<std::uint8_t>(data), static_cast<std::uint8_t>(data >> 8),
                  static_cast<std::uint8_t>(data >> 16), static_cast<std::uint8_t>(data >> 24)}));
}

void SdoClient::sendAbort(std::uint32_t code) { sendInitiate(kAbort, code); }

void SdoClient::onTimeout(Time now) {
  const SdoOptions options = queue_.front()->options_;
  ++counters_.timeouts;
  sendAbort(abort_code::kTimeout);
  if (attempt_ <= options.retries) {
    ++counters_.retries;
    initiate(now);
    return;
  }
  std::string reason = "no answer within " + milliseconds(options.timeout);
  if (attempt_ > 1) reason += ", asked " + std::to_string(attempt_) + " times";
  fail(SdoTransfer::Failure::timed_out, abort_code::kTimeout, std::move(reason), now);
}

void SdoClient::abortTransfer(std::uint32_t code, const std::string& why, Time now) {
  sendAbort(code);
  fail(SdoTransfer::Failure::protocol_error, code,
       "the answer breaks the SDO protocol: " + why + "; aborted with " + abortText(code), now);
}

void SdoClient::succeed(Time now) {
  ++counters_.completed;
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
  if (phase_ != Phase::idle) sendAbort(abort_code::kGeneral);
  phase_ = Phase::idle;
  for (const Transfer& transfer : queue_) {
    finish(*transfer, SdoTransfer::Failure::cancelled, 0, "cancelled: " + reason);
  }
  queue_.clear();
}

std::uint64_t toUnsigned(const Bytes& bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 8); ++i) {
    value |= static_cast<std::uint64_t>(bytes[i]) << (8 * i);
  }
  return value;
}

Bytes toBytes(std::uint64_t value, unsigned size) {
  Bytes bytes(std::min(size, 8U));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  return bytes;
}

}  // namespace cia402::canopen
