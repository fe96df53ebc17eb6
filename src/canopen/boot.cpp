// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "boot.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "boot_text.h"
#include "cia402_driver/canopen/abort_code.h"

namespace cia402::canopen {

// In this order; each step is skipped where the configuration asks nothing of it.
const BootProcedure::Step BootProcedure::kSteps[] = {
    {&BootProcedure::beginWaitingForBootUp, &BootProcedure::checkWaitingForBootUp},
    {&BootProcedure::beginProofOfLife, &BootProcedure::checkProofOfLife},
    {&BootProcedure::beginIdentity, &BootProcedure::checkIdentity},
    {&BootProcedure::beginMasterTimeout, &BootProcedure::checkMasterTimeout},
    {&BootProcedure::beginHeartbeat, &BootProcedure::checkHeartbeat},
    {&BootProcedure::beginReadSyncCounter, &BootProcedure::checkReadSyncCounter},
    {&BootProcedure::beginReadSyncPeriod, &BootProcedure::checkReadSyncPeriod},
    {&BootProcedure::beginStopSyncPeriod, &BootProcedure::checkStopSyncPeriod},
    {&BootProcedure::beginWriteSyncCounter, &BootProcedure::checkWriteSyncCounter},
    {&BootProcedure::beginWriteSyncPeriod, &BootProcedure::checkWriteSyncPeriod},
    {&BootProcedure::beginPdo, &BootProcedure::checkPdo},
    {&BootProcedure::beginStartupWrite, &BootProcedure::checkStartupWrite},
    {&BootProcedure::beginStart, &BootProcedure::checkStart},
};
const std::size_t BootProcedure::kStepCount = sizeof(kSteps) / sizeof(kSteps[0]);

namespace {

constexpr unsigned kProbedPdos = 4;  // of each direction, looked at though not configured
constexpr Duration kLeastStartTime = std::chrono::seconds(1);
constexpr Duration kStateRetry = std::chrono::milliseconds(50);
constexpr Duration kStatePatience = std::chrono::seconds(3);  // a drive stops and disables in that

std::vector<PdoConfig> withUnlistedDisabled(const std::vector<PdoConfig>& wanted) {
  std::vector<PdoConfig> all;
  for (const PdoDirection direction : {PdoDirection::rpdo, PdoDirection::tpdo}) {
    for (unsigned number = 1; number <= kProbedPdos; ++number) {
      const bool listed = std::any_of(wanted.begin(), wanted.end(), [&](const PdoConfig& pdo) {
        return pdo.direction == direction && pdo.number == number;
      });
      if (listed) continue;
      PdoConfig unlisted;
      unlisted.direction = direction;
      unlisted.number = number;
      unlisted.enabled = false;
      all.push_back(std::move(unlisted));
    }
  }
  all.insert(all.end(), wanted.begin(), wanted.end());
  return all;
}

}  // namespace

BootProcedure::BootProcedure(const NodeConfig& config, const MasterConfig& master, SdoClient& sdo,
                             can::Sink& sink)
    : config_(config),
      master_(master.node_id),
      master_has_heartbeat_(master.heartbeat > Duration::zero()),
      sdo_(sdo),
      sink_(sink),
      pdos_(withUnlistedDisabled(config.pdos)) {}

void BootProcedure::start(From from, Time now) {
  status_ = Status::running;
  ticket_.reset();
  pdo_.reset();
  identity_.reset();
  notes_.clear();
  adopted_cob_ids_.clear();
  error_.clear();
  sync_counter_differs_ = false;
  sync_period_.reset();
  wanted_sync_period_.reset();
  boot_up_missed_ = heartbeat_heard_ = operational_heard_ = supervised_ = started_ = false;
  absent_at_ = now + config_.boot_timeout;
  if (from == From::unknown) {
    sink_.send(nmtFrame(NmtCommand::enter_pre_operational, config_.node_id));
  }
  enter(from == From::reset ? 0 : 1, now);
}

void BootProcedure::stop() {
  status_ = Status::idle;
  step_ = "not running";
}

void BootProcedure::enter(std::size_t step, Time now) {
  for (index_ = step; index_ < kStepCount; ++index_) {
    item_ = 0;
    deadline_ = kNever;
    const Step& present = kSteps[index_];
    if ((this->*present.begin)(now)) return;
  }
  step_ = "ready";
  status_ = Status::done;
}

BootProcedure::Status BootProcedure::advance(Time now) {
  while (status_ == Status::running) {
    const Step& present = kSteps[index_];
    switch ((this->*present.check)(now)) {
      case Progress::waiting:
        return status_;
      case Progress::again:
        ++item_;
        if ((this->*present.begin)(now)) break;
        [[fallthrough]];
      case Progress::next:
        enter(index_ + 1, now);
        break;
      case Progress::failed:
        if (started_) sink_.send(nmtFrame(NmtCommand::enter_pre_operational, config_.node_id));
        started_ = false;
        if (status_ == Status::running) status_ = Status::failed;
        break;
    }
  }
  return status_;
}

void BootProcedure::heartbeatHeard(NmtState state) {
  heartbeat_heard_ = true;
  if (started_ && state == NmtState::operational) operational_heard_ = true;
}

void BootProcedure::read(ObjectId object, const std::string& name, Time now,
                         std::optional<SdoOptions> options) {
  step_ = "reading " + objectText(object, name);
  ticket_ = sdo_.upload(object, name, options);
  sdo_.tick(now);
}

void BootProcedure::write(ObjectId object, Bytes data, const std::string& name, Time now) {
  step_ = "writing " + valueText(data) + " to " + objectText(object, name);
  ticket_ = sdo_.download(object, std::move(data), name);
  sdo_.tick(now);
}

BootProcedure::Progress BootProcedure::fail(const std::string& reason) {
  error_ = reason;
  return Progress::failed;
}

BootProcedure::Progress BootProcedure::failTransfer() {
  return fail("boot failed while " + step_ + ": " + ticket_->reason());
}

bool BootProcedure::refused() const {
  return ticket_->failure() == SdoTransfer::Failure::aborted_by_server;
}

void BootProcedure::note(const std::string& text) { notes_.push_back(text); }

// Programming the PDOs, the start-up writes and the start; the earlier steps are in
// boot_identify.cpp and boot_supervise.cpp.

bool BootProcedure::beginPdo(Time now) {
  if (item_ >= pdos_.size()) return false;
  const PdoConfig& wanted = pdos_[item_];
  PdoConfigurator::Options options;
  options.count_may_be_read_only = config_.map_count_may_be_read_only;
  options.may_be_missing = !wanted.enabled;
  pdo_.emplace(sdo_, wanted, options);
  pdo_->advance();
  step_ = pdo_->step();
  sdo_.tick(now);
  return true;
}

BootProcedure::Progress BootProcedure::checkPdo(Time now) {
  const PdoConfigurator::Status status = pdo_->advance();
  step_ = pdo_->step();
  switch (status) {
    case PdoConfigurator::Status::running:
      sdo_.tick(now);
      return Progress::waiting;
    case PdoConfigurator::Status::done:
      adoptCobId();
      return Progress::again;
    case PdoConfigurator::Status::failed:
      break;
  }
  const bool unwanted = !pdos_[item_].enabled;
  if (!unwanted || pdo_->timedOut()) return fail("boot failed: " + pdo_->error());
  note("a PDO that is not configured could not be disabled: " + pdo_->error());
  return Progress::again;
}

void BootProcedure::adoptCobId() {
  const std::optional<std::uint16_t> cob_id = pdo_->adoptedCobId();
  if (!cob_id) return;
  const PdoConfig& pdo = pdos_[item_];
  adopted_cob_ids_.push_back({pdo.direction, pdo.number, *cob_id});
  if (pdo.cob_id == 0) return;  // asked for
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(),
                "%s %u has the COB-ID 0x%03X that the drive insists on, instead of 0x%03X",
                pdo.direction == PdoDirection::tpdo ? "TPDO" : "RPDO", pdo.number,
                unsigned{*cob_id}, unsigned{pdo.cob_id});
  note(text.data());
}

bool BootProcedure::beginStartupWrite(Time now) {
  if (item_ >= config_.writes.size()) return false;
  const StartupWrite& wanted = config_.writes[item_];
  repeat_at_ = patient_until_ = kNever;
  reading_before_write_ = wanted.only_if_different;
  if (reading_before_write_) {
    read(wanted.object, wanted.name, now);
  } else {
    sendStartupWrite(now);
  }
  return true;
}

void BootProcedure::sendStartupWrite(Time now) {
  const StartupWrite& wanted = config_.writes[item_];
  reading_before_write_ = false;
  write(wanted.object, wanted.data, wanted.name, now);
}

BootProcedure::Progress BootProcedure::checkStartupWrite(Time now) {
  if (repeat_at_ != kNever) {
    if (now < repeat_at_) return Progress::waiting;
    repeat_at_ = deadline_ = kNever;
    sendStartupWrite(now);
    return Progress::waiting;
  }
  if (!ticket_->done()) return Progress::waiting;
  if (reading_before_write_) return checkReadBeforeWrite(now);
  if (ticket_->ok()) return Progress::again;
  const bool optional = config_.writes[item_].optional;
  if (!optional && ticket_->abortCode() == abort_code::kDeviceState) return repeatLater(now);
  if (!optional || !refused()) return failTransfer();
  note("optional start-up write left out: " + step_ + ": " + ticket_->reason());
  return Progress::again;
}

/// Drives that lock parameters while they are enabled may still be on their way out of that state.
BootProcedure::Progress BootProcedure::repeatLater(Time now) {
  if (patient_until_ == kNever) patient_until_ = now + kStatePatience;
  if (now >= patient_until_) return failTransfer();
  repeat_at_ = deadline_ = now + kStateRetry;
  return Progress::waiting;
}

BootProcedure::Progress BootProcedure::checkReadBeforeWrite(Time now) {
  if (ticket_->ok() && ticket_->data() == config_.writes[item_].data) return Progress::again;
  if (!ticket_->ok() && !refused()) return failTransfer();
  sendStartupWrite(now);  // also where the object cannot be read
  return Progress::waiting;
}

bool BootProcedure::beginStart(Time now) {
  sink_.send(nmtFrame(NmtCommand::start, config_.node_id));
  started_ = true;
  if (!supervised_) return false;  // nothing would tell when it is operational
  step_ = "waiting for the heartbeat to say operational";
  deadline_ = now + std::max(config_.heartbeat_timeout, kLeastStartTime);
  return true;
}

BootProcedure::Progress BootProcedure::checkStart(Time now) {
  if (operational_heard_) return Progress::next;
  if (now < deadline_) return Progress::waiting;
  return fail(
      "boot failed: the drive was started (NMT), but its heartbeat did not say operational "
      "in time; read its error register 1001:00 and emergencies");
}

}  // namespace cia402::canopen
