// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/poller.h"

#include <algorithm>
#include <utility>

namespace cia402::drive {

int AxisPoller::add(const Signal& signal, Reading reading) {
  if (reading == Reading::never || signal.spec == nullptr || !signal.spec->readable) return -1;
  if (signal.mapped() && reading == Reading::always) return -1;
  Item item;
  item.object = signal.spec->id;
  item.name = signal.spec->name;
  item.for_looks = reading == Reading::when_looked_at;
  item.wanted = !item.for_looks;
  items_.push_back(std::move(item));
  return static_cast<int>(items_.size()) - 1;
}

void AxisPoller::look(int item) {
  Item& shown = items_[static_cast<std::size_t>(item)];
  if (!shown.for_looks || shown.refused) return;
  shown.wanted = true;
  next_ = std::min(next_, earliest_);
}

void AxisPoller::advance(fieldbus::ObjectAccess& objects, Time now) {
  if (items_.empty()) return;
  if (ticket_) {
    if (!ticket_->done()) return;
    Item& item = items_[current_];
    if (ticket_->ok() && ticket_->data().size() <= 8) {
      item.value = {fieldbus::toUnsigned(ticket_->data()), now, true, true};
    } else if (ticket_->failure() == fieldbus::Transfer::Failure::aborted_by_server) {
      item.refused = true;
    }
    ticket_.reset();
  }
  if (now >= next_ && objects.idle()) ask(objects, now);
}

void AxisPoller::ask(fieldbus::ObjectAccess& objects, Time now) {
  for (std::size_t i = 0; i < items_.size(); ++i) {
    current_ = (current_ + 1) % items_.size();
    Item& item = items_[current_];
    if (!item.due()) continue;
    item.wanted = !item.for_looks;
    ticket_ = objects.upload(item.object, item.name);
    next_ = earliest_ = now + kInterval;
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
  next_ = earliest_ = Time{};
}

void AxisPoller::put(int item, std::uint64_t raw, Time now) {
  if (item >= 0) items_[static_cast<std::size_t>(item)].value = {raw, now, true, true};
}

}  // namespace cia402::drive
