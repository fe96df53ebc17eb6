// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The start-up writes: those that are always done first of all, those that go before the PDOs, and
// the others, last.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

enum class Part : std::uint8_t { always, before_pdos, others };

Part partOf(const StartupWrite& write) {
  if (write.always) return Part::always;
  return write.before_pdos ? Part::before_pdos : Part::others;
}

class Writes : public BootStep {
 public:
  explicit Writes(Part part) : part_(part), always_(part == Part::always) {}

  bool begin(BootContext& boot, Time now) override {
    if (boot.found.unchanged && !always_) return false;
    const std::vector<StartupWrite>& writes = boot.config.writes;
    while (item_ < writes.size() && partOf(writes[item_]) != part_) ++item_;
    if (item_ >= writes.size()) return false;
    reading_ = writes[item_].only_if_different;
    if (reading_) {
      boot.read(writes[item_].object, writes[item_].name, now, options(boot));
    } else {
      send(boot, now);
    }
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (const auto resting = patience_.rest(boot, now)) return *resting;
    if (!boot.answered()) return Progress::waiting;
    if (reading_back_) return readBack(boot);
    if (reading_) return compare(boot, now);
    if (boot.ok()) tellLater(boot);
    if (boot.ok()) return boot.config.reads_back && !always_ ? askBack(boot, now) : done();
    const bool optional = boot.config.writes[item_].optional;
    if (!optional && patience_.grant(boot, boot.ticket->abortCode(), now)) return Progress::waiting;
    if (!always_ && leaveOut(boot)) return done();
    if (!optional || !boot.refused()) return boot.failTransfer();
    boot.noteTransfer(always_ ? "was not told to stop before it was configured"
                              : "optional start-up write left out");
    return done();
  }

 private:
  SdoOptions options(const BootContext& boot) const {
    const StartupWrite& write = boot.config.writes[item_];
    return write.optional || write.by_default ? boot.ifThere() : boot.config.sdo;
  }

  /// What nobody asked for by name, and the drive does not have or does not let write.
  bool leaveOut(BootContext& boot) const {
    const StartupWrite& write = boot.config.writes[item_];
    const std::uint32_t abort = boot.refused() ? boot.ticket->abortCode() : 0;
    if (!abort_code::saysLacking(abort) || !(write.optional || write.by_default)) return false;
    (write.by_default && !write.optional ? boot.found.lacking : boot.found.lacking_optional)
        .push_back(objectText(write.object, write.name));
    return true;
  }

  Progress done() {
    ++item_;
    patience_.renew();
    return Progress::again;
  }

  void send(BootContext& boot, Time now) {
    const StartupWrite& wanted = boot.config.writes[item_];
    reading_ = false;
    boot.write(wanted.object, wanted.data, wanted.name, now, options(boot));
  }

  void tellLater(BootContext& boot) const {
    const StartupWrite& write = boot.config.writes[item_];
    if (!write.after_power) return;
    boot.notes.push_back(objectText(write.object, write.name) +
                         " was written, and counts once the drive was switched off and on");
  }

  Progress askBack(BootContext& boot, Time now) {
    const StartupWrite& write = boot.config.writes[item_];
    written_ = boot.ticket->data();
    reading_back_ = true;
    boot.read(write.object, write.name, now, options(boot));
    return Progress::waiting;
  }

  /// Some drives send four bytes, whatever the type.
  bool holdsSame(const Bytes& held) const {
    const bool long_enough = held.size() >= written_.size() && held.size() <= 8;
    return held == written_ || (long_enough && toUnsigned(held) == toUnsigned(written_));
  }

  /// What cannot be read is believed.
  Progress readBack(BootContext& boot) {
    reading_back_ = false;
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    if (!boot.ok() || holdsSame(boot.ticket->data())) return done();
    const StartupWrite& write = boot.config.writes[item_];
    return boot.fail(BootFailure::refused,
                     "boot failed: the drive took " + valueText(written_) + " for " +
                         objectText(write.object, write.name) + ", but holds " +
                         valueText(boot.ticket->data()) +
                         "; look for a limit of its own, or write what it can hold");
  }

  Progress compare(BootContext& boot, Time now) {
    if (boot.ok() && boot.ticket->data() == boot.config.writes[item_].data) return done();
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    send(boot, now);  // also where the object cannot be read
    return Progress::waiting;
  }

  const Part part_;
  const bool always_;
  std::size_t item_ = 0;
  bool reading_ = false, reading_back_ = false;
  Bytes written_;
  StatePatience patience_;
};

}  // namespace

BootStepPointer makeStop() { return std::make_unique<Writes>(Part::always); }
BootStepPointer makeEarlyWrites() { return std::make_unique<Writes>(Part::before_pdos); }
BootStepPointer makeStartupWrites() { return std::make_unique<Writes>(Part::others); }

}  // namespace cia402::canopen
