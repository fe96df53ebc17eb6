// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_load_job.h"

#include <utility>

#include "bus/axis_cycle.h"
#include "common/text.h"
#include "drive/axis/coordinates.h"

namespace cia402::bus {
namespace {

using TransferFailure = fieldbus::Transfer::Failure;
using Loaded = DcfLoading::Outcome;

constexpr unsigned kMostUnanswered = 3;

std::string notLoaded(const drive::AxisConfig& axis, const DcfLoading& loading) {
  return drive::whoIs(axis) + ": " + loading.file + " not loaded: ";
}

/// Nobody else may be under power by that device.
std::string whyNotNow(const drive::Axis& axis) {
  const std::string moves = axis.calibrationRefusal();
  return moves.empty() ? axis.deviceRefusal() : moves;
}

std::string heldText(const fieldbus::Bytes& data) {
  return hexText(fieldbus::toUnsigned(data), static_cast<int>(2 * data.size()));
}

}  // namespace

void LoadDcfCommand::begin(AxisCycle& cycle, const Reply<>& reply, Time) const {
  const auto unit = cycle.findToAsk(axis, "its objects for a DCF");
  if (!unit) return refuse(reply, unit.error().message);
  drive::Axis& asked = (*unit)->axis;
  const std::string why_not = whyNotNow(asked);
  if (!why_not.empty()) return refuse(reply, notLoaded(asked.config(), *loading) + why_not);
  cycle.jobs().add(std::make_unique<DcfLoadJob>(asked, *this, reply));
}

DcfLoadJob::DcfLoadJob(drive::Axis& axis, const LoadDcfCommand& command, Reply<> reply)
    : Job(Turn::object, Ends::at_once),
      axis_(&axis),
      loading_(command.loading),
      confirmed_(command.confirm),
      reply_(std::move(reply)) {
  axis_->beginCalibration(loading_->file);
  (void)ask(loading_->identity.front(), Stage::identifying);
}

bool DcfLoadJob::ask(const DcfLoading::Item& item, Stage stage) {
  stage_ = stage;
  ticket_ = axis_->device().objects().upload(item.id, item.name);
  return false;
}

bool DcfLoadJob::silent() {
  silent_ = ticket_->failure() == TransferFailure::timed_out ? silent_ + 1 : 0;
  return silent_ >= kMostUnanswered || ticket_->failure() == TransferFailure::cancelled;
}

bool DcfLoadJob::step(Time now) {
  if (stage_ == Stage::settling) {
    if (now < since_ + drive::kZeroSettles) return false;
    axis_->measureAnew(true);
    return finish(answerOf(true, {}));
  }
  if (!ticket_->done()) return false;
  if (silent()) return fail(ticket_->message());
  switch (stage_) {
    case Stage::identifying:
      return identify();
    case Stage::reading:
      return compare(now);
    case Stage::writing:
      return takeWritten(now);
    default:
      return takeReadBack(now);
  }
}

bool DcfLoadJob::identify() {
  const DcfLoading::Item& item = loading_->identity[at_];
  if (!ticket_->ok()) return fail(ticket_->message());
  if (ticket_->data() != item.data) {
    return fail("it is of another drive: " + item.name + " is " + heldText(item.data) +
                " in it, and " + heldText(ticket_->data()) + " here");
  }
  if (++at_ < loading_->identity.size()) return ask(loading_->identity[at_], Stage::identifying);
  at_ = 0;
  return ask(loading_->items.front(), Stage::reading);
}

void DcfLoadJob::note(Loaded outcome, std::string problem) {
  loading_->items[at_].outcome = outcome;
  loading_->items[at_].problem = std::move(problem);
}

bool DcfLoadJob::compare(Time now) {
  const DcfLoading::Item& item = loading_->items[at_];
  const bool same = ticket_->ok() && ticket_->data() == item.data;
  const bool fits = !ticket_->ok() || ticket_->data().size() == item.data.size();
  if (same) {
    note(Loaded::same);
  } else if (!ticket_->ok()) {
    note(Loaded::refused, ticket_->reason());
  } else if (!fits) {
    note(Loaded::refused, "the drive has " + std::to_string(ticket_->data().size()) +
                              " bytes, the file " + std::to_string(item.data.size()));
  } else if (!confirmed_) {
    note(Loaded::differs);
  } else {
    return write(item);
  }
  return next(now);
}

/// The axis is locked; whoever enables it otherwise ends this.
bool DcfLoadJob::write(const DcfLoading::Item& item) {
  axis_->endCalibration();
  const std::string why_not = whyNotNow(*axis_);
  axis_->beginCalibration(loading_->file);
  if (!why_not.empty()) return fail(why_not);
  stage_ = Stage::writing;
  fieldbus::AccessOptions once = axis_->device().times().access;
  if (item.moves_zero) once.retries = 0;
  ticket_ = axis_->device().objects().download(item.id, item.data, item.name, once);
  return false;
}

bool DcfLoadJob::takeWritten(Time now) {
  const DcfLoading::Item& item = loading_->items[at_];
  const bool refused = ticket_->failure() == TransferFailure::aborted_by_server;
  if (!refused && item.moves_zero && !moved_) {
    moved_ = true;
    axis_->loseZero(true);
  }
  if (!ticket_->ok()) {
    note(Loaded::refused, ticket_->reason());
    return next(now);
  }
  ++written_;
  axis_->noteWritten(item.id);
  return ask(item, Stage::comparing);
}

bool DcfLoadJob::takeReadBack(Time now) {
  const DcfLoading::Item& item = loading_->items[at_];
  if (ticket_->ok() && ticket_->data() == item.data) {
    note(Loaded::written);
  } else {
    note(Loaded::refused, ticket_->ok()
                              ? "it took the write, but shows " + heldText(ticket_->data())
                              : ticket_->reason());
  }
  return next(now);
}

bool DcfLoadJob::next(Time now) {
  if (++at_ < loading_->items.size()) return ask(loading_->items[at_], Stage::reading);
  if (!moved_) return finish(answerOf(true, {}));
  stage_ = Stage::settling;
  since_ = now;
  return false;
}

bool DcfLoadJob::fail(const std::string& why) {
  if (moved_) axis_->measureAnew(true);
  return finish(answerOf(false, notLoaded(axis_->config(), *loading_) + why +
                                    (written_ == 0 ? std::string()
                                                   : "; " + std::to_string(written_) +
                                                         " objects were written before that")));
}

bool DcfLoadJob::finish(const Answer& answer) {
  axis_->endCalibration();
  loading_.reset();  // the caller's alone from the reply on
  give(reply_, answer);
  return true;
}

}  // namespace cia402::bus
