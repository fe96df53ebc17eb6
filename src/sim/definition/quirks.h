// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "cia402_driver/common/time.h"

namespace cia402::sim {

/// A command of a mode that counts, where 6060h is forgotten while disabled.
enum class ModeCommand : std::uint8_t {
  any,      ///< each that comes, whenever
  enabled,  ///< each that comes while enabled
  change,   ///< one that differs from the last, while enabled
};

/// What drives in the field do otherwise than CiA 402 says; each was seen or told of, see
/// docs/simulated_drives.md. All off: a drive by the book.
struct DriveQuirks {
  bool mode_shown_when_enabled = false;  ///< 6061h is 0 in all states but operation enabled
  ModeCommand mode_command = ModeCommand::any;
  bool mode_needed = false;                       ///< 0x0F enables nothing while the mode is 0
  std::vector<std::int64_t> refused_transitions;  ///< commands of these do nothing
  bool refuses(unsigned transition) const {
    return std::find(refused_transitions.begin(), refused_transitions.end(),
                     std::int64_t{transition}) != refused_transitions.end();
  }
  Duration enabling_time{0};                ///< from 0x0F in Switched on to operation enabled
  bool mode_ignored_while_enabled = false;  ///< 6060h is taken then, and does nothing
  bool halt_blocks_mode = false;            ///< 6060h is ignored while controlword bit 8 is set
  /// Changes of 6060h that it answers by a fault (`mode_change`) while enabled: from, to.
  std::vector<std::pair<std::int64_t, std::int64_t>> mode_faults;
  std::uint16_t fault_bits = 0;           ///< statusword bits beside those of the state fault
  bool fault_keeps_mode_bits = false;     ///< statusword bits 10 to 15 stay in a fault
  std::uint16_t vendor_bits = 0;          ///< statusword bits that change with everything else
  bool homing_reaches_no_target = false;  ///< statusword bit 10 stays 0 in homing
  bool homing_result_stays = false;       ///< bits 10, 12, 13 of a search, until the next one
  bool homing_is_fixed = false;           ///< 6098h and 6099h refuse all writes
  std::int64_t fault_reset_tries = 1;     ///< edges of bit 7 that it takes
  bool fault_reset_needs_empty_history = false;  ///< no edge helps while 1003h:00 is not 0
  bool fault_reset_by_object = false;  ///< no edge helps, a write to the role clear_errors does
  /// A fault is reset only after NMT stop of this length; 0: always.
  Duration fault_reset_needs_stop{0};
  /// From and until when, of the simulated time, the panel has the drive: bit 9 is 0, and the
  /// controlword is not heard.
  Duration local_from{0}, local_until{0};
  /// Somebody at its panel has the drive: it does not listen to the controlword.
  bool isLocal(Time now) const { return now >= Time{local_from} && now < Time{local_until}; }
  Duration reset_edge_time{0};        ///< edges of bit 7 after a shorter low are not seen
  bool no_generic_error_bit = false;  ///< 1001h without bit 0
  /// EMCYs of a fault come and end again and again, and its reset ends them six times over.
  bool emergency_chatter = false;
  bool passive_when_alone = false;  ///< fault `can_passive` where nobody was heard before boot-up
  Duration mode_change_time{0};     ///< of a mode; 6061h is -1 meanwhile
  std::int64_t mode_shown_at_start = 0;    ///< by 6061h until a mode is commanded
  bool sync_needed = false;                ///< else 0x0F makes the fault `rpdo_timeout`
  bool quick_stop_flashes = false;         ///< shows quick stop active for 2 ms only
  bool master_lost_holds = false;          ///< halts with torque then, and outside NMT operational
  bool needs_power_cycle_to_save = false;  ///< no enabling after 1010h until its power was off
  bool shows_no_state = false;             ///< statusword always that of switch on disabled
};

}  // namespace cia402::sim
