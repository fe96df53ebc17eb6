// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "axis_poller.h"

namespace cia402::drive {

int AxisPoller::add(const InputObject& object) {
  if (object.spec == nullptr || object.mapped() || !object.spec->readable) return -1;
  items_.push_back({object.spec->id, object.spec->name, {}, false});
  return static_cast<int>(items_.size()) - 1;
}

void AxisPoller::advance(canopen::SdoClient& sdo, Time now) {
  if (items_.empty()) return;
  if (ticket_) {
    if (!ticket_->done()) return;
    Item& item = items_[current_];
    if (ticket_->ok() && ticket_->data().size() <= 8) {
      item.value = {canopen::toUnsigned(ticket_->data()), now, true};
    } else if (ticket_->failure() == canopen::SdoTransfer::Failure::aborted_by_server) {
      item.refused = true;
    }
    ticket_.reset();
  }
  if (now >= next_ && sdo.idle()) ask(sdo, now);
}

void AxisPoller::ask(canopen::SdoClient& sdo, Time now) {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    current_ = (current_ + 1) % items_.size();
    if (items_[current_].refused) continue;
    ticket_ = sdo.upload(items_[current_].object, items_[current_].name);
    next_ = now + kInterval;
    return;
  }
  next_ = kNever;
}

void AxisPoller::reset() {
  for (Item& item : items_) {
    item.value.valid = false;
    item.refused = false;
  }
  ticket_.reset();
  next_ = Time{};
}

void AxisPoller::put(int item, std::uint64_t raw, Time now) {
  if (item >= 0) items_[static_cast<std::size_t>(item)].value = {raw, now, true};
}

}  // namespace cia402::drive
