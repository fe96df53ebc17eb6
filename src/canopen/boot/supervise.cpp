// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// Error control: how master and drive notice that the other one is gone.
#include <algorithm>
#include <array>

#include "canopen/boot/steps.h"

namespace cia402::canopen {
namespace {

/// All of them hold milliseconds in 16 bits, 1016h beside the node-ID.
std::uint32_t milliseconds16(Duration duration) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(ms, 1, 0xFFFF));
}

class ErrorControlSetup : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (rows_.empty()) plan(boot);
    if (item_ >= rows_.size()) {
      conclude(boot);
      return false;
    }
    const Row& row = rows_[item_];
    comparing_ = boot.config.boot.check != ConfigurationCheck::none;
    if (comparing_) {
      boot.read(row.object, row.name, now, boot.ifThere());
    } else {
      boot.write(row.object, toBytes(row.value, row.size), row.name, now, boot.ifThere());
    }
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (const auto resting = patience_.rest(boot, now)) return *resting;
    if (!boot.answered()) return Progress::waiting;
    const Row& row = rows_[item_];
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    if (comparing_ && !boot.has(row.value, row.size) && !boot.refusedAsMissing()) {
      // Not as the last boot left it: nor may be anything else.
      comparing_ = false;
      boot.found.error_control_differed = true;
      boot.write(row.object, toBytes(row.value, row.size), row.name, now, boot.ifThere());
      return Progress::waiting;
    }
    if (!boot.ok() && patience_.grant(boot, boot.ticket->abortCode(), now)) {
      return Progress::waiting;
    }
    judge(row, boot);
    ++item_;
    return Progress::again;
  }

 private:
  enum class Purpose { watch_master, be_watched, no_heartbeat, guard_time, life_time };
  struct Row {
    ObjectId object;
    const char* name;
    std::uint32_t value;
    unsigned size;
    Purpose purpose;
  };

  void plan(const BootContext& boot) {
    const NodeConfig& config = boot.config;
    if (config.error_control == ErrorControl::guarding) {  // 7.5.2.11, 7.5.2.12
      rows_ = {
          {{0x1017, 0}, "producer heartbeat time", 0, 2, Purpose::no_heartbeat},
          {{0x100C, 0}, "guard time", milliseconds16(config.guard_time), 2, Purpose::guard_time},
          {{0x100D, 0}, "life time factor", config.life_time_factor, 1, Purpose::life_time}};
      return;
    }
    if (config.master_timeout > Duration::zero() && boot.master_heartbeat > Duration::zero()) {
      const std::uint32_t value =
          static_cast<std::uint32_t>(boot.master) << 16 | milliseconds16(config.master_timeout);
      rows_.push_back(
          {{0x1016, 1}, "consumer heartbeat time", value, 4, Purpose::watch_master});  // 7.5.2.17
    }
    if (config.error_control == ErrorControl::heartbeat && config.heartbeat > Duration::zero()) {
      rows_.push_back({{0x1017, 0},
                       "producer heartbeat time",
                       milliseconds16(config.heartbeat),
                       2,
                       Purpose::be_watched});  // 7.5.2.18
    }
  }

  void judge(const Row& row, BootContext& boot) {
    switch (row.purpose) {
      case Purpose::watch_master:
        boot.found.watches_master = boot.ok();
        if (!boot.ok()) boot.noteTransfer("cannot notice a dead master");
        break;
      case Purpose::be_watched:
        boot.found.supervised = boot.ok();
        if (!boot.ok()) boot.noteTransfer("not supervised, its loss will go unnoticed");
        break;
      case Purpose::no_heartbeat:
        if (!boot.ok() && !boot.refusedAsMissing()) {
          boot.noteTransfer("its heartbeat could not be switched off for node guarding");
        }
        break;
      case Purpose::guard_time:  // the drive answers RTR without it, too, but will not miss us
        boot.found.supervised = boot.found.guarded = true;
        boot.found.watches_master = boot.ok();
        if (!boot.ok()) boot.noteTransfer("cannot notice a dead master");
        break;
      case Purpose::life_time:
        if (!boot.ok() && boot.found.watches_master) {
          boot.noteTransfer("cannot notice a dead master");
        }
        boot.found.watches_master = boot.found.watches_master && boot.ok();
        break;
    }
  }

  /// What is not even asked for is told, too.
  void conclude(BootContext& boot) const {
    const auto planned = [this](Purpose purpose) {
      return std::any_of(rows_.begin(), rows_.end(),
                         [purpose](const Row& row) { return row.purpose == purpose; });
    };
    if (!planned(Purpose::watch_master) && !planned(Purpose::guard_time)) {
      boot.notes.emplace_back(
          "cannot notice a dead master: neither a heartbeat of the master nor node guarding is "
          "configured for it");
    }
    if (!planned(Purpose::be_watched) && !planned(Purpose::guard_time)) {
      boot.notes.emplace_back(
          "not supervised, its loss will show in missing TPDOs only: neither heartbeat nor node "
          "guarding is configured for it");
    }
  }

  std::vector<Row> rows_;
  std::size_t item_ = 0;
  bool comparing_ = false;
  StatePatience patience_;
};

}  // namespace

const char* toString(ErrorControl kind) {
  constexpr std::array<const char*, 3> kNames{{"none", "heartbeat", "guarding"}};
  return kNames.at(static_cast<std::size_t>(kind));
}

BootStepPointer makeErrorControl() { return std::make_unique<ErrorControlSetup>(); }

}  // namespace cia402::canopen
