// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "step_writes.h"

#include <utility>

#include "cia402_driver/drive/object_value.h"

namespace cia402::drive {

Outcome WriteStep::advance(const Context& context) {
  while (true) {
    if (!ticket_) {
      Outcome problem;
      if (!begin(context, problem)) return problem;
      if (!ticket_) continue;  // nothing configured for this one
    }
    if (!ticket_->done()) return Outcome::running();
    const canopen::SdoTicket answer = std::exchange(ticket_, nullptr);
    if (!answer->ok() && !current_.optional) {
      return Outcome::failed(context.axis.who() + ": " + answer->message());
    }
    if (answer->ok() && answer->direction() == canopen::SdoTransfer::Direction::upload) {
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
  if (!resolved->has_value()) {
    ++next_;
    return true;
  }
  current_ = **resolved;
  context.show("writing parameters", "the drive to take " + current_.name);
  if (current_.copied_from) {
    ticket_ = context.axis.node().sdo().upload(*current_.copied_from, current_.name);
  } else {
    write(context, wireBytes(current_.raw, current_.type));
  }
  return true;
}

/// @return false for NaN and infinity, which are never sent.
bool WriteStep::copy(const Context& context, canopen::Bytes bytes) {
  const ObjectSpec* source = context.axis.profile().find(*current_.copied_from);
  if (source != nullptr && holdsFloat(source->type, source->encoding)) {
    if (bytes.size() * 8 != canopen::sizeBits(source->type)) return false;
    const auto raw = sendable(source->type, source->encoding, canopen::toUnsigned(bytes));
    if (!raw) return false;
    bytes = wireBytes(*raw, source->type);
  }
  write(context, std::move(bytes));
  return true;
}

void WriteStep::write(const Context& context, canopen::Bytes bytes) {
  const canopen::Slot slot = context.axis.node().image().outputSlot(current_.object);
  if (slot != canopen::kNoSlot && bytes.size() <= 8) {
    mapped_.push_back({slot, canopen::toUnsigned(bytes)});
  }
  ticket_ = context.axis.node().sdo().download(current_.object, std::move(bytes), current_.name);
}

}  // namespace cia402::drive
