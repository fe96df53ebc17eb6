// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The steps of the boot procedure that set up heartbeats and SYNC in the drive.
#include <algorithm>

#include "boot.h"
#include "boot_text.h"
#include "cia402_driver/canopen/abort_code.h"

namespace cia402::canopen {
namespace {

constexpr ObjectId kConsumerHeartbeat{0x1016, 1};  // CiA 301, 7.5.2.17
constexpr ObjectId kProducerHeartbeat{0x1017, 0};  // CiA 301, 7.5.2.18
constexpr ObjectId kSyncPeriod{0x1006, 0};         // CiA 301, 7.5.2.6
constexpr ObjectId kSyncCounter{0x1019, 0};        // CiA 301, 7.5.2.22
constexpr const char* kConsumerHeartbeatName = "consumer heartbeat time";
constexpr const char* kProducerHeartbeatName = "producer heartbeat time";
constexpr const char* kSyncPeriodName = "communication cycle period";
constexpr const char* kSyncCounterName = "synchronous counter overflow value";

/// Both heartbeat objects hold 16 bits of milliseconds.
std::uint32_t milliseconds16(Duration duration) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(ms, 1, 0xFFFF));
}

}  // namespace

bool BootProcedure::refusedAsMissing() const {
  return refused() && (ticket_->abortCode() == abort_code::kNoSuchObject ||
                       ticket_->abortCode() == abort_code::kNoSuchSubindex);
}

bool BootProcedure::beginMasterTimeout(Time now) {
  if (config_.master_timeout <= Duration::zero() || !master_has_heartbeat_) return false;
  const std::uint32_t value =
      static_cast<std::uint32_t>(master_) << 16 | milliseconds16(config_.master_timeout);
  write(kConsumerHeartbeat, toBytes(value, 4), kConsumerHeartbeatName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkMasterTimeout(Time) {
  if (!ticket_->done()) return Progress::waiting;
  if (ticket_->ok()) return Progress::next;
  if (!refused()) return failTransfer();
  note("cannot notice a dead master: " + step_ + ": " + ticket_->reason());
  return Progress::next;
}

bool BootProcedure::beginHeartbeat(Time now) {
  if (config_.heartbeat <= Duration::zero()) return false;
  write(kProducerHeartbeat, toBytes(milliseconds16(config_.heartbeat), 2), kProducerHeartbeatName,
        now);
  return true;
}

BootProcedure::Progress BootProcedure::checkHeartbeat(Time) {
  if (!ticket_->done()) return Progress::waiting;
  supervised_ = ticket_->ok();
  if (ticket_->ok()) return Progress::next;
  if (!refused()) return failTransfer();
  note("not supervised, its loss will go unnoticed: " + step_ + ": " + ticket_->reason());
  return Progress::next;
}

bool BootProcedure::beginReadSyncCounter(Time now) {
  if (!config_.sync_counter) return false;
  read(kSyncCounter, kSyncCounterName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkReadSyncCounter(Time) {
  if (!ticket_->done()) return Progress::waiting;
  if (ticket_->ok()) {
    sync_counter_differs_ = toUnsigned(ticket_->data()) != *config_.sync_counter;
  } else if (!refusedAsMissing() || *config_.sync_counter != 0) {
    return failTransfer();
  }
  return Progress::next;
}

bool BootProcedure::beginReadSyncPeriod(Time now) {
  if (!sync_counter_differs_ && !config_.sync_period_us) return false;
  read(kSyncPeriod, kSyncPeriodName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkReadSyncPeriod(Time) {
  if (!ticket_->done()) return Progress::waiting;
  if (ticket_->ok()) {
    sync_period_ = static_cast<std::uint32_t>(toUnsigned(ticket_->data()));
    wanted_sync_period_ = config_.sync_period_us.value_or(*sync_period_);
  } else if (!refusedAsMissing()) {
    return failTransfer();
  } else if (config_.sync_period_us.value_or(0) != 0) {
    note("does not know the SYNC period: " + step_ + ": " + ticket_->reason());
  }
  return Progress::next;
}

// The counter may change only while the period is 0 (CiA 301, 7.5.2.22).
bool BootProcedure::beginStopSyncPeriod(Time now) {
  if (!sync_counter_differs_ || sync_period_.value_or(0) == 0) return false;
  write(kSyncPeriod, toBytes(0, 4), kSyncPeriodName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkStopSyncPeriod(Time) {
  if (!ticket_->done()) return Progress::waiting;
  if (!ticket_->ok()) return failTransfer();
  sync_period_ = 0;
  return Progress::next;
}

bool BootProcedure::beginWriteSyncCounter(Time now) {
  if (!sync_counter_differs_) return false;
  write(kSyncCounter, toBytes(*config_.sync_counter, 1), kSyncCounterName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkWriteSyncCounter(Time) {
  if (!ticket_->done()) return Progress::waiting;
  return ticket_->ok() ? Progress::next : failTransfer();
}

bool BootProcedure::beginWriteSyncPeriod(Time now) {
  if (!wanted_sync_period_ || sync_period_ == wanted_sync_period_) return false;
  write(kSyncPeriod, toBytes(*wanted_sync_period_, 4), kSyncPeriodName, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkWriteSyncPeriod(Time) {
  if (!ticket_->done()) return Progress::waiting;
  return ticket_->ok() ? Progress::next : failTransfer();
}

}  // namespace cia402::canopen
