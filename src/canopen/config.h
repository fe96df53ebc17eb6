// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canopen/half_floats.h"
#include "canopen/object.h"
#include "canopen/pdo/config.h"
#include "canopen/sdo/options.h"
#include "cia402_driver/common/time.h"

namespace cia402::canopen {

/// How the loss of a node is noticed, and by the node that of the master (CiA 301, 7.2.8.3.2).
enum class ErrorControl : std::uint8_t {
  none,       ///< the loss of the node shows in its missing TPDOs only
  heartbeat,  ///< both send heartbeats and watch those of the other
  guarding,   ///< the master asks by RTR; the node answers and watches that it is asked
};
/// The word of the configuration: "none", "heartbeat", "guarding".
const char* toString(ErrorControl kind);

/// How the master knows that a node still holds what was configured (CiA 301, 7.5.2.23, 1020h).
enum class ConfigurationCheck : std::uint8_t {
  none,      ///< it is configured at each boot
  checksum,  ///< 1020h holds a checksum of what this master wrote last
  date,      ///< 1020h holds the date that was configured for this configuration
};

/// How a boot that did not succeed goes on by itself.
struct BootPolicy {
  bool optional = false;                  ///< the node may be absent without that being an error
  bool restore_before_configure = false;  ///< 1011h:01 once, before the first configuration
  /// How often a boot that failed by a time-out is tried again. What the drive refused, and a wrong
  /// identity, is not.
  unsigned retries = 2;
  Duration retry_delay{std::chrono::seconds(1)};
  /// An absent or lost node is asked for its device type so often, first...
  Duration search_period{std::chrono::seconds(2)};
  /// ... and, doubled each time, at last. Zero: never.
  Duration search_period_max{std::chrono::seconds(30)};
  ConfigurationCheck check = ConfigurationCheck::none;
  std::uint32_t date = 0, time = 0;  ///< 1020h:01, days since 1984-01-01; 1020h:02, ms of the day
};

/// A write to the drive's object dictionary during boot.
struct StartupWrite {
  ObjectId object;
  std::string name;       ///< for messages
  Bytes data;             ///< wire order
  bool optional = false;  ///< an abort by the drive is noted, not an error
  /// Nobody has asked for it by name: left out where the drive does not have the object or does not
  /// let it be written.
  bool by_default = false;
  bool after_power = false;       ///< it counts once the device was switched off and on
  bool only_if_different = true;  ///< read first, write only what differs
  bool always = false;  ///< no configuration but what stops the drive: done at each boot, first
  bool before_pdos = false;  ///< else when the PDOs are set up
};

/// How a motor is stopped that a drive turns as its last master has told it. In modes in which the
/// drive only lets it go when it is stopped another mode takes it over first, at the velocity that
/// it has.
struct BootBrake {
  ObjectId statusword, shown_mode, mode, velocity, target;
  std::vector<int> pushing;  ///< numbers of such modes, in `shown_mode`; there may be none
  int brake = 0;             ///< number of the mode for `mode`, whose target is in `target`
};

/// A whole number whose length the drive says itself.
struct OpenWidth {
  ObjectId object;
  std::string name;                 ///< for messages
  std::size_t bytes = 1, most = 2;  ///< that are assumed, and that it may have
  bool is_signed = false;
};

/// Everything the master must know of one node.
struct NodeConfig {
  NodeId node_id = 0;
  std::string name;   ///< of the axis
  std::string title;  ///< for messages: "shoulder (node 3)"; empty: made of name and node-ID
  /// Identity the node must have where given: 1000h, 1018h:01..04.
  std::optional<std::uint32_t> device_type, vendor_id, product_code, revision, serial;
  std::vector<std::uint32_t> known_products;  ///< 1018h:02; another one is noted, empty: none is
  std::string if_silent;  ///< behind the message that it does not answer; or empty
  ErrorControl error_control = ErrorControl::heartbeat;
  /// Heartbeat asked of the node (1017h); zero: none, the node cannot be supervised.
  Duration heartbeat{std::chrono::milliseconds(100)};
  /// Without a heartbeat for this long the node is lost.
  Duration heartbeat_timeout{std::chrono::milliseconds(300)};
  /// The node shall watch the master's heartbeat (1016h:01) with this time-out; zero: not written.
  Duration master_timeout{std::chrono::milliseconds(300)};
  /// With guarding: how often the node is asked (100Ch), whole ms; without an accepted answer for
  /// `life_time_factor` (100Dh) times that it is lost.
  Duration guard_time{std::chrono::milliseconds(100)};
  std::uint8_t life_time_factor = 3;
  std::optional<std::uint8_t> sync_counter;     ///< 1019h to write; none: not written
  std::optional<std::uint32_t> sync_period_us;  ///< 1006h to write; none: not written
  bool map_count_may_be_read_only = false;      ///< quirk: sub0 of 16xxh/1Axxh aborts 0x06010002
  std::size_t fixed_map_entries = 0;  ///< quirk: sub0 is always this, unused entries are 0; 0: no
  std::vector<PdoConfig> pdos;
  /// What travels without PDOs: read and written by SDO as fast as answers come, one object each.
  std::vector<PdoConfig> by_sdo;
  std::vector<HalfFloat> half_floats;  ///< how wide the drive has these is learnt at each boot
  std::vector<OpenWidth> widths;       ///< whole numbers of which the same is learnt
  std::vector<BootBrake> brakes;       ///< of its axes, before it leaves the NMT state operational
  bool reads_back = false;             ///< what `writes` writes is read again and compared
  std::vector<StartupWrite> writes;    ///< in this order, after the PDOs but for `always`
  /// Behind the warning of what was left out (StartupWrite::by_default, PdoEntry::optional): what
  /// to do about it.
  std::string lacking_remedy;
  SdoOptions sdo;
  SdoChannel sdo_channel;  ///< COB-IDs other than 600h and 580h + node-ID
  std::string lock;        ///< what else may be why the device forbids writes, for messages
  /// It must not get NMT reset node: its communication is reset where it has to start anew.
  bool reset_node_allowed = true;
  bool reset_does_nothing = false;                 ///< it takes the command, and goes on as it is
  Duration boot_timeout{std::chrono::seconds(5)};  ///< from reset to boot-up or an SDO answer
  BootPolicy boot;
};

/// Configuration of the master itself.
struct MasterConfig {
  NodeId node_id = 127;
  Duration heartbeat{std::chrono::milliseconds(100)};  ///< produced; zero: none
  Duration sync_period{std::chrono::milliseconds(4)};
  std::uint8_t sync_counter = 0;  ///< overflow value of the SYNC counter (1019h): 0 or 2..240
  bool external_sync = false;     ///< another device produces SYNC, the master follows it
  bool reset_all = false;         ///< starts with one reset to all nodes, also those of others
  Duration time_interval{0};      ///< of the TIME message; zero: none
  /// bit/s. Requests of booting nodes leave no faster than the bus carries them together with
  /// their answers, and long SDO transfers do not fill the interface's queue; 0: all at once.
  double bitrate = 0.0;
  std::vector<NodeConfig> nodes;
};

}  // namespace cia402::canopen
