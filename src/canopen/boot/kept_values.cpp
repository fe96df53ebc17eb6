// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What RPDOs shall carry of objects that no cycle sets: what the drive holds after the start-up
// writes, so that the first RPDO changes nothing.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"

namespace cia402::canopen {
namespace {

class KeptValues : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (!listed_) list(boot.config);
    if (item_ >= entries_.size()) return false;
    boot.read(entries_[item_].entry->object, entries_[item_].entry->name, now);
    return true;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    const PdoEntry& entry = *entries_[item_].entry;
    if (boot.ok() && boot.ticket->data().size() <= 8) {
      boot.found.kept.push_back({entry.object, toUnsigned(boot.ticket->data())});
    } else if (!boot.ok() && !boot.refused()) {
      return boot.failTransfer();
    } else if (const Bytes* data = written(boot.config, entry.object)) {
      boot.found.kept.push_back({entry.object, toUnsigned(*data)});
    } else {
      return unknown(boot);
    }
    ++item_;
    return Progress::again;
  }

 private:
  struct Kept {
    const PdoEntry* entry;
    unsigned rpdo;
  };

  void list(const NodeConfig& config) {
    listed_ = true;
    for (const PdoConfig& pdo : config.pdos) {
      if (!pdo.enabled || pdo.direction != PdoDirection::rpdo) continue;
      for (const PdoEntry& entry : pdo.entries) {
        if (entry.kept) entries_.push_back({&entry, pdo.number});
      }
    }
  }

  /// By the start-up writes; the last one counts.
  static const Bytes* written(const NodeConfig& config, ObjectId object) {
    const Bytes* data = nullptr;
    for (const StartupWrite& write : config.writes) {
      if (!write.always && write.object == object && write.data.size() <= 8) data = &write.data;
    }
    return data;
  }

  Progress unknown(BootContext& boot) const {
    const PdoEntry& entry = *entries_[item_].entry;
    const std::string why = boot.ok() ? "it is too long" : boot.ticket->reason();
    return boot.fail(BootFailure::refused,
                     "boot failed: what RPDO " + std::to_string(entries_[item_].rpdo) +
                         " shall carry of " + objectText(entry.object, entry.name) +
                         " is not known: nothing writes it, and the drive does not tell it (" +
                         why + "); give it by `write`, or take it out of the RPDO");
  }

  bool listed_ = false;
  std::vector<Kept> entries_;
  std::size_t item_ = 0;
};

}  // namespace

BootStepPointer makeKeptValues() { return std::make_unique<KeptValues>(); }

}  // namespace cia402::canopen
