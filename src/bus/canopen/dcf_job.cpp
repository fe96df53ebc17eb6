// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_job.h"

#include <memory>
#include <utility>

#include "bus/network.h"
#include "fieldbus/abort_code.h"

namespace cia402::bus {
namespace {

using Outcome = DcfReading::Outcome;

constexpr unsigned kMostSilent = 3;

bool isAbsent(std::uint32_t abort_code) {
  return abort_code == fieldbus::abort_code::kNoSuchObject ||
         abort_code == fieldbus::abort_code::kNoSuchSubindex;
}

}  // namespace

void SaveDcfCommand::begin(Network& network, const Reply<>& reply, Time) const {
  const auto unit = network.cycle().findToAsk(axis, "its objects for a DCF");
  if (!unit) return refuse(reply, unit.error().message);
  network.cycle().jobs().add(
      std::make_unique<DcfJob>((*unit)->axis, *this, network.config().bus.bitrate, reply));
}

DcfJob::DcfJob(drive::Axis& axis, const SaveDcfCommand& command, double bitrate, Reply<> reply)
    : Job(Turn::last, Ends::with_motion),
      axis_(&axis),
      reply_(std::move(reply)),
      reading_(command.reading) {
  reading_->bitrate = bitrate;
}

void DcfJob::abandon(const std::string& why) { fail(why); }

bool DcfJob::fail(const std::string& why) {
  return finish(answerOf(false, drive::whoIs(axis_->config()) + ": no DCF: " + why));
}

bool DcfJob::finish(const Answer& answer) {
  reading_.reset();  // so that thousands of items are freed by the thread that waits for them
  give(reply_, answer);
  return true;
}

bool DcfJob::askNext() {
  if (next_ == reading_->items.size()) return false;
  const DcfReading::Item& item = reading_->items[next_++];
  ticket_ = axis_->device().objects().upload(item.id, item.name);
  return true;
}

bool DcfJob::step(Time) {
  if (ticket_ != nullptr) {
    if (!ticket_->done()) return false;
    if (ticket_->failure() == fieldbus::Transfer::Failure::cancelled) {
      return fail(ticket_->reason());
    }
    const bool silent = ticket_->failure() == fieldbus::Transfer::Failure::timed_out;
    silent_ = silent ? silent_ + 1 : 0;
    if (silent_ >= kMostSilent) return fail(ticket_->message());
    take(*ticket_);
  }
  return askNext() ? false : finish(answerOf(true, {}));
}

void DcfJob::take(const fieldbus::Transfer& transfer) {
  auto& items = reading_->items;
  DcfReading::Item& item = items[next_ - 1];
  if (transfer.ok()) {
    item.outcome = Outcome::read;
    item.data = transfer.data();
    return;
  }
  const bool absent = item.guessed && isAbsent(transfer.abortCode());
  item.outcome = absent ? Outcome::absent : Outcome::refused;
  if (!absent) item.problem = transfer.reason();
  if (!item.guessed || item.id.subindex != 0) return;
  // Without sub-index 0 the others need not be asked for.
  while (next_ < items.size() && items[next_].id.index == item.id.index) ++next_;
}

}  // namespace cia402::bus
