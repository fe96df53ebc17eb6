// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cia402_driver/common/time.h"
#include "drive/fake_drive.h"
#include "fieldbus/abort_code.h"
#include "fieldbus/object_access.h"

namespace cia402::drive::test {

/// A read or write of an object of a FakeDrive.
class FakeTransfer final : public fieldbus::Transfer {
 public:
  FakeTransfer(fieldbus::ObjectId object, std::string name, Direction direction,
               fieldbus::Bytes data, const fieldbus::AccessOptions& its_options)
      : options(its_options) {
    object_ = object;
    name_ = std::move(name);
    direction_ = direction;
    data_ = std::move(data);
  }

  void succeed(const fieldbus::Bytes& read) {
    done_ = true;
    if (direction_ == Direction::upload) data_ = read;
  }
  void fail(Failure failure, std::uint32_t code, std::string reason) {
    done_ = true;
    failure_ = failure;
    abort_code_ = code;
    reason_ = std::move(reason);
    message_ = "node 3, object " + toString(object_) + (name_.empty() ? "" : " " + name_);
    message_ += direction_ == Direction::upload ? std::string(", read") : ", write" + bytesText();
    message_ += ": " + reason_;
  }

  const fieldbus::AccessOptions options;
  bool urgent = false;

 private:
  std::string bytesText() const {
    std::string text;
    for (const std::uint8_t byte : data_) {
      std::array<char, 4> digits{};
      std::snprintf(digits.data(), digits.size(), " %02X", unsigned{byte});
      text += digits.data();
    }
    return text;
  }
};

/// The queue of transfers of a FakeDrive. A drive that does not answer is asked again until the
/// transfer's retries are used up.
class FakeObjects final : public fieldbus::ObjectAccess {
 public:
  using Failure = fieldbus::Transfer::Failure;
  using Direction = fieldbus::Transfer::Direction;

  explicit FakeObjects(FakeDrive& drive) : drive_(drive) {}

  fieldbus::Ticket downloadUrgent(fieldbus::ObjectId object, fieldbus::Bytes data,
                                  const std::string& name) override {
    const auto transfer = std::make_shared<FakeTransfer>(object, name, Direction::download,
                                                         std::move(data), defaults);
    transfer->urgent = true;
    if (attempts_ > 0 && !queue_.front()->urgent) {
      end(Failure::cancelled, 0,
          "cancelled: it made way for an urgent write to " + toString(object) +
              (name.empty() ? "" : " " + name));
    }
    const auto place = std::find_if(queue_.begin(), queue_.end(),
                                    [](const auto& queued) { return !queued->urgent; });
    queue_.insert(place, transfer);
    return transfer;
  }
  bool idle() const override { return queue_.empty(); }

  /// Asks the drive for what is queued, and takes its answers.
  void work(Time now) {
    while (!queue_.empty()) {
      if (attempts_ > 0 && now < deadline_) return;
      if (attempts_ > queue_.front()->options.retries) {
        timeOut();
      } else {
        ask(now);
      }
    }
  }
  /// The drive answers for `object` in the end, which was written in silence.
  void confirm(fieldbus::ObjectId object) {
    if (attempts_ > 0 && queue_.front()->object() == object) succeed({});
  }
  void cancelAll(const std::string& why) {
    while (!queue_.empty()) end(Failure::cancelled, 0, "cancelled: " + why);
  }
  /// Transfers that succeeded so far.
  std::size_t completed() const { return completed_; }

  const fieldbus::AccessOptions defaults;  ///< of transfers that are asked for without

 private:
  fieldbus::Ticket queueUpload(fieldbus::ObjectId object, std::string name,
                               const std::optional<fieldbus::AccessOptions>& options) override {
    return enqueue(object, std::move(name), Direction::upload, {}, options);
  }
  fieldbus::Ticket queueDownload(fieldbus::ObjectId object, fieldbus::Bytes data, std::string name,
                                 const std::optional<fieldbus::AccessOptions>& options) override {
    return enqueue(object, std::move(name), Direction::download, std::move(data), options);
  }
  fieldbus::Ticket enqueue(fieldbus::ObjectId object, std::string name, Direction direction,
                           fieldbus::Bytes data,
                           const std::optional<fieldbus::AccessOptions>& options) {
    queue_.push_back(std::make_shared<FakeTransfer>(object, std::move(name), direction,
                                                    std::move(data), options.value_or(defaults)));
    return queue_.back();
  }

  void ask(Time now) {
    ++attempts_;
    const FakeTransfer& transfer = *queue_.front();
    deadline_ = now + transfer.options.timeout;
    const std::optional<Answer> answer = transfer.direction() == Direction::upload
                                             ? drive_.read(transfer.object())
                                             : drive_.write(transfer.object(), transfer.data());
    if (!answer) return;
    if (answer->abort == 0) return succeed(answer->data);
    end(Failure::aborted_by_server, answer->abort,
        "the drive refused: " + fieldbus::abortText(answer->abort));
  }
  void timeOut() {
    const fieldbus::AccessOptions& options = queue_.front()->options;
    const std::string times = std::to_string(attempts_);
    const bool answers_others = !drive_.dead && !drive_.mute;
    if (attempts_ > 1 && answers_others && options.silence_is_missing) {
      return end(Failure::aborted_by_server, fieldbus::abort_code::kNoSuchObject,
                 "no answer to " + times +
                     " requests, though the drive answers for other objects: it counts as missing");
    }
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(options.timeout);
    end(Failure::timed_out, fieldbus::abort_code::kTimeout,
        "no answer within " + std::to_string(ms.count()) + " ms" +
            (attempts_ > 1 ? ", asked " + times + " times" : ""));
  }
  void succeed(const fieldbus::Bytes& data) {
    ++completed_;
    take()->succeed(data);
  }
  void end(Failure failure, std::uint32_t code, std::string reason) {
    take()->fail(failure, code, std::move(reason));
  }
  /// The first of the queue is over.
  std::shared_ptr<FakeTransfer> take() {
    const auto transfer = queue_.front();
    queue_.pop_front();
    attempts_ = 0;
    return transfer;
  }

  FakeDrive& drive_;
  std::deque<std::shared_ptr<FakeTransfer>> queue_;
  int attempts_ = 0;  ///< of the first one; 0: it was not asked for yet
  Time deadline_{};   ///< of the drive's answer to that
  std::size_t completed_ = 0;
};

}  // namespace cia402::drive::test
