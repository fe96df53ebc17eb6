// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// What a drive family is as a device on the bus.
#include <algorithm>

#include "config/profile/parts.h"

namespace cia402::config {
namespace {

void readIdentity(yaml::Section& profile_section, canopen::DeviceProfile& device) {
  const auto value = profile_section.get("identity");
  if (!value) return;
  yaml::Section section(*value);
  section.readInteger("device_type", device.device_type, 0, 0xFFFFFFFF);
  section.readInteger("vendor_id", device.vendor_id, 0, 0xFFFFFFFF);
  section.readInteger("product_code", device.product_code, 0, 0xFFFFFFFF);
  if (const auto known = section.get("known_products")) {
    for (const yaml::Value& entry : known->list()) {
      const auto product = entry.integer(0, 0xFFFFFFFF);
      if (product) device.known_products.push_back(static_cast<std::uint32_t>(*product));
    }
  }
  section.finish();
}

void readPdoRules(yaml::Section& profile_section, const DriveProfile& profile,
                  canopen::DeviceProfile& device) {
  const auto value = profile_section.get("pdo_rules");
  if (!value) return;
  yaml::Section section(*value);
  if (section.readInteger("max_pdos", device.max_rpdos, 1, 16)) {
    device.max_tpdos = device.max_rpdos;
  }
  section.readInteger("max_rpdos", device.max_rpdos, 1, 16);
  section.readInteger("max_tpdos", device.max_tpdos, 1, 16);
  section.readInteger("pdos_per_axis", device.pdos_per_axis, 0, 64);
  section.readInteger("max_entries", device.max_pdo_entries, 1, 64);
  if (section.readInteger("fixed_entries", device.fixed_pdo_entries, 1, 64)) {
    device.max_pdo_entries = std::min(device.max_pdo_entries, device.fixed_pdo_entries);
  }
  section.read("map_count_may_be_read_only", device.pdo_map_count_may_be_read_only);
  if (const auto cob_ids = section.get("cob_ids")) {
    const std::size_t word = cob_ids->oneOf({"predefined", "drive", "of_node"}).value_or(0);
    device.cob_ids_of_drive = word == 1;
    device.cob_ids_of_node = word == 2;
  }
  section.read("rpdo_deadline", device.rpdo_deadline);
  section.read("type_255_by_timer", device.type_255_by_timer);
  section.read("remote_requests", device.remote_requests);
  section.read("sync_starts", device.sync_starts);
  if (const auto fixed = section.get("fixed")) {  // every default of CiA 402 has the controlword
    device.fixed_pdos = readPdos(*fixed, profile, device, Sharing::allowed);
  }
  section.finish();
}

void readSyncAdvice(const yaml::Value& value, canopen::DeviceProfile& device) {
  yaml::Section section(value);
  canopen::DeviceProfile::SyncAdvice advice;
  if (section.require("pdos_per_ms", "how many PDOs fill a millisecond at 1 Mbit/s")) {
    section.read("pdos_per_ms", advice.pdos_per_ms, yaml::Range{0.1, 100.0, false});
  }
  section.read("share", advice.share, yaml::Range{0.01, 1.0, false});
  readDuration(section, "margin", yaml::Range{0.0, 1.0, false}, advice.margin);
  section.finish();
  if (advice.pdos_per_ms > 0.0) device.sync_advice = advice;
}

void readSync(yaml::Section& profile_section, canopen::DeviceProfile& device) {
  const auto value = profile_section.get("sync");
  if (!value) return;
  yaml::Section section(*value);
  section.read("counter_object", device.has_sync_counter_object);
  section.read("period_object", device.has_sync_period_object);
  const auto counter = section.get("counter");
  const auto overflow = counter ? counter->integer(0, 240) : std::nullopt;
  if (overflow == 1) counter->problem("1 is no counter; use 0 (none) or 2 to 240");
  if (overflow) device.sync_counter = static_cast<std::uint8_t>(*overflow);
  if (overflow && !device.has_sync_counter_object) {
    counter->problem("a counter needs the object 1019h, but `counter_object` is false");
  }
  double step = toSeconds(device.sync_period_step);
  section.read("period_step", step, yaml::Range{1e-6, 1.0, false});
  device.sync_period_step = fromSeconds(step);
  const yaml::Range periods{1e-6, 10.0, false};
  readDuration(section, "period_min", periods, device.sync_period_min);
  readDuration(section, "period_max", periods, device.sync_period_max);
  if (const auto advice = section.get("advice")) readSyncAdvice(*advice, device);
  if (device.sync_period_max < device.sync_period_min) {
    section.problem("period_max is below period_min");
  }
  section.finish();
}

void readHeartbeat(yaml::Section& profile_section, canopen::DeviceProfile& device) {
  const auto value = profile_section.get("heartbeat");
  if (!value) return;
  yaml::Section section(*value);
  section.read("producer", device.heartbeat_supported);
  section.read("consumer", device.heartbeat_consumer_supported);
  section.read("node_guarding", device.node_guarding_supported);
  readDuration(section, "period_min", yaml::Range{0.001, 65.535, false}, device.error_control_min);
  section.finish();
}

}  // namespace

void readDevice(yaml::Section& section, yaml::Section& timing, const DriveProfile& profile,
                canopen::DeviceProfile& device) {
  readIdentity(section, device);
  section.read("if_silent", device.if_silent);
  if (const auto reset = section.get("nmt_reset_node")) {
    const std::size_t word = reset->oneOf({"true", "false", "does_nothing"}).value_or(0);
    device.nmt_reset_node = word == 0;
    device.nmt_reset_does_nothing = word == 2;
  }
  readSync(section, device);
  readHeartbeat(section, device);
  const yaml::Range deadline{0.001, 600.0, false};
  readDuration(timing, "boot", deadline, device.boot_time);
  readDuration(timing, "sdo", deadline, device.sdo.timeout);
  timing.readInteger("sdo_retries", device.sdo.retries, 0, 10);
  readPdoRules(section, profile, device);
  if (const auto halves = section.get("half_floats")) readHalfFloats(*halves, profile, device);
  if (const auto pdos = section.get("pdos")) device.pdos = readPdos(*pdos, profile, device);
}

void readDuration(yaml::Section& section, const std::string& key, yaml::Range range,
                  Duration& target) {
  double seconds = toSeconds(target);
  if (section.read(key, seconds, range)) target = fromSeconds(seconds);
}

}  // namespace cia402::config
