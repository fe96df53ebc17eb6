// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/definition/read_communication.h"

namespace cia402::sim {
namespace {

/// How PDOs and identifiers may be configured, and when PDOs are sent.
void readPdoRules(DefinitionReader& reader, DeviceBehaviour& out) {
  reader.read("mapping_requires_invalid", out.mapping_requires_invalid);
  reader.read("map_entry_checked_on_write", out.map_entry_checked_on_write);
  reader.read("disable_may_change_id", out.disable_may_change_id);
  reader.read("timers_require_invalid", out.timers_require_invalid);
  reader.read("type_requires_invalid", out.type_requires_invalid);
  reader.read("rtr_types", out.rtr_types);
  reader.read("fixed_service_ids", out.fixed_service_ids);
  reader.read("type255_event_timer_only", out.type255_event_timer_only);
  reader.read("sends_event_tpdos_on_start", out.sends_event_tpdos_on_start);
  reader.read<PdoIdentifiers>("pdo_identifiers", out.pdo_identifiers,
                              {{"writable", PdoIdentifiers::writable},
                               {"fixed", PdoIdentifiers::fixed},
                               {"fixed_but_rtr", PdoIdentifiers::fixed_but_rtr},
                               {"of_node", PdoIdentifiers::of_node},
                               {"read_only", PdoIdentifiers::read_only}});
}

}  // namespace

void readCommunication(DefinitionReader& reader, DeviceBehaviour& out) {
  reader.read("boot_time", out.boot_time);
  reader.read("sdo_latency", out.sdo_latency);
  reader.read("ignores_nmt_reset", out.ignores_nmt_reset);
  reader.read("map_count_read_only", out.map_count_read_only);
  reader.read("fixed_map_entries", out.fixed_map_entries, 0, 64);
  reader.read("accepts_plain_sync", out.accepts_plain_sync);
  reader.read("generic_length_abort", out.generic_length_abort);
  reader.read("upload_without_size", out.upload_without_size);
  reader.read("silent_on_missing", out.silent_on_missing);
  reader.read("echoes_writes", out.echoes_writes);
  reader.read("leaves_rubbish", out.leaves_rubbish);
  reader.read("answers_four_bytes", out.answers_four_bytes);
  reader.read("announces_four_bytes", out.announces_four_bytes);
  reader.read("answers_after_boot", out.answers_after_boot);
  reader.read("keeps_rtr_bit", out.keeps_rtr_bit);
  reader.read("misleading_cob_id_abort", out.misleading_cob_id_abort);
  reader.read("rpdos_at_once", out.rpdos_at_once);
  reader.read("stale_statusword", out.stale_statusword);
  reader.read("boot_time_varies", out.boot_time_varies);
  reader.read("overruns_at_boot", out.overruns_at_boot, 0, 16);
  reader.read("reset_jams_bus", out.reset_jams_bus);
  reader.read("accepts_short_sdo", out.accepts_short_sdo);
  reader.read("sdo_block", out.sdo_block);
  reader.read("sdo_block_crc", out.sdo_block_crc);
  reader.read("sdo_block_crc_error", out.sdo_block_crc_error);
  reader.read("sdo_block_size", out.sdo_block_size, 1, 127);
  reader.read("sdo_block_size_varies", out.sdo_block_size_varies);
  reader.read("store_time", out.store_time);
  reader.read("starts_operational", out.starts_operational);
  reader.read("stays_pre_operational", out.stays_pre_operational);
  reader.read("boots_again_after", out.boots_again_after);
  reader.read("restart_after_bus_off", out.restart_after_bus_off);
  readPdoRules(reader, out);
  std::int64_t bytes = out.tpdo_size_error;
  reader.read("tpdo_size_error", bytes, -8, 8);
  out.tpdo_size_error = static_cast<int>(bytes);
  reader.read("sync_producer", out.sync_producer);
  reader.read("lss", out.lss);
  reader.read("lss_bit_timing", out.lss_bit_timing);
  reader.read("lss_store", out.lss_store);
  reader.read("lss_identify_unconfigured", out.lss_identify_unconfigured);
  reader.read("lss_scanned_with_node_id", out.lss_scanned_with_node_id);
  reader.read("lss_never_found", out.lss_never_found);
  reader.read("lss_waits_for_reset", out.lss_waits_for_reset);
  reader.read("boot_up_message", out.boot_up_message);
  reader.read("sync_timeout", out.sync_timeout);
}

}  // namespace cia402::sim
