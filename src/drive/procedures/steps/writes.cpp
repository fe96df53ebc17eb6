// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/procedures/steps/writes.h"

#include <algorithm>
#include <utility>

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
    if (!answer->ok() && !current_.optional && !mayLeaveOut(context, *answer)) {
      return Outcome::failed(context.axis.who() + ": " + answer->message() +
                             (lacking(*answer) ? advice(context) : ""));
    }
    if (std::exchange(reading_back_, false)) {
      const std::string problem = compare(*answer);
      if (!problem.empty()) return Outcome::failed(context.axis.who() + ": " + problem);
      ++next_;
      continue;
    }
    if (answer->ok() && readsBack(context, *answer)) continue;
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

bool WriteStep::begin(const Context& context, Outcome& problem) {
  if (next_ >= writes_->size()) {
    problem = Outcome::done();
    return false;
  }
  const auto resolved = resolveWrite((*writes_)[next_], context.axis.config());
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

/// What travels in the cycle as well is what that says by now.
bool WriteStep::readsBack(const Context& context, const fieldbus::Transfer& answer) {
  const ObjectSpec* object = context.axis.profile().find(current_.object);
  const bool mapped =
      context.axis.device().image().outputSlot(current_.object) != fieldbus::kNoSlot;
  const bool wanted = context.axis.profile().read_back && !mapped &&
                      (object == nullptr || object->readable) &&
                      answer.direction() == fieldbus::Transfer::Direction::download;
  if (!wanted) return false;
  reading_back_ = true;
  ticket_ = context.axis.device().objects().upload(current_.object, current_.name);
  return true;
}

/// What cannot be read again is believed.
std::string WriteStep::compare(const fieldbus::Transfer& answer) const {
  if (!answer.ok() || answer.data().empty() || answer.data().size() > 8) return {};
  const std::uint64_t wanted = fieldbus::toUnsigned(written_);
  const std::uint64_t holds = fieldbus::toUnsigned(answer.data());
  if (holds == wanted) return {};
  return "the drive took " + current_.name + " = " + std::to_string(wanted) + ", but holds " +
         std::to_string(holds) + " when it is read back: look at its range in the drive's manual";
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
  const fieldbus::Slot slot = context.axis.device().image().outputSlot(current_.object);
  if (slot != fieldbus::kNoSlot && bytes.size() <= 8) {
    mapped_.push_back({slot, fieldbus::toUnsigned(bytes)});
  }
  const bool by_default = !current_.asked_for && !current_.optional;
  written_ = bytes;
  ticket_ = context.axis.device().objects().download(
      current_.object, std::move(bytes), current_.name,
      by_default ? std::optional(ifThere(context.axis.device())) : std::nullopt);
}

}  // namespace cia402::drive
