// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/sdo_cycle.h"

#include <algorithm>
#include <utility>

namespace cia402::canopen {
namespace {

constexpr std::size_t kMostWrites = 16;  // that wait: beyond, an older one is made the newest
constexpr unsigned kBitsOfByte = 8;
constexpr std::uint64_t kMuteTimeouts = 2;  // one after the other

/// By which the node has shown that it is there.
std::uint64_t answersOf(const SdoCounters& counters) {
  return counters.completed + counters.aborted + counters.answers;
}

}  // namespace

SdoCycle::SdoCycle(const NodeConfig& config, PdoImage& image, SdoClient& sdo)
    : config_(config), image_(image), sdo_(sdo) {
  for (const PdoConfig& pdo : config.by_sdo) {
    const PdoEntry& entry = pdo.entries.front();
    const auto bytes = static_cast<std::uint8_t>(entry.bits / kBitsOfByte);
    if (pdo.direction == PdoDirection::tpdo) {
      inputs_.push_back({entry.object, bytes, image.inputSlot(entry.object)});
    } else {
      outputs_.push_back({{entry.object, bytes, image.outputSlot(entry.object)}});
    }
  }
}

void SdoCycle::start() {
  running_ = !inputs_.empty();
  mute_ = false;
  answers_ = answersOf(sdo_.counters());
  timeouts_ = sdo_.counters().timeouts;
  turn_ = 0;
  writes_.clear();
  ticket_.reset();
  for (Output& output : outputs_) output.known = output.held = false;
}

void SdoCycle::stop() {
  running_ = mute_ = false;
  writes_.clear();
  ticket_.reset();
}

/// The first of them, the controlword, is the last to be written: what it hands over is there then.
void SdoCycle::outputsSet(Time now) {
  if (!running_) return;
  for (std::size_t i = outputs_.size(); i-- > 0;) {
    const std::uint64_t raw = image_.output(outputs_[i].slot);
    if (!outputs_[i].known || outputs_[i].queued != raw) {
      queue(i, raw);
    } else if (outputs_[i].held) {
      image_.leftAlone(i);  // what the drive holds need not be written to be there
    }
  }
  advance(now);
}

/// A stream takes the place of what waits; edges of another object between its values stay in their
/// order. A stop goes before all that waits.
void SdoCycle::queue(std::size_t output, std::uint64_t raw) {
  outputs_[output].queued = raw;
  outputs_[output].known = true;
  outputs_[output].held = false;
  const Write write{output, raw};
  if (isStop(write)) {
    writes_.clear();
    for (Output& other : outputs_) other.known = &other == &outputs_[output];
    const Value& value = outputs_[output];
    reading_ = false;
    item_ = output;
    ticket_ = sdo_.downloadUrgent(value.object, toBytes(raw, value.bytes), "controlword");
    return;
  }
  const bool last = !writes_.empty() && writes_.back().output == output;
  if (last) {
    writes_.back() = write;
    return;
  }
  if (writes_.size() >= kMostWrites) {
    const auto older = std::find_if(writes_.begin(), writes_.end(),
                                    [output](const Write& w) { return w.output == output; });
    writes_.erase(older == writes_.end() ? writes_.begin() : older);
  }
  writes_.push_back(write);
}

/// What stops the drive before it is configured stops it here, too; so does 0, which takes the
/// power off.
bool SdoCycle::isStop(const Write& write) const {
  const Value& value = outputs_[write.output];
  return std::any_of(config_.writes.begin(), config_.writes.end(), [&](const StartupWrite& stop) {
    return stop.always && stop.object == value.object &&
           (write.raw == 0 || write.raw == toUnsigned(stop.data));
  });
}

void SdoCycle::advance(Time now) {
  if (!running_) return;
  listen();
  if (ticket_ && ticket_->done()) finish(now);
  if (!ticket_) next();
  sdo_.tick(now);
}

/// Whatever is asked for, and whoever asks: one answer in so many requests shows that it is there.
void SdoCycle::listen() {
  const SdoCounters& counters = sdo_.counters();
  const std::uint64_t answers = answersOf(counters);
  if (answers != answers_) timeouts_ = counters.timeouts;
  answers_ = answers;
  mute_ = counters.timeouts >= timeouts_ + kMuteTimeouts;
}

void SdoCycle::finish(Time now) {
  const SdoTicket ticket = std::exchange(ticket_, {});
  if (!reading_) {
    const bool newest = std::none_of(writes_.begin(), writes_.end(),
                                     [this](const Write& w) { return w.output == item_; });
    if (ticket->ok()) {
      outputs_[item_].held = newest;
    } else {
      outputs_[item_].known = false;  // it is written once more
    }
    return;
  }
  const Value& value = inputs_[item_];
  if (!ticket->ok() || ticket->data().size() < value.bytes) return;
  const Bytes& data = ticket->data();
  image_.takeAlone(item_, toUnsigned(Bytes(data.begin(), data.begin() + value.bytes)), now);
}

void SdoCycle::next() {
  if (!writes_.empty()) {
    const Write write = writes_.front();
    writes_.pop_front();
    reading_ = false;
    item_ = write.output;
    const Value& value = outputs_[item_];
    ticket_ = sdo_.download(value.object, toBytes(write.raw, value.bytes), "output");
    return;
  }
  reading_ = true;
  item_ = turn_;
  turn_ = (turn_ + 1) % inputs_.size();
  ticket_ = sdo_.upload(inputs_[item_].object, "input");
}

}  // namespace cia402::canopen
