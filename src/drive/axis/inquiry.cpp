// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/axis/inquiry.h"

#include <algorithm>
#include <array>
#include <utility>

#include "common/text.h"
#include "drive/profile/fault_text.h"
#include "drive/profile/object_value.h"
#include "drive/sentence.h"

namespace cia402::drive {
namespace {

constexpr ObjectId kDeviceErrors{0x1001, 0};
constexpr int kAllDigits = 10;            // of 32 bits
constexpr std::size_t kLongNotice = 200;  // as much as people read in one

/// CiA 301, 1001h.
std::string registerText(std::uint64_t bits) {
  constexpr std::array<const char*, 8> kNames = {"generic",        "current",        "voltage",
                                                 "temperature",    "communication",  "profile",
                                                 "reserved bit 6", "the maker's own"};
  std::string text;
  for (std::size_t bit = 0; bit < kNames.size(); ++bit) {
    if (((bits >> bit) & 1U) != 0) append(text, kNames[bit], ", ");
  }
  return text.empty() ? "no error" : text;
}

}  // namespace

Inquiry::Inquiry(AxisCore& axis) : axis_(axis) {
  const DriveProfile& profile = axis.profile();
  for (const ValueWatch& watch : profile.supervision.watches) {
    const ObjectSpec* object = profile.find(watch.object);
    if (object != nullptr && !saidToLack(axis.config(), watch.object)) {
      watched_.push_back({&watch, object, false});
    }
  }
  for (const std::string& name : profile.supervision.fault_reads) {
    const ObjectSpec* object = findObject(profile, name);
    const auto id = object != nullptr ? std::optional<ObjectId>(object->id)
                                      : fieldbus::parseObjectAddress(name);
    if (id && !saidToLack(axis.config(), name)) {
      at_fault_.push_back({*id, object != nullptr ? object->name : std::string()});
    }
  }
  for (const std::string& name : profile.supervision.boot_reads) {
    if (!saidToLack(axis.config(), name)) at_boot_.push_back(profile.find(name));
  }
  const bool zero = std::any_of(profile.errors.begin(), profile.errors.end(),
                                [](const auto& error) { return error.second.loses_zero; });
  concerned_ = !watched_.empty() || !at_fault_.empty() || !at_boot_.empty() || zero;
}

void Inquiry::step(Time now) {
  if (!axis_.deviceReady()) {
    ticket_.reset();
    next_ = fault_next_ = boot_next_ = 0;
    described_ = zero_minded_ = false;
    introduction_.clear();
    return;
  }
  mindZero();
  if (!axis_.faulted()) {
    if (asks_ == Asks::at_fault) ticket_.reset();  // what comes now is of no fault any more
    described_ = false;
    fault_next_ = 0;
    description_.clear();
  }
  if (ticket_) {
    if (!ticket_->done()) return;
    const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
    take(*answer);
  }
  if (!ticket_) tellIntroduction();
  if (!ticket_ && axis_.device().objects().idle()) ask(now);
}

/// With some faults what the drive counts from is gone.
void Inquiry::mindZero() {
  const auto& errors = axis_.profile().errors;
  const auto known = errors.find(axis_.state().error_code);
  const bool lost = axis_.faulted() && known != errors.end() && known->second.loses_zero;
  if (lost && !zero_minded_) axis_.loseZero();
  zero_minded_ = lost;
}

void Inquiry::ask(Time now) {
  const bool fault = axis_.faulted() && !described_ && fault_next_ < at_fault_.size();
  if (fault) {
    const Asked& asked = at_fault_[fault_next_++];
    ticket_ = axis_.device().objects().upload(asked.id, asked.name);
    asks_ = Asks::at_fault;
    return;
  }
  if (boot_next_ < at_boot_.size()) {
    const ObjectSpec& object = *at_boot_[boot_next_++];
    ticket_ = axis_.device().objects().upload(object.id, object.name);
    asks_ = Asks::at_boot;
    return;
  }
  if (watched_.empty() || (next_ == 0 && now < next_round_)) return;
  if (next_ == 0) next_round_ = now + kInterval;
  const ObjectSpec& object = *watched_[next_].object;
  ticket_ = axis_.device().objects().upload(object.id, object.name);
  asks_ = Asks::watched;
}

void Inquiry::take(const fieldbus::Transfer& answer) {
  if (asks_ == Asks::at_boot) return introduce(answer);
  if (asks_ == Asks::watched) {
    Watched& watched = watched_[next_];
    next_ = (next_ + 1) % watched_.size();
    return judge(watched, answer);
  }
  describe(answer);
  if (fault_next_ < at_fault_.size() || !axis_.faulted()) return;
  described_ = true;
  if (!description_.empty()) {
    axis_.notices().notify(axis_.who() + ": at this fault the drive holds " + description_);
  }
}

void Inquiry::judge(Watched& watched, const fieldbus::Transfer& answer) {
  const ObjectSpec& object = *watched.object;
  const auto conversion = Conversion::create(object, axis_.profile(), axis_.config().geometry);
  if (!answer.ok() || answer.data().size() > 8 || !conversion) return;
  const double value = conversion->toJoint(fieldbus::toUnsigned(answer.data()));
  const ValueWatch& watch = *watched.watch;
  const bool outside = value < watch.low || value > watch.high;
  if (outside == std::exchange(watched.outside, outside)) return;
  const std::string is = axis_.who() + ": " + object.name + " (" + fieldbus::toString(object.id) +
                         ") is " + numberText(value);
  const std::string range = numberText(watch.low) + " to " + numberText(watch.high);
  axis_.notices().warn(outside ? is + ", outside " + range + ": " + watch.text + "; " + watch.remedy
                               : is + ", within " + range + " again");
}

/// What cannot be read is passed over.
void Inquiry::introduce(const fieldbus::Transfer& answer) {
  const ObjectSpec& object = *at_boot_[boot_next_ - 1];
  if (answer.ok() && !answer.data().empty() && answer.data().size() <= 8) {
    const std::int64_t number = wholeNumber(object.type, answer.data());
    const double value = static_cast<double>(number) / object.factor;
    const bool in_si = object.quantity == Quantity::current || object.quantity == Quantity::voltage;
    const auto conversion = Conversion::create(object, axis_.profile(), axis_.config().geometry);
    const bool converts = in_si && conversion;
    std::string text = object.name + " (" + fieldbus::toString(object.id) + ") ";
    text += numberText(converts ? conversion->toJoint(fieldbus::toUnsigned(answer.data())) : value,
                       kAllDigits);
    if (converts) text += object.quantity == Quantity::current ? " A" : " V";
    const std::string word = textOf(object.words, number);
    append(introduction_, word.empty() ? text : text + " (" + word + ")", ", ");
  }
}

/// What was read so far, if it is enough or all. Another notice in the same cycle goes before.
void Inquiry::tellIntroduction() {
  const bool calm = notices_ == axis_.notices().count();
  notices_ = axis_.notices().count();
  const bool more = boot_next_ < at_boot_.size() && introduction_.size() < kLongNotice;
  if (!calm || more || introduction_.empty()) return;
  axis_.notices().informOnce(axis_.who() + ": the drive tells of itself: " + introduction_);
  introduction_.clear();
}

void Inquiry::describe(const fieldbus::Transfer& answer) {
  if (!answer.ok() || answer.data().empty() || answer.data().size() > 8) return;
  const Asked& asked = at_fault_[fault_next_ - 1];
  const std::uint64_t number = fieldbus::toUnsigned(answer.data());
  const auto code = static_cast<std::uint16_t>(number);
  std::string text = fieldbus::toString(asked.id) + (asked.name.empty() ? "" : " " + asked.name) +
                     " = " + hexText(number, asked.id == kDeviceErrors ? 2 : 4);
  if (asked.id == kDeviceErrors) {
    text += " (" + registerText(number) + ")";
  } else if (code != 0 && number == code && knowsCode(axis_.profile(), code)) {
    text += " (" + errorName(axis_.profile(), code) + ")";
  }
  append(description_, text, ", ");
}

}  // namespace cia402::drive
