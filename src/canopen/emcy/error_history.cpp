// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/emcy/error_history.h"

#include "canopen/object.h"

#include <algorithm>
#include <utility>

#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

constexpr std::uint16_t kErrorHistory = 0x1003;
constexpr const char* kName = "error history";

bool missing(const fieldbus::Transfer& transfer) {
  return transfer.abortCode() == abort_code::kNoSuchObject ||
         transfer.abortCode() == abort_code::kNoSuchSubindex;
}

/// "No data available": as many drives say that there is no error (CiA 301, 7.5.2.6).
bool empty(const fieldbus::Transfer& transfer) {
  return transfer.abortCode() == abort_code::kNoData;
}

}  // namespace

bool ErrorHistoryReader::step(fieldbus::ObjectAccess& objects) {
  if (!ticket_) {
    ask(objects, 0);
    return false;
  }
  if (!ticket_->done()) return false;
  return sub_index_ == 0 ? takeCount(objects) : takeEntry(objects);
}

void ErrorHistoryReader::ask(fieldbus::ObjectAccess& objects, unsigned sub_index) {
  sub_index_ = sub_index;
  ticket_ = objects.upload({kErrorHistory, static_cast<std::uint8_t>(sub_index)}, kName);
}

bool ErrorHistoryReader::end(std::string remark) {
  history_.remark = std::move(remark);
  return true;
}

bool ErrorHistoryReader::takeCount(fieldbus::ObjectAccess& objects) {
  if (empty(*ticket_)) {
    history_.readable = true;
    return true;
  }
  if (!ticket_->ok()) {
    return end(missing(*ticket_) ? "the drive keeps no error history: 1003:00 does not exist"
                                 : "1003:00 not read: " + ticket_->reason());
  }
  const Bytes& data = ticket_->data();
  // CiA 301 wants one byte; drives that send more mean the same number.
  if (data.empty() || data.size() > 4 || toUnsigned(data) > kAll) {
    return end("1003:00 is no number of errors: the drive sent " + std::to_string(data.size()) +
               " bytes" + (data.size() <= 8 ? ", " + std::to_string(toUnsigned(data)) : ""));
  }
  history_.readable = true;
  history_.recorded = static_cast<unsigned>(toUnsigned(data));
  if (history_.recorded == 0) return true;
  ask(objects, 1);
  return false;
}

bool ErrorHistoryReader::takeEntry(fieldbus::ObjectAccess& objects) {
  if (empty(*ticket_)) {  // the number is that of the places then
    history_.recorded = sub_index_ - 1;
    return true;
  }
  if (!ticket_->ok()) {
    const std::string of = " of " + std::to_string(history_.recorded) + " errors";
    return end(
        missing(*ticket_)
            ? "the drive holds " + std::to_string(sub_index_ - 1) + of + " that it counts (1003:00)"
            : "entry " + std::to_string(sub_index_) + of + " not read: " + ticket_->reason());
  }
  const Bytes& data = ticket_->data();
  if (data.size() != 2 && data.size() != 4) {
    return end("entry " + std::to_string(sub_index_) + " of 1003h has " +
               std::to_string(data.size()) + " bytes instead of 4");
  }
  const auto raw = static_cast<std::uint32_t>(toUnsigned(data));
  history_.entries.push_back(
      {static_cast<std::uint16_t>(raw & 0xFFFF), static_cast<std::uint16_t>(raw >> 16), {}, {}});
  if (sub_index_ == std::min(history_.recorded, most_)) return true;
  ask(objects, sub_index_ + 1);
  return false;
}

}  // namespace cia402::canopen
