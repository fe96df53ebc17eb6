// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/boot/signature.h"

namespace cia402::canopen {
namespace {

/// FNV-1a, 64 bits.
class Checksum {
 public:
  void add(std::uint64_t number) {
    for (unsigned i = 0; i < 8; ++i) addByte(static_cast<std::uint8_t>(number >> (8 * i)));
  }
  void add(const Bytes& bytes) {
    add(bytes.size());
    for (const std::uint8_t byte : bytes) addByte(byte);
  }
  void add(ObjectId object) {
    add(static_cast<std::uint64_t>(object.index) << 8 | object.subindex);
  }
  void add(Duration duration) { add(static_cast<std::uint64_t>(duration.count())); }
  std::uint64_t value() const { return value_; }

 private:
  void addByte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001B3; }
  std::uint64_t value_ = 0xCBF29CE484222325;
};

void addPdo(Checksum& sum, const PdoConfig& pdo) {
  sum.add(static_cast<std::uint64_t>(pdo.direction));
  sum.add(pdo.number);
  sum.add(pdo.enabled ? 1U : 0U);
  sum.add(pdo.cob_id);
  sum.add(pdo.transmission);
  sum.add(pdo.inhibit);
  sum.add(pdo.event_timer);
  if (pdo.sync_start.value_or(0) != 0) sum.add(*pdo.sync_start);
  sum.add(pdo.entries.size());
  for (const PdoEntry& entry : pdo.entries) {
    sum.add(entry.object);
    sum.add(entry.bits);
  }
}

std::uint64_t checksum(const NodeConfig& config, const Node::Identity& identity,
                       bool external_sync) {
  Checksum sum;
  for (const std::uint32_t part : {identity.device_type, identity.vendor_id, identity.product_code,
                                   identity.revision, identity.serial}) {
    sum.add(part);
  }
  sum.add(config.node_id);
  sum.add(static_cast<std::uint64_t>(config.error_control));
  for (const Duration time : {config.heartbeat, config.master_timeout, config.guard_time}) {
    sum.add(time);
  }
  sum.add(config.life_time_factor);
  sum.add(config.sync_counter ? *config.sync_counter + 1U : 0U);
  sum.add(config.sync_period_us ? *config.sync_period_us + std::uint64_t{1} : 0U);
  sum.add(config.pdos.size());
  for (const PdoConfig& pdo : config.pdos) addPdo(sum, pdo);
  sum.add(config.writes.size());
  for (const StartupWrite& write : config.writes) {
    sum.add(write.object);
    sum.add(write.data);
  }
  if (external_sync) sum.add(1U);  // 1005h is another one
  return sum.value();
}

}  // namespace

ConfigurationSignature configurationSignature(const NodeConfig& config,
                                              const Node::Identity& identity, bool external_sync) {
  if (config.boot.check == ConfigurationCheck::date) return {config.boot.date, config.boot.time};
  constexpr std::uint64_t kDays = 0xFFFF, kMilliseconds = 86400000 - 1;
  const std::uint64_t sum = checksum(config, identity, external_sync);
  return {static_cast<std::uint32_t>(1 + (sum >> 32) % kDays),
          static_cast<std::uint32_t>(1 + (sum & 0xFFFFFFFF) % kMilliseconds)};
}

}  // namespace cia402::canopen
