// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/writes.h"

#include <algorithm>
#include <utility>

#include "common/text.h"
#include "drive/profile/object_value.h"
#include "fieldbus/abort_code.h"

namespace cia402::drive {
namespace {

/// Some drives answer nothing for what they do not have.
fieldbus::AccessOptions ifThere(const fieldbus::Device& device) {
  fieldbus::AccessOptions options = device.times().access;
  options.retries = std::max(options.retries, 2);
  options.silence_is_missing = true;
  return options;
}

/// The drive refused it, as it does not have the object or does not let it be written.
bool lacking(const fieldbus::Transfer& answer) {
  return answer.failure() == fieldbus::Transfer::Failure::aborted_by_server &&
         fieldbus::abort_code::saysLacking(answer.abortCode());
}

}  // namespace

Outcome WriteStep::advance(const Context& context) {
  while (true) {
    if (!ticket_) {
      Outcome problem;
      if (!begin(context, problem)) return problem;
      if (!ticket_) continue;  // nothing configured for this one
    }
    if (!ticket_->done()) return Outcome::running();
    const fieldbus::Ticket answer = std::exchange(ticket_, nullptr);
    if (answer->failure() == fieldbus::Transfer::Failure::cancelled) {
      written_.clear();  // once more: it made way for a stop that was under way already
      continue;
    }
    if (!answer->ok() && !current_.optional && !mayLeaveOut(context, *answer)) {
      return Outcome::failed(context.axis.who() + ": " + answer->message() +
                             (lacking(*answer) ? advice(context) : ""));
    }
    if (!written_.empty()) {
      const std::string held = difference(context, *answer);
      written_.clear();
      if (!held.empty() && !current_.optional) return Outcome::failed(held);
      ++next_;
      continue;
    }
    if (mayBeReadBack(context, *answer)) {
      written_ = answer->data();
      ticket_ = context.axis.device().objects().upload(current_.object, current_.name);
      continue;
    }
    if (answer->ok() && answer->direction() == fieldbus::Transfer::Direction::upload) {
      if (copy(context, answer->data())) continue;
      if (!current_.optional) {
        return Outcome::failed(context.axis.who() + ": what was to be copied into " +
                               current_.name + " is no finite number; look at it with read_object");
      }
    }
    ++next_;
  }
}

/// What travels to the drive in every cycle may be another number by then.
bool WriteStep::mayBeReadBack(const Context& context, const fieldbus::Transfer& answer) const {
  const ObjectSpec* object = context.axis.profile().find(current_.object);
  const bool readable = object == nullptr || object->readable;
  return context.axis.profile().reads_back && readable && answer.ok() &&
         answer.direction() == fieldbus::Transfer::Direction::download &&
         context.axis.device().image().outputSlot(current_.object) == fieldbus::kNoSlot;
}

/// What cannot be read is believed.
std::string WriteStep::difference(const Context& context, const fieldbus::Transfer& answer) const {
  const fieldbus::Bytes& held = answer.data();
  const bool same = held == written_ || held.empty() || held.size() > 8 ||
                    fieldbus::toUnsigned(held) == fieldbus::toUnsigned(written_);
  if (!answer.ok() || same) return {};
  return context.axis.who() + ": the drive took " + hexText(fieldbus::toUnsigned(written_), 2) +
         " for " + current_.name + ", but holds " + hexText(fieldbus::toUnsigned(held), 2) +
         "; look for a limit of its own";
}

/// Of what is written before each enabling, the axis' own number for the object counts, if its
/// `write` has one.
const NamedWrite& WriteStep::chosen(const Context& context) const {
  const NamedWrite& write = (*writes_)[next_];
  const DriveProfile& profile = context.axis.profile();
  const bool copies = profile.find(write.from) != nullptr;
  if (writes_ != &profile.before_enable || copies) return write;
  const std::vector<NamedWrite>& own = context.axis.config().writes;
  const auto object = addressOf(profile, write.object);
  const auto found = std::find_if(own.rbegin(), own.rend(), [&](const NamedWrite& candidate) {
    return addressOf(profile, candidate.object) == object;
  });
  return found == own.rend() ? write : *found;
}

bool WriteStep::begin(const Context& context, Outcome& problem) {
  if (next_ >= writes_->size()) {
    problem = Outcome::done();
    return false;
  }
  const bool named = (*writes_)[next_].from == name_;
  if (!name_.empty() && named != (part_ == Part::named)) {
    ++next_;
    return true;
  }
  const auto resolved = resolveWrite(chosen(context), context.axis.config());
  if (!resolved) {
    problem = Outcome::failed(context.axis.who() + ": " + resolved.error().message);
    return false;
  }
  const bool lacks = saidToLack(context.axis.config(), (*writes_)[next_].object);
  if (!resolved->has_value() || lacks) {
    if (lacks) left_out_.push_back((*writes_)[next_].from);
    ++next_;
    return true;
  }
  current_ = **resolved;
  context.show("writing parameters", "the drive to take " + current_.name);
  if (current_.copied_from) {
    ticket_ = context.axis.device().objects().upload(*current_.copied_from, current_.name);
  } else {
    write(context, wireBytes(current_.raw, current_.type));
  }
  return true;
}

bool WriteStep::mayLeaveOut(const Context& context, const fieldbus::Transfer& answer) {
  if (current_.asked_for || !lacking(answer)) return false;
  left_out_.push_back((*writes_)[next_].from);
  context.axis.notices().warnOnce(
      context.axis.who() + ": " + current_.name +
      " is left out, for only a default asks for it and the drive does not take "
      "it: " +
      answer.reason() + advice(context));
  return true;
}

/// The key that says that the drive does not have the object.
std::string WriteStep::advice(const Context& context) const {
  const AxisConfig& axis = context.axis.config();
  const ObjectSpec* object = findObject(*axis.profile, (*writes_)[next_].object);
  if (object == nullptr) return {};
  return "; `lacks: [" + object->name + "]` of axes/" + axis.name +
         " says that the drive does without it";
}

bool WriteStep::leftOut(const std::string& from) const {
  return std::find(left_out_.begin(), left_out_.end(), from) != left_out_.end();
}

/// @return false for NaN and infinity, which are never sent.
bool WriteStep::copy(const Context& context, fieldbus::Bytes bytes) {
  const ObjectSpec* source = context.axis.profile().find(*current_.copied_from);
  if (source != nullptr && holdsFloat(source->type, source->encoding)) {
    if (bytes.size() * 8 != fieldbus::sizeBits(source->type)) return false;
    const auto raw = sendable(source->type, source->encoding, fieldbus::toUnsigned(bytes));
    if (!raw) return false;
    bytes = wireBytes(*raw, source->type);
  }
  write(context, std::move(bytes));
  return true;
}

void WriteStep::write(const Context& context, fieldbus::Bytes bytes) {
  wrote_ = true;
  const fieldbus::Slot slot = context.axis.device().image().outputSlot(current_.object);
  if (slot != fieldbus::kNoSlot && bytes.size() <= 8) {
    mapped_.push_back({slot, fieldbus::toUnsigned(bytes)});
  }
  const bool by_default = !current_.asked_for && !current_.optional;
  ticket_ = context.axis.device().objects().download(
      current_.object, std::move(bytes), current_.name,
      by_default ? std::optional(ifThere(context.axis.device())) : std::nullopt);
}

}  // namespace cia402::drive
