// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cia402_driver/canopen/object.h"

namespace cia402::sim {

using canopen::DataType;
using canopen::ObjectId;

/// Access rights of an entry as CiA 306 names them.
enum class Access : std::uint8_t { ro, wo, rw, constant };

/// One entry of a simulated device's object dictionary. Numbers live in `number` (two's complement,
/// truncated to the type's width), strings and domains in `bytes`.
struct Entry {
  ObjectId id;
  std::string name;
  DataType type = DataType::uint32;
  Access access = Access::rw;
  bool rpdo = false;  ///< may be mapped into an RPDO
  bool tpdo = false;  ///< may be mapped into a TPDO
  std::uint64_t number = 0;
  std::vector<std::uint8_t> bytes;
  std::optional<std::int64_t> low, high;  ///< allowed range of integers, inclusive
  std::uint64_t initial_number = 0;       ///< value after power-on
};

/// The object dictionary of a simulated device. Pointers to entries stay valid for its life.
class ObjectDictionary {
 public:
  /// Adds or replaces an entry.
  Entry& add(Entry entry);
  Entry* find(ObjectId id);
  const Entry* find(ObjectId id) const;
  bool hasIndex(std::uint16_t index) const;

  /// Called before a write from the bus is taken; a non-zero abort code refuses it.
  using WriteCheck = std::function<std::uint32_t(const Entry&, std::uint64_t number)>;
  /// Called after a write from the bus (SDO or RPDO) was taken.
  using WriteHook = std::function<void(const Entry&)>;
  /// Called before an entry is read by SDO or TPDO, to bring its value up to date or to refuse.
  using ReadHook = std::function<std::uint32_t(Entry&)>;
  void onWriteCheck(ObjectId id, WriteCheck check);
  void onWrite(ObjectId id, WriteHook hook);
  void onRead(ObjectId id, ReadHook hook);

  /// Reads as an SDO server does. @return abort code, 0 when `out` (wire order) is valid.
  std::uint32_t read(ObjectId id, std::vector<std::uint8_t>& out);
  /// Writes as an SDO server does: existence, access, length, range, check hook; then the write
  /// hook. @return abort code, 0 when taken.
  std::uint32_t write(ObjectId id, const std::vector<std::uint8_t>& data);
  /// Writes a number that came by RPDO: the same checks but for the length, hooks called. Does not
  /// allocate.
  std::uint32_t writeNumber(Entry& entry, std::uint64_t number);

  /// All numbers back to their power-on values (no hooks).
  void restoreInitial();
  const std::map<ObjectId, Entry>& entries() const { return entries_; }

 private:
  struct Hooks {
    WriteCheck check;
    WriteHook write;
    ReadHook read;
  };
  std::map<ObjectId, Entry> entries_;
  std::map<ObjectId, Hooks> hooks_;
};

/// Number of an entry as a signed value of its own width (sign-extended).
std::int64_t asSigned(const Entry& entry);

}  // namespace cia402::sim
