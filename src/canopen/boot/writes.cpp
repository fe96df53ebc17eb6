// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The start-up writes: those that are always done first of all, those of profile and user last.
#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "fieldbus/abort_code.h"

namespace cia402::canopen {
namespace {

class Writes : public BootStep {
 public:
  /// @param always those that are no configuration, else the others.
  explicit Writes(bool always) : always_(always) {}

  bool begin(BootContext& boot, Time now) override {
    if (boot.found.unchanged && !always_) return false;
    const std::vector<StartupWrite>& writes = boot.config.writes;
    while (item_ < writes.size() && writes[item_].always != always_) ++item_;
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
    if (verifying_) return verify(boot);
    if (reading_) return compare(boot, now);
    if (boot.ok() && boot.config.writes[item_].read_back) return readBack(boot, now);
    if (boot.ok()) return done();
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

  Progress compare(BootContext& boot, Time now) {
    if (boot.ok() && boot.ticket->data() == boot.config.writes[item_].data) return done();
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    send(boot, now);  // also where the object cannot be read
    return Progress::waiting;
  }

  Progress readBack(BootContext& boot, Time now) {
    const StartupWrite& written = boot.config.writes[item_];
    boot.read(written.object, written.name, now, options(boot));
    verifying_ = true;
    return Progress::waiting;
  }

  /// What cannot be read again is believed.
  Progress verify(BootContext& boot) {
    const StartupWrite& written = boot.config.writes[item_];
    verifying_ = false;
    if (!boot.ok()) return boot.refused() ? done() : boot.failTransfer();
    const std::uint64_t wanted = toUnsigned(written.data);
    const Bytes& holds = boot.ticket->data();  // of which some drives send four, whatever the type
    const bool long_enough = holds.size() >= written.data.size() && holds.size() <= 8;
    if (holds == written.data || (long_enough && toUnsigned(holds) == wanted)) return done();
    return boot.fail(BootFailure::refused,
                     "it took " + objectText(written.object, written.name) + " = " +
                         std::to_string(wanted) + ", but holds " +
                         std::to_string(toUnsigned(holds)) +
                         " when it is read back: look at its range in the drive's manual");
  }

  const bool always_;
  std::size_t item_ = 0;
  bool reading_ = false, verifying_ = false;
  StatePatience patience_;
};

}  // namespace

BootStepPointer makeStop() { return std::make_unique<Writes>(true); }
BootStepPointer makeStartupWrites() { return std::make_unique<Writes>(false); }

}  // namespace cia402::canopen
