// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "can/bus.h"
#include "canopen/nmt/nmt.h"
#include "sim/dictionary/object_dictionary.h"

namespace cia402::sim {

/// How far a device lets the COB-IDs of its PDOs be configured (1400h, 1800h sub 1).
enum class PdoIdentifiers : std::uint8_t {
  writable,       ///< as CiA 301 says
  fixed,          ///< bit 31 only; another identifier is refused with 0x06010002
  fixed_but_rtr,  ///< of TPDOs bit 30, too
  of_node,        ///< bits 0 to 6 are kept; others are refused with 0x06090030
  read_only,      ///< every write is refused with 0x06010002
};

/// The time of a TIME message (CiA 301, 7.2.6).
struct ReceivedTime {
  std::uint32_t milliseconds = 0;  ///< after midnight
  std::uint16_t days = 0;          ///< since 1 January 1984
  Time at{};                       ///< when the message came
};

/// Behaviour switches of a simulated device's communication, where real devices differ. The
/// defaults are those of CiA 301 (clauses of version 4.2.0). May be changed at any time.
struct DeviceBehaviour {
  Duration boot_time{std::chrono::milliseconds(20)};     ///< power-on or reset to boot-up
  Duration sdo_latency{std::chrono::microseconds(200)};  ///< request to answer
  Duration store_time{};  ///< more for a write to 1010h or 1011h: the memory is slow
  bool ignores_nmt_reset = false;
  bool starts_operational = false;     ///< enters NMT operational by itself after boot-up
  bool stays_pre_operational = false;  ///< takes no notice of NMT start (Tongyi IxL)
  Duration boots_again_after{};        ///< sends boot-up a second time so long after; 0: does not
  Duration boot_time_varies{};         ///< at most so much more, another time at each boot
  std::int64_t overruns_at_boot = 0;   ///< EMCYs 0x8110 right after boot-up, which nothing ends
  Duration reset_jams_bus{};           ///< NMT reset node keeps the bus dominant for so long (Elmo)
  Duration restart_after_bus_off{};    ///< leaves bus-off by itself after this time; 0: never
  bool map_count_read_only = false;    ///< sub0 of 16xxh/1Axxh refuses writes with 0x06010002; it
                                       ///< follows the entries written, which may be at any time
  std::int64_t fixed_map_entries = 0;  ///< sub0 is always this and refuses writes likewise; entries
                                       ///< that are 0 map nothing (Curtis 1232E); 0: as written
  bool accepts_plain_sync = true;      ///< take an empty SYNC although 1019h is not 0
  bool sdo_silent = false;             ///< never answers SDO

  // SDO server (7.2.4.3).
  bool generic_length_abort = false;  ///< 0x06070010 for every wrong length instead of ...12, ...13
  bool upload_without_size = false;   ///< upload answers do not tell the size (s = 0)
  bool silent_on_missing = false;     ///< answers nothing where it should abort with 0x06020000 or
                                      ///< 0x06090011 (the servo of canopen-python/canopen#278)
  bool echoes_writes = false;         ///< confirms an expedited write with its data (NaviCAN)
  bool leaves_rubbish = false;        ///< bytes of expedited answers that mean nothing are not 0
                                      ///< (ros-industrial/ros_canopen#259)
  bool answers_four_bytes = false;    ///< every expedited answer has four bytes, whatever the type
                                      ///< (canopen-python/canopen#395)
  bool announces_four_bytes = false;  ///< segmented uploads announce four bytes, whatever comes
                                      ///< (canopen-python/canopen#135)
  bool answers_after_boot = false;    ///< SDO requests that come before boot-up are answered after
                                      ///< it (Ingenia)
  bool accepts_short_sdo = false;     ///< takes requests of fewer than 8 bytes, the rest as 0
  bool sdo_block = true;              ///< has block transfer (else 0x05040001)
  bool sdo_block_crc = true;          ///< computes the CRC of block transfers
  bool sdo_block_crc_error = false;   ///< computes it wrong: sends it, and finds the client's wrong
  std::int64_t sdo_block_size = 127;  ///< segments of a sub-block that downloads shall have, 1..127
  bool sdo_block_size_varies = false;  ///< ... at most, each sub-block another number

  // PDO configuration (7.5.2.35 to 7.5.2.38).
  bool mapping_requires_invalid = true;     ///< 16xxh/1Axxh can be written only while bit 31 of the
                                            ///< COB-ID is set (else 0x08000022), entries only while
                                            ///< sub0 is 0 (else 0x06010000)
  bool map_entry_checked_on_write = false;  ///< a bad entry is refused when it is written, not only
                                            ///< when sub0 is
  bool disable_may_change_id = false;  ///< bits 0..29 of a COB-ID may change in the same write that
                                       ///< sets bit 31
  bool timers_require_invalid = false;  ///< inhibit time and SYNC start value can be written only
                                        ///< while bit 31 of the COB-ID is set (else 0x08000022)
  bool type_requires_invalid = false;   ///< transmission type and event timer likewise
  PdoIdentifiers pdo_identifiers = PdoIdentifiers::writable;
  bool fixed_service_ids = false;  ///< 1005h and 1014h: bits 30 and 31 only (else 0x06090030), and
                                   ///< SYNC is not produced while 1006h is 0
  bool keeps_rtr_bit = false;      ///< TPDOs have bit 30 of the COB-ID set and refuse it as 0
                                   ///< (0x06090030; Roboteq)
  bool misleading_cob_id_abort = false;  ///< takes any COB-ID, and refuses the entries of a PDO
                                         ///< with a bad one (0x06040041; EPOS4)
  bool rtr_types = true;                 ///< TPDO types 252 and 253 exist (else 0x06090030)

  // PDO transmission (7.2.2).
  bool rpdos_at_once = false;   ///< synchronous RPDOs act when they come (Kinco)
  Duration stale_statusword{};  ///< in TPDOs but the first the statusword is so much older
  int tpdo_size_error =
      0;  ///< bytes that TPDOs are too long, or, negative, too short; 0 to 8 leave
  bool type255_event_timer_only = false;   ///< type 255 sends when the event timer ends, never on a
                                           ///< change (Damiao)
  bool sends_event_tpdos_on_start = true;  ///< entering operational sends TPDOs of type 254, 255

  // LSS (CiA 305), where 1018h has its four numbers.
  bool lss = true;
  bool lss_bit_timing = true;             ///< has the bit rates of table 0 (else error 1)
  bool lss_store = true;                  ///< can store (else error 1)
  bool lss_identify_unconfigured = true;  ///< knows command 4Ch (false: CANopenNode,
                                          ///< 305/CO_LSSslave.c)
  bool lss_scanned_with_node_id = false;  ///< takes part in fastscan though it has a node-ID
                                          ///< (lely-core 2.3, src/co/lss.c)
  bool lss_never_found = false;           ///< takes part in it after its last bit, too
  bool lss_waits_for_reset = false;  ///< its first node-ID counts after an NMT reset only, of all
                                     ///< or of node 255 (lely-core 2.3, src/co/nmt.c)
  bool boot_up_message = true;       ///< false: enters pre-operational without a word

  // Supervision.
  bool sync_producer = true;  ///< can produce SYNC (1005h bit 30, 1006h; else 0x06090030)
  bool sync_timeout = false;  ///< no SYNC for 1.5 * 1006h: EMCY 0x8201 (Damiao)
};

/// A CANopen slave (CiA 301) on an object dictionary: boot-up, NMT, SDO servers (expedited,
/// segmented and block; a second one where 1201h has COB-IDs), four or more PDO pairs with mapping
/// and all transmission types, inhibit and event timers, SYNC with counter, heartbeat producer and
/// consumer, node guarding, EMCY with 1001h/1003h. Sans-IO. It shares no encoder with the master on
/// purpose.
///
/// The dictionary says what the device has: a service whose objects are missing does not exist.
/// From the first powerOn() the device uses the write and read hooks of 1003h, 1005h, 1006h, 100Ch,
/// 100Dh, 1012h, 1014h, 1016h, 1017h, 1019h, 1201h and the PDO parameters 1400h-1BFFh; all others
/// are the application's. Node-IDs in default COB-IDs are to be resolved in the dictionary. Errors
/// of communication it reports by itself (EMCY 0x81xx, 0x82xx with bits 0 and 4 of 1001h) and takes
/// back with EMCY 0x0000 when the last one is gone, unless the application then holds a fault of
/// its own.
class Device {
 public:
  /// What the application (the drive) on top wants to know. All calls happen in receive()/tick().
  class Application {
   public:
    virtual ~Application() = default;
    /// The node-ID that an object of the device's own says, from the next reset on; nothing: LSS
    /// says it.
    virtual std::optional<canopen::NodeId> ownNodeId() const { return {}; }
    /// A reset begins with another node-ID than before: defaults that depend on it have changed.
    virtual void onNodeId(canopen::NodeId /*before*/, canopen::NodeId /*now*/) {}
    virtual void onPowerOn(Time) {}  ///< also after reset node / reset communication
    /// After reset communication (1000h-1FFFh are back at their power-on values); onPowerOn()
    /// unless the application tells the two apart.
    virtual void onResetCommunication(Time now) { onPowerOn(now); }
    /// The state just entered; boot_up while initialising.
    virtual void onNmtState(canopen::NmtState, Time) {}
    virtual void onSync(Time) {}  ///< before synchronous TPDOs are sampled; every accepted
                                  ///< SYNC, in pre-operational, too
    virtual void onRpdo(Time) {}  ///< after an RPDO's values were taken
    /// Heartbeat or life guarding was lost, or the controller went bus-off.
    virtual void onMasterLost(Time) {}
    virtual void onMasterBack(Time) {}
    virtual void beforeTpdo(Time) {}  ///< bring actual values up to date; not for notifyChange()
    /// Whether a fault of the application keeps bits of 1001h set, so that the end of a
    /// communication error must not report "no error".
    virtual bool hasFault() const { return false; }
  };

  /// `node` is the stored node-ID; 255: none, LSS has to give one before the device boots.
  /// `dictionary`, `sink` and `application` must outlive the device.
  Device(canopen::NodeId node, can::Sink& sink, ObjectDictionary& dictionary,
         DeviceBehaviour behaviour, Application& application);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Restores the dictionary's power-on values and begins to boot; boot-up after `boot_time`.
  void powerOn(Time now);
  void powerOff();  ///< silent and deaf until powerOn()
  bool powered() const;
  /// Takes a frame from the bus (any frame: what is not meant for it is ignored).
  void receive(const can::Frame& frame, Time now);
  /// Does what is due until `now`.
  void tick(Time now);
  /// When tick() must be called next; kNever if nothing is pending.
  Time nextEvent() const;

  /// The active node-ID, 255 while there is none.
  canopen::NodeId node() const;
  /// The bit rate of the bus, bit/s. A device that LSS has set to another one is deaf and mute (on
  /// a real bus it would disturb). Without this call every bit rate is that of the bus.
  void setBusBitrate(std::uint32_t bitrate);
  /// `unknown` without power, `boot_up` while initialising.
  canopen::NmtState nmtState() const;
  /// Until when it holds the bus dominant (DeviceBehaviour::reset_jams_bus).
  Time jamsUntil() const;
  /// Sends an EMCY and enters it into 1003h; 1001h := error_register. The frame waits (at most 16)
  /// while the inhibit time 1015h runs or the NMT state forbids it; it is lost where 1014h is
  /// disabled or missing. CiA 301, 7.2.7.
  void sendEmergency(std::uint16_t code, std::uint8_t error_register,
                     const std::array<std::uint8_t, 5>& vendor, Time now);
  /// Enters an error into 1003h and tells nobody.
  void rememberError(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor);
  /// The last TIME message heard since power-on or reset.
  std::optional<ReceivedTime> lastTime() const;
  /// The controller went bus-off: reacts like to the loss of the master.
  void onBusOff(Time now);
  /// It is back: EMCY 0x8140.
  void onBusRecovered(Time now);
  /// EMCY 0000h: errors are gone; the history 1003h stays. @param remaining 1001h from now on, bits
  /// of errors that are left (CiA 301, 7.2.7.1).
  void clearEmergency(Time now, std::uint8_t remaining = 0);
  /// Mapped values of event-driven TPDOs may have changed: sends those whose content did, subject
  /// to their inhibit time (types 254, 255 by `behaviour`).
  void notifyChange(Time now);
  DeviceBehaviour& behaviour();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cia402::sim
