// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fieldbus/object.h"

namespace cia402::sim {

using fieldbus::DataType;
using fieldbus::ObjectId;

/// Access rights of an entry as CiA 306 names them.
enum class Access : std::uint8_t { ro, wo, rw, constant };

/// One entry of a simulated device's object dictionary. Numbers live in `number` (two's complement,
/// truncated to the type's width), strings and domains in `bytes`.
struct Entry {
  ObjectId id;
  std::string name;
  DataType type = DataType::uint32;
  Access access = Access::rw;
  bool rpdo = false;    ///< may be mapped into an RPDO
  bool tpdo = false;    ///< may be mapped into a TPDO
  bool waits = false;   ///< `number` counts later only: until then the drive goes by `goes_by`
  bool deaf = false;    ///< writes from the bus are taken and change nothing
  bool clamps = false;  ///< a number out of range becomes the limit that it exceeds
  std::uint64_t number = 0;
  std::vector<std::uint8_t> bytes;
  std::optional<std::int64_t> low, high;    ///< allowed range of integers, inclusive
  std::uint64_t initial_number = 0;         ///< value after power-on; add() takes it from `number`
  std::vector<std::uint8_t> initial_bytes;  ///< the same for `bytes`
  std::uint64_t goes_by = 0;                ///< while it `waits`

  /// By which the drive goes.
  std::uint64_t acting() const { return waits ? goes_by : number; }
};

/// The object dictionary of a simulated device. Pointers to entries stay valid for its life.
class ObjectDictionary {
 public:
  /// Adds or replaces an entry. The value it carries is also its value after power-on. Hooks and
  /// pointers of a replaced entry stay.
  Entry& add(Entry entry);
  Entry* find(ObjectId id);
  const Entry* find(ObjectId id) const;
  bool hasIndex(std::uint16_t index) const;

  /// Called before a write from the bus is taken; a non-zero abort code refuses it. The entry still
  /// has its old value.
  using WriteCheck = std::function<std::uint32_t(const Entry&, std::uint64_t number)>;
  /// Called after a write from the bus (SDO or RPDO) was taken.
  using WriteHook = std::function<void(const Entry&)>;
  /// Called before an entry is read by SDO or TPDO, to bring its value up to date or to refuse.
  using ReadHook = std::function<std::uint32_t(Entry&)>;
  struct Hooks {
    WriteCheck check;
    WriteHook write;
    ReadHook read;
  };
  /// One hook of each kind per object; a later one (also an empty one) replaces it. The device uses
  /// those of the communication objects 1000h-1FFFh that it serves (device.h).
  void onWriteCheck(ObjectId id, WriteCheck check);
  void onWrite(ObjectId id, WriteHook hook);
  void onRead(ObjectId id, ReadHook hook);

  /// Called after a write by SDO has changed a value, after the object's own hook.
  void onChange(WriteHook hook) { change_ = std::move(hook); }

  /// The hooks of an object, for those who call them often; the reference stays valid and sees
  /// hooks that are set later.
  const Hooks& hooks(ObjectId id);

  /// Reads as an SDO server does. @return abort code, 0 when `out` (wire order) is valid.
  std::uint32_t read(ObjectId id, std::vector<std::uint8_t>& out);
  /// Writes as an SDO server does: existence, access, length, range, check hook; then the write
  /// hook. @return abort code, 0 when taken.
  std::uint32_t write(ObjectId id, const std::vector<std::uint8_t>& data);
  /// What write() would refuse before it looks at the value: existence, access and, where the size
  /// is known, length. An SDO server asks this when a segmented download begins.
  std::uint32_t checkWritable(ObjectId id, std::optional<std::size_t> size) const;
  /// Writes a number that came by RPDO: the same checks but for the length, hooks called. Does not
  /// allocate.
  std::uint32_t writeNumber(Entry& entry, std::uint64_t number);
  /// The same where the hooks were looked up before.
  std::uint32_t writeNumber(Entry& entry, std::uint64_t number, const Hooks& hooks);

  /// All values back to their power-on values (no hooks).
  void restoreInitial();
  /// The same for the objects first..last, both included.
  void restoreInitial(std::uint16_t first, std::uint16_t last);
  const std::map<ObjectId, Entry>& entries() const { return entries_; }

 private:
  std::map<ObjectId, Entry> entries_;
  std::map<ObjectId, Hooks> hooks_;
  WriteHook change_;
};

/// Number of an entry as a signed value of its own width (sign-extended).
std::int64_t asSigned(const Entry& entry);

/// Width of a number in bits (CiA 301, 7.4.7): boolean 1, integers and reals 8..64; 0 for strings
/// and domains.
constexpr unsigned widthBits(DataType type) {
  switch (type) {
    case DataType::boolean:
      return 1;
    case DataType::int8:
    case DataType::uint8:
      return 8;
    case DataType::int16:
    case DataType::uint16:
      return 16;
    case DataType::int24:
    case DataType::uint24:
      return 24;
    case DataType::int32:
    case DataType::uint32:
    case DataType::real32:
      return 32;
    case DataType::int40:
    case DataType::uint40:
      return 40;
    case DataType::int48:
    case DataType::uint48:
    case DataType::time_of_day:
    case DataType::time_difference:
      return 48;
    case DataType::int56:
    case DataType::uint56:
      return 56;
    case DataType::int64:
    case DataType::uint64:
    case DataType::real64:
      return 64;
    default:
      return 0;
  }
}

}  // namespace cia402::sim
