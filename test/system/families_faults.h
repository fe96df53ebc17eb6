// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "sim/definition/drive_definition.h"
#include "system/families_motion.h"

namespace cia402 {

/// What ends a fault.
enum class Ends : std::uint8_t {
  by_reset,        ///< an edge of controlword bit 7
  by_itself,       ///< likewise, but the drive does it alone, too, once the cause is gone
  after_a_minute,  ///< an edge of bit 7, which is taken 60 s after the fault and no earlier
  by_power_cycle,
};

/// An alarm of a family as its maker's manual has it.
struct FamilyAlarm {
  const char* name;   ///< in the simulated drive
  const char* code;   ///< 603Fh, in people's sentence
  const char* words;  ///< of the manual, in that sentence
  Ends ends = Ends::by_reset;
};

/// Chapter 9 of the NiMotion manual [L2147-2230].
inline std::vector<FamilyAlarm> nimotionFaults() {
  const Ends by_itself = Ends::by_itself;
  return {{"over_current", "0x2300", "over current"},
          {"over_voltage", "0x3110", "over voltage", by_itself},
          {"under_voltage", "0x3120", "under voltage", by_itself},
          {"over_temperature", "0x4310", "drive too hot"},
          {"can_error_passive", "0x8120", "CAN in error passive mode", by_itself},
          {"can_overrun", "0x8130", "CAN mailbox overflow", by_itself},
          {"can_bus_off", "0x8140", "CAN bus off", by_itself},
          {"eeprom", "0x5530", "EEPROM failed", by_itself},
          {"flash", "0x5540", "flash memory failed", by_itself},
          {"thermal_shutdown", "0xFF00", "shut down, far too hot"},
          {"driver_wrong_command", "0xFF01", "driver chip, wrong command"},
          {"driver_not_executable", "0xFF02", "command that it cannot do"},
          {"driver_spi", "0xFF03", "driver chip does not answer"},
          {"driver_self_check", "0xFF07", "self test of the driver stage", by_itself},
          {"encoder_self_check", "0xFF06", "self test of the encoder", by_itself},
          {"encoder_frame", "0xFF08", "encoder frame wrong", by_itself},
          {"encoder_crc", "0xFF09", "encoder checksum wrong", by_itself},
          {"encoder_command", "0xFF0A", "encoder command wrong", by_itself},
          {"encoder_field_high", "0xFF0C", "magnetic field at the encoder too strong", by_itself},
          {"encoder_field_low", "0xFF0D", "magnetic field at the encoder too weak", by_itself},
          {"licence_key", "0xFF11", "licence key wrong", Ends::by_power_cycle}};
}

/// L496-530 of the iD286 manual.
inline std::vector<FamilyAlarm> id286Faults() {
  return {{"over_current", "0x000A", "motor over-current"},
          {"motor_phase_missing", "0x000B", "motor phase missing: no motor at CN2"},
          {"reserved_0c", "0x000C", "alarm 0C of the maker"},
          {"under_voltage", "0x000D", "supply under-voltage: less than 18 V"},
          {"over_voltage", "0x000E", "supply over-voltage"},
          {"over_temperature", "0x000F", "heat sink at 85 degC or more"},
          {"gate_driver", "0x0010", "gate driver voltage fault", Ends::by_power_cycle},
          {"reserved_11", "0x0011", "alarm 11 of the maker"},
          {"reserved_12", "0x0012", "alarm 12 of the maker"},
          {"reserved_13", "0x0013", "alarm 13 of the maker"},
          {"eeprom_write", "0x0014", "parameter memory not written"},
          {"following_error", "0x0019", "following error"},
          {"current_overload", "0x001A", "current overload"},
          {"encoder", "0x001B", "encoder error: encoder wiring"},
          {"master_lost", "0x0064", "communication lost while enabled"}};
}

/// L3687-3795 of the DM5 manual; Er.050, 051, 052, 065 are of the EtherCAT version.
inline std::vector<FamilyAlarm> dm5Faults() {
  const Ends minute = Ends::after_a_minute;
  return {{"overcurrent", "0xFF01", "drive over-current (Er.001)"},
          {"overvoltage", "0xFF02", "supply over-voltage (Er.002)"},
          {"stalled", "0xFF04", "motor stalled (Er.004)"},
          {"input_phase_lost", "0xFF06", "supply phase lost (code 6)"},
          {"output_phase_lost", "0xFF07", "motor phase lost (Er.007)"},
          {"overtemperature", "0xFF08", "drive too hot (Er.008)", minute},
          {"resistor_overload", "0xFF09", "brake resistor overload (Er.009)"},
          {"power_module", "0xFF0A", "power module protection (Er.010)"},
          {"drive_overload", "0xFF0B", "drive overload (Er.011)", minute},
          {"motor_overload", "0xFF0C", "motor overload (Er.012)", minute},
          {"eeprom", "0xFF0D", "parameter memory failed (Er.013)"},
          {"serial_link", "0xFF0E", "serial link failed (Er.014)"},
          {"current_sensing", "0xFF10", "current sensing failed (Er.016)"},
          {"tuning", "0xFF12", "auto-tuning failed (Er.018)"},
          {"encoder", "0xFF13", "encoder fault (Er.019)"},
          {"undervoltage", "0xFF14", "under-voltage while running (Er.020)"},
          {"control_mode_parameter", "0xFF16", "wrong control mode parameter (Er.022)"},
          {"temperature_sensor", "0xFF19", "temperature sensing broken (Er.025)"},
          {"overspeed", "0xFF1B", "over-speed (Er.027)"},
          {"turns_overflow", "0xFF1F", "more than 65535 encoder turns (Er.031)"},
          {"following_error", "0xFF20", "position error too large (Er.032)"},
          {"pulse_input", "0xFF21", "pulse input (Er.033)"},
          {"master_lost", "0xFF24", "bus connection lost (Er.036"},
          {"homing_time", "0xFF25", "homing took too long (Er.037)"},
          {"positive_limit_switch", "0xFF27", "forward limit switch (Er.039)"},
          {"negative_limit_switch", "0xFF28", "reverse limit switch (Er.040)"},
          {"external", "0xFF2B", "external fault input (Er.043)"},
          {"ground_short", "0xFF2E", "short to earth at power-up (Er.046)"},
          {"logic_1", "0xFF2F", "internal logic error (Er.047)"},
          {"logic_2", "0xFF30", "internal logic error (Er.048)"},
          {"logic_3", "0xFF31", "internal logic error (Er.049)"},
          {"position_step", "0xFF35", "position step too large (Er.053)"},
          {"sync_lost", "0xFF36", "synchronisation lost (Er.054"},
          {"gear_ratio", "0xFF3D", "electronic gear ratio (Er.061)"},
          {"interrupt_feed", "0xFF3E", "interrupt feed (Er.062)"},
          {"homing_logic", "0xFF42", "homing logic (Er.066)"},
          {"board_mismatch", "0xFF48", "does not fit the control board (code 72)",
           Ends::by_power_cycle},
          {"turning_at_enable", "0xFF49", "enabled while the motor turned faster than 100 rpm"},
          {"torque_off", "0xFF4A", "torque off (Er.074): STO input"},
          {"battery_low", "0xFF4B", "encoder battery low (Er.075)"},
          {"battery_lost", "0xFF4C", "encoder battery was lost (Er.076)", Ends::by_power_cycle},
          {"encoder_type", "0xFF4D", "encoder is of another type (Er.077)"},
          {"encoder_memory_empty", "0xFF4E", "encoder memory is empty (Er.078)"},
          {"encoder_memory_write", "0xFF4F", "encoder memory cannot be written (Er.079)"},
          {"index_search", "0xFF51", "index of the encoder not found (Er.081)"},
          {"encoder_memory_read", "0xFF54", "encoder memory cannot be read (Er.084)"},
          {"output_broken", "0xFF55", "motor wire broken (Er.085)"}};
}

/// The SV660C manual: codes that it names [L1396-15534], and what it speaks of without a code.
inline std::vector<FamilyAlarm> sv660cFaults() {
  const char* const own = "an error of the maker's own";
  return {{"overcurrent", "0x2310", "continuous over current"},               // L2979
          {"overvoltage", "0x3210", "DC link over voltage"},                  // L3005
          {"undervoltage", "0x3220", "DC link under voltage"},                // L3037
          {"phase_loss", "0x3130", "E420 phase of the mains missing"},        // L7850
          {"overspeed", "0x7310", "E500 over speed"},                         // L7924
          {"motor_overload", "0x3230", "E620 motor overload"},                // L7904
          {"locked_rotor", "0x7121", "E630 motor blocked"},                   // L8096
          {"overtemperature", "0x4310", "drive over temperature"},            // L8146
          {"brake_chopper", "0x7112", "brake chopper over temperature"},      // L8207
          {"encoder", "0x7305", "encoder"},                                   // L8231
          {"encoder_overtemperature", "0xFF00", own},                         // L8221
          {"turns_overflow", "0xFF00", own},                                  // L8126
          {"vibration", "0xFF00", own},                                       // L7775-7789
          {"following_error", "0x8611", "EB00 following error"},              // L15281
          {"position_command", "0xFF00", "EB01 position commands"},           // L7941
          {"home_offset", "0xFF00", "EE09 home offset beyond the position"},  // L15534
          {"sync_error", "0x8700", "SYNC"},                                   // L9661
          {"ip_increment", "0xFF00", own},                                    // L9649
          {"runaway", "0xFF00", "E234 runaway"},                              // L7957-7983
          {"product_mismatch", "0xFF00", "E120 drive and motor do not fit", Ends::by_power_cycle},
          {"parameter", "0x5530", "parameter memory", Ends::by_power_cycle}};  // L9149
}

/// The simulated drive of a family, from its file.
inline std::shared_ptr<const sim::DriveDefinition> familyDefinition(const std::string& family) {
  const auto definition =
      sim::loadDriveDefinition(test::configFolder() + "/simulated_drives/" + family + ".yaml");
  EXPECT_TRUE(definition.ok()) << (definition.ok() ? "" : definition.error().message);
  return definition.ok() ? *definition : nullptr;
}

/// Its faults, or its warnings.
inline std::set<std::string> alarmNames(const sim::DriveDefinition& definition, bool warnings) {
  std::set<std::string> names;
  for (const sim::FaultDefinition& fault : definition.faults) {
    if (fault.warning == warnings) names.insert(fault.name);
  }
  return names;
}

}  // namespace cia402
