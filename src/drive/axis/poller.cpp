// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/poller.h"

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
  wakeBy(next_);
}

void AxisPoller::advance(fieldbus::ObjectAccess& objects, Time now) {
  forgetOld(now);
  if (ticket_ && ticket_->done()) {
    Item& item = items_[current_];
    if (ticket_->ok() && ticket_->data().size() <= 8) {
      store(item, fieldbus::toUnsigned(ticket_->data()), now);
    } else if (ticket_->failure() == fieldbus::Transfer::Failure::aborted_by_server) {
      item.refused = true;
    }
    ticket_.reset();
  }
  if (ticket_) return;
  if (now >= next_ && objects.idle()) ask(objects, now);
  if (!ticket_) wakeBy(next_);
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

void AxisPoller::store(Item& item, std::uint64_t raw, Time now) {
  item.value = {raw, now, true, true};
  wakeBy(now + item.life() + Duration(1));
}

void AxisPoller::forgetOld(Time now) {
  wake_ = kNever;
  for (Item& item : items_) {
    if (!item.value.fresh) continue;
    const Time old = item.value.stamp + item.life();
    item.value.fresh = now <= old;
    if (item.value.fresh) wakeBy(old + Duration(1));
  }
}

void AxisPoller::reset() {
  for (Item& item : items_) {
    item.value.valid = item.value.fresh = false;
    item.refused = false;
  }
  ticket_.reset();
  next_ = earliest_ = wake_ = Time{};
}

void AxisPoller::put(int item, std::uint64_t raw, Time now) {
  if (item >= 0) store(items_[static_cast<std::size_t>(item)], raw, now);
}

}  // namespace cia402::drive
