// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "canopen/object.h"
#include "cia402_driver/common/result.h"
#include "sim/dictionary/object_dictionary.h"

namespace YAML {
class Node;
}

namespace cia402::sim {

/// An object dictionary as a file describes it, before a node-ID is known.
///
/// The file gives a list. An item is one object or a macro:
///
///     - [0x6040, 0, controlword, uint16, rw, r, 0]
///     - [0x6060, 0, modes_of_operation, int8, rw, r, 0, -1, 10]
///     - [0x1008, 0, device_name, visible_string, const, -, "DM"]
///     - [0x1014, 0, cob_id_emcy, uint32, rw, -, "$NODEID+0x80"]
///     - [0x6080, 0, max_motor_speed, int32, rw, -, f600.0]
///     - array: {index: 0x1016, name: consumer_heartbeat, count: 4, type: uint32, access: rw}
///     - rpdos: {count: 4, valid: [true, true, false, false], types: [1, 1, 1, 254]}
///     - tpdos: {count: 4, valid: false, types: 255, inhibit_times: 0, event_timers: 0}
///
/// Object: index, sub-index, name, type, access (ro wo rw const), PDO (r, t, rt or -), and, where
/// given, default (0 or empty unless given), lowest and highest value. A default is a number, for
/// strings a text, `$NODEID` or `$NODEID+number` (the node-ID is added), or `f` and a real number:
/// its IEEE 754 bit pattern in 32 or 64 bits, as drives use that keep floats in integer objects.
///
/// `array`: sub-index 0 (uint8) and `count` equal entries. Keys: index, name, count, type, access
/// (rw), pdo (-), default (0, or a list), low, high, count_access (const), count_default (count).
///
/// `rpdos`, `tpdos`: communication records 1400h/1800h and mapping records 1600h/1A00h. Keys, each
/// but the first two and the last two a value for all or a list of one for each: first (number of
/// the first one, 1); count; cob_ids (without bit 31; default: the predefined connection set,
/// `$NODEID+0x200` and so on, for the first four, 0 and invalid beyond); valid (true); types (255);
/// inhibit_times, event_timers, sync_starts (sub 3, 5, 6: exist only where given; 3 and 6 only for
/// tpdos); rtr (true; false sets bit 30 of a TPDO's COB-ID); entries (8; objects a mapping can
/// hold); maps (a list of lists of mapping values such as 0x60410010; default empty).
class DictionaryTemplate {
 public:
  /// Reads the list. @return an error that names every problem with its line.
  static Result<DictionaryTemplate> parse(const YAML::Node& list);

  /// Takes the objects of `other`; where both have one, that of `other` counts.
  void add(const DictionaryTemplate& other);
  /// Takes an object away with all its sub-indices. @return false if there is none.
  bool remove(std::uint16_t index);

  /// Objects whose default depends on the node-ID.
  std::vector<ObjectId> nodeIdObjects() const;
  /// The dictionary of the node `node`. With several axes the objects of axis 0 are there once more
  /// for each further one (axis_objects.h), where the file does not give it its own.
  ObjectDictionary build(canopen::NodeId node, unsigned axes = 1) const;

 private:
  friend class DictionaryReader;
  struct Row {
    Entry entry;
    bool add_node_id = false;
  };
  std::vector<Row> rows_;
};

}  // namespace cia402::sim
