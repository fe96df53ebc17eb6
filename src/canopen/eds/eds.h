// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/object.h"
#include "fieldbus/object_dictionary.h"

namespace cia402::canopen {

using fieldbus::Access;
using fieldbus::compareValues;
using fieldbus::dataTypeCode;
using fieldbus::dataTypeOfCode;
using fieldbus::describeValue;
using fieldbus::DictionaryEntry;
using fieldbus::DictionaryObject;
using fieldbus::nameKey;
using fieldbus::ObjectCode;
using fieldbus::ObjectDictionary;
using fieldbus::ObjectValue;
using fieldbus::realOf;

/// One thing wrong in an EDS or DCF file.
struct EdsProblem {
  /// How bad it is.
  enum class Severity : std::uint8_t {
    warning,  ///< against CiA 306, but what is meant is clear
    error,    ///< something of the file could not be taken over, or contradicts itself
  };
  Severity severity = Severity::warning;
  unsigned line = 0;  ///< from 1
  std::string message;
};
/// "line 12: error: ...".
std::string toString(const EdsProblem& problem);

/// [FileInfo], [DeviceInfo], [DeviceComissioning], [DummyUsage] and [Comments].
struct EdsInfo {
  std::string file_name, description, created_by, modified_by, eds_version;
  std::string creation_date, creation_time, modification_date, modification_time;
  std::string vendor_name, product_name, order_code;
  std::optional<std::uint32_t> vendor_number, product_number, revision_number;
  std::vector<unsigned> baud_rates;  ///< kbit/s
  std::uint16_t rpdo_count = 0, tpdo_count = 0;
  std::uint8_t compact_pdo = 0;  ///< bit n: implied PDO parameters have sub-index n + 1
  std::uint8_t granularity = 0;  ///< of a PDO mapping, bits
  bool lss_supported = false, boot_up_master = false, boot_up_slave = false,
       group_messaging = false;
  std::uint8_t dynamic_channels = 0;
  std::vector<std::uint16_t> dummies;  ///< data types that can be mapped to fill a PDO
  std::vector<std::string> comments;
  // DCF only.
  std::string last_eds;  ///< file that it was made from
  std::optional<NodeId> node_id;
  std::string node_name;
  unsigned baud_rate = 0;  ///< kbit/s; 0: none
  std::optional<std::uint32_t> lss_serial;
};

/// What an EDS or DCF file says (CiA 306), and everything that is wrong with it.
struct Eds {
  EdsInfo info;
  ObjectDictionary dictionary;
  std::vector<EdsProblem> problems;   ///< in the order of their lines
  std::size_t problems_left_out = 0;  ///< beyond kMostEdsProblems
  /// Problems of this severity in the list.
  std::size_t count(EdsProblem::Severity severity) const;
};
inline constexpr std::size_t kMostEdsProblems = 1000;
/// Longest file that is read, bytes; and most entries that are taken over from one: far above real
/// ones, so that a damaged file cannot take all memory.
inline constexpr std::size_t kLongestEds = 32U << 20;
inline constexpr std::size_t kMostEdsEntries = 300'000;

/// Reads the text of an EDS or DCF. Never fails: what is wrong is reported with its line, and
/// reading goes on behind it.
/// @param node_id for $NODEID; absent: the NodeID of the DCF, else 0.
Eds readEds(std::string_view text, std::optional<NodeId> node_id = {});

/// Whether a line of a DCF can hold a value: strings with line ends or zeros, for example, do not
/// fit.
bool fitsDcf(DataType type, const ObjectValue& value);
/// Writes a DCF of `dictionary` (CiA 306): what readEds() reads back equal, with CRLF line ends.
/// Values of any length that no line of text can hold are left out.
std::string writeDcf(const EdsInfo& info, const ObjectDictionary& dictionary);

}  // namespace cia402::canopen
