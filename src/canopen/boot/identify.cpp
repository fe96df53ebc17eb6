// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The first steps of the boot procedure: is somebody there, and who is it.
#include <algorithm>
#include <array>

#include "canopen/boot/steps.h"
#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr ObjectId kDeviceType{0x1000, 0};
constexpr const char* kDeviceTypeName = "device type";

/// Identity object, CiA 301, 7.5.2.19.
struct IdentityRow {
  std::uint8_t subindex;
  const char* name;
  std::uint32_t Node::Identity::*read;
  std::optional<std::uint32_t> NodeConfig::*configured;
};
constexpr std::array<IdentityRow, 4> kIdentity{{
    {1, "vendor id", &Node::Identity::vendor_id, &NodeConfig::vendor_id},
    {2, "product code", &Node::Identity::product_code, &NodeConfig::product_code},
    {3, "revision number", &Node::Identity::revision, &NodeConfig::revision},
    {4, "serial number", &Node::Identity::serial, &NodeConfig::serial},
}};

std::string mismatch(ObjectId object, const char* name, std::uint32_t is, std::uint32_t wanted) {
  return "is another drive than configured: " + objectText(object, name) + " is " + hexText(is, 8) +
         ", configured is " + hexText(wanted, 8) +
         "; check node-ID and wiring, or correct `identity` in the configuration";
}

class BootUpWait : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (!boot.resetting) return false;
    boot.step = "waiting for boot-up";
    boot.deadline = now + boot.config.boot_timeout / 4;
    return true;
  }
  Progress check(BootContext& boot, Time now) override {
    if (now < boot.deadline) return Progress::waiting;
    boot.resetting = false;
    boot.found.boot_up_missed = true;
    boot.found.heartbeat_heard = false;  // those so far may have left before the reset
    return Progress::next;
  }
};

class ProofOfLife : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    SdoOptions once = boot.config.sdo;
    once.retries = 0;  // asked again until absent_at
    boot.read(kDeviceType, kDeviceTypeName, now, once);
    return true;
  }

  Progress check(BootContext& boot, Time now) override {
    if (!boot.answered()) return Progress::waiting;
    if (boot.ticket->failure() == fieldbus::Transfer::Failure::timed_out) {
      if (now >= boot.absent_at) return nobodyThere(boot);
      boot.wake(now);  // it may be stopped (NMT) and not say so: the command out of it was lost
      return Progress::again;
    }
    if (!boot.ok() && !boot.refused()) return boot.failTransfer();
    // The drive is there but took no notice of the reset: it may still be operational.
    if (boot.found.boot_up_missed) boot.command(NmtCommand::enter_pre_operational, now);
    return identify(boot);
  }

 private:
  static Progress identify(BootContext& boot) {
    Node::Identity& identity = boot.found.identity.emplace();
    const std::optional<std::uint32_t>& configured = boot.config.device_type;
    if (!boot.ok()) {
      if (configured) return boot.failTransfer();
      boot.noteTransfer("its device type is unknown");
      return Progress::next;
    }
    identity.device_type = boot.value();
    if (configured && *configured != identity.device_type) {
      return boot.fail(BootFailure::refused,
                       mismatch(kDeviceType, kDeviceTypeName, identity.device_type, *configured));
    }
    return Progress::next;
  }

  static Progress nobodyThere(BootContext& boot) {
    if (boot.found.stopped_count > 0) return boot.failStopped();
    const std::string unanswered = boot.step + " got no answer for " +
                                   secondsText(boot.config.boot_timeout) +
                                   ", asked again and again";
    if (boot.found.heartbeat_heard) {
      return boot.fail(BootFailure::timed_out,
                       std::string("boot failed: its heartbeat comes (NMT state ") +
                           toString(boot.found.heartbeat_state) + "), but " + unanswered + ": " +
                           kMuteAdvice);
    }
    if (boot.found.after_reset) {
      return boot.fail(BootFailure::absent, "does not answer: its boot-up message came, but " +
                                                unanswered + ": " + kMuteAdvice);
    }
    return boot.fail(BootFailure::absent,
                     "does not answer: neither a boot-up message nor an answer to " + boot.step +
                         " came within " + secondsText(boot.config.boot_timeout) +
                         "; check power, cable and termination, bit rate and node-ID" +
                         (boot.config.if_silent.empty() ? "" : "; " + boot.config.if_silent));
  }
};

class Identification : public BootStep {
 public:
  bool begin(BootContext& boot, Time now) override {
    if (item_ >= kIdentity.size()) return false;
    const IdentityRow& row = kIdentity[item_];
    const bool must_be = row.subindex == 1 || (boot.config.*row.configured).has_value();
    boot.read({0x1018, row.subindex}, row.name, now, must_be ? boot.config.sdo : boot.ifThere());
    return true;
  }

  Progress check(BootContext& boot, Time) override {
    if (!boot.answered()) return Progress::waiting;
    const IdentityRow& row = kIdentity[item_++];
    const std::optional<std::uint32_t>& configured = boot.config.*row.configured;
    if (!boot.ok()) {
      if (configured || !boot.refused()) return boot.failTransfer();
      return Progress::again;  // only the vendor id is mandatory, and nobody asked for it
    }
    const std::uint32_t value = boot.value();
    (*boot.found.identity).*row.read = value;
    if (configured && *configured != value) {
      return boot.fail(BootFailure::refused,
                       mismatch({0x1018, row.subindex}, row.name, value, *configured));
    }
    if (row.subindex == 1) boot.vendor_known = configured.has_value();
    if (row.subindex == 2 && !configured) noteProduct(boot, value);
    return Progress::again;
  }

 private:
  static void noteProduct(BootContext& boot, std::uint32_t product) {
    const std::vector<std::uint32_t>& known = boot.config.known_products;
    if (known.empty() || std::find(known.begin(), known.end(), product) != known.end()) return;
    boot.notes.push_back("its product code (1018:02) " + hexText(product, 8) +
                         " is none that the profile knows: compare its objects with the manual");
  }

  std::size_t item_ = 0;
};

}  // namespace

BootStepPointer makeBootUpWait() { return std::make_unique<BootUpWait>(); }
BootStepPointer makeProofOfLife() { return std::make_unique<ProofOfLife>(); }
BootStepPointer makeIdentification() { return std::make_unique<Identification>(); }

}  // namespace cia402::canopen
