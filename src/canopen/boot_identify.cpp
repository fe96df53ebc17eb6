// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// The first steps of the boot procedure: is somebody there, and who is it.
#include <array>

#include "boot.h"
#include "boot_text.h"

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
  return "is another drive than configured: " + objectText(object, name) + " is " + hex32(is) +
         ", configured is " + hex32(wanted) +
         "; check node-ID and wiring, or correct `identity` in the configuration";
}

}  // namespace

bool BootProcedure::beginWaitingForBootUp(Time now) {
  step_ = "waiting for boot-up";
  deadline_ = now + config_.boot_timeout / 4;
  return true;
}

BootProcedure::Progress BootProcedure::checkWaitingForBootUp(Time now) {
  if (now < deadline_) return Progress::waiting;
  boot_up_missed_ = true;
  heartbeat_heard_ = false;  // those so far may have left before the reset
  return Progress::next;
}

bool BootProcedure::beginProofOfLife(Time now) {
  SdoOptions once = config_.sdo;
  once.retries = 0;  // asked again until absent_at_
  read(kDeviceType, kDeviceTypeName, now, once);
  return true;
}

BootProcedure::Progress BootProcedure::checkProofOfLife(Time now) {
  if (!ticket_->done()) return Progress::waiting;
  if (ticket_->failure() == SdoTransfer::Failure::timed_out) {
    return now < absent_at_ ? Progress::again : nobodyThere();
  }
  if (!ticket_->ok() && !refused()) return failTransfer();
  if (boot_up_missed_) {
    // The drive is there but took no notice of the reset: it may still be operational.
    sink_.send(nmtFrame(NmtCommand::enter_pre_operational, config_.node_id));
  }
  identity_.emplace();
  if (!ticket_->ok()) {
    if (config_.device_type) return failTransfer();
    note("cannot be read: " + objectText(kDeviceType, kDeviceTypeName) + ": " + ticket_->reason());
    return Progress::next;
  }
  identity_->device_type = static_cast<std::uint32_t>(toUnsigned(ticket_->data()));
  if (config_.device_type && *config_.device_type != identity_->device_type) {
    return fail(
        mismatch(kDeviceType, kDeviceTypeName, identity_->device_type, *config_.device_type));
  }
  return Progress::next;
}

BootProcedure::Progress BootProcedure::nobodyThere() {
  if (heartbeat_heard_) {
    return fail("sends heartbeats, but did not answer SDO requests (" + step_ + ") for " +
                secondsText(config_.boot_timeout) +
                "; look for a second device with this node-ID, or raise the SDO time-out");
  }
  status_ = Status::absent;
  return fail("does not answer: neither a boot-up message nor an answer to " + step_ +
              " came within " + secondsText(config_.boot_timeout) +
              "; check power, cable and termination, bit rate and node-ID");
}

bool BootProcedure::beginIdentity(Time now) {
  if (item_ >= kIdentity.size()) return false;
  read({0x1018, kIdentity[item_].subindex}, kIdentity[item_].name, now);
  return true;
}

BootProcedure::Progress BootProcedure::checkIdentity(Time) {
  if (!ticket_->done()) return Progress::waiting;
  const IdentityRow& row = kIdentity[item_];
  const std::optional<std::uint32_t>& configured = config_.*row.configured;
  if (!ticket_->ok()) {
    if (configured || !refused()) return failTransfer();
    return Progress::again;  // only the vendor id is mandatory, and nobody asked for it
  }
  const auto value = static_cast<std::uint32_t>(toUnsigned(ticket_->data()));
  (*identity_).*row.read = value;
  if (configured && *configured != value) {
    return fail(mismatch({0x1018, row.subindex}, row.name, value, *configured));
  }
  return Progress::again;
}

}  // namespace cia402::canopen
