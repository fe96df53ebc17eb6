// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cia402_driver/common/result.h"
#include "fieldbus/object.h"

namespace cia402::fieldbus {

/// A value as it travels by SDO: little-endian, as long as its type.
using ObjectValue = std::vector<std::uint8_t>;

/// Object codes of CiA 301, 7.4.3, as far as they stand in an object dictionary.
enum class ObjectCode : std::uint8_t {
  domain = 2,
  deftype = 5,
  defstruct = 6,
  variable = 7,
  array = 8,
  record = 9,
};
/// "VAR", "ARRAY", ...: the words of CiA 301, table 42.
const char* toString(ObjectCode code);

/// Access types of CiA 306: rwr and rww are read and written by SDO, and read (rwr) or written
/// (rww) by PDO.
enum class Access : std::uint8_t { ro, wo, rw, rwr, rww, constant };
/// "ro", ... "const".
const char* toString(Access access);
/// Can it be read by SDO?
constexpr bool isReadable(Access access) { return access != Access::wo; }
/// Can it be written by SDO?
constexpr bool isWritable(Access access) {
  return access != Access::ro && access != Access::constant;
}

/// Number of a data type in an object dictionary (CiA 301, table 44): 0007h for uint32.
std::uint16_t dataTypeCode(DataType type);
/// @return nothing for complex, manufacturer-specific (0040h and above) and unknown types.
std::optional<DataType> dataTypeOfCode(std::uint16_t code);

/// One sub-index of an object; that of a VAR is 0.
struct DictionaryEntry {
  ObjectId id;
  std::string name;        ///< UTF-8
  std::string denotation;  ///< the name that whoever configured the device gave it, or empty
  DataType type = DataType::uint32;
  Access access = Access::rw;
  bool mappable = false;    ///< into a PDO
  std::uint32_t flags = 0;  ///< ObjFlags of CiA 306: bit 0: not to be written by a download of the
                            ///< DCF, bit 1: not to be read by a scan
  std::optional<ObjectValue> low, high;      ///< limits of a number
  std::optional<ObjectValue> default_value;  ///< after power-on; $NODEID is added already
  std::optional<ObjectValue> value;          ///< DCF: ParameterValue
  bool default_adds_node_id = false;         ///< default_value was written with $NODEID
  std::string upload_file, download_file;    ///< DOMAIN of a DCF
  unsigned line = 0;                         ///< of the file it was read from; 0: none
};

/// One index of an object dictionary with all its sub-indices.
struct DictionaryObject {
  std::uint16_t index = 0;
  std::string name;
  ObjectCode code = ObjectCode::variable;
  std::map<std::uint8_t, DictionaryEntry> entries;
};

/// What objects a device has, as an EDS or DCF tells it (CiA 306).
class ObjectDictionary {
 public:
  /// Adds or replaces an object.
  DictionaryObject& set(DictionaryObject object);
  const std::map<std::uint16_t, DictionaryObject>& objects() const { return objects_; }
  std::map<std::uint16_t, DictionaryObject>& objects() { return objects_; }
  /// Number of entries of all objects.
  std::size_t size() const;

  /// nullptr if there is no such entry.
  const DictionaryEntry* find(ObjectId id) const;
  /// By name, without regard to case and blanks: "Target position", "Identity object/Vendor-ID"
  /// (object and entry), or the entry's name alone where only one entry has it. An error says that
  /// there is none, or which there are.
  Result<const DictionaryEntry*> find(std::string_view name) const;
  /// "Target position", "Identity object/Vendor-ID".
  std::string fullName(const DictionaryEntry& entry) const;

 private:
  std::map<std::uint16_t, DictionaryObject> objects_;
};

/// What a device's maker says of its objects.
struct DeviceDescription {
  std::string file;  ///< without its folder, for messages
  ObjectDictionary dictionary;
};

/// `name` in lower case without blanks: what names are compared by.
std::string nameKey(std::string_view name);

/// Compares two values of a type by their number. Both must be as long as the type.
/// @return below, at or above 0; 0 for types that are no numbers.
int compareValues(DataType type, const ObjectValue& a, const ObjectValue& b);
/// The number in a value of 4 (REAL32) or 8 bytes (REAL64).
double realOf(const ObjectValue& value);
/// A value for people: "-5", "1.5", "\"text\"", "01 02".
std::string describeValue(DataType type, const ObjectValue& value);
/// Whether a value may be written: access, length and limits.
/// @param source of the dictionary for the message: "motor.eds".
Result<void> checkWrite(const DictionaryEntry& entry, const ObjectValue& value,
                        const std::string& source);

}  // namespace cia402::fieldbus
