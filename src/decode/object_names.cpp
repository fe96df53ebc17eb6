// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/object_names.h"

namespace cia402::decode {
namespace {

constexpr int kWhole = -1;  // all sub-indices bear the name

struct Row {
  std::uint16_t index;
  int subindex;
  const char* name;
};

/// CiA 301, 7.5.2: what is met when a drive boots.
constexpr Row kRows[] = {
    {0x1000, 0, "device type"},
    {0x1001, 0, "error register"},
    {0x1002, 0, "manufacturer status register"},
    {0x1003, 0, "error history, count"},
    {0x1003, kWhole, "error history"},
    {0x1005, 0, "SYNC COB-ID"},
    {0x1006, 0, "SYNC period"},
    {0x1007, 0, "SYNC window"},
    {0x1008, 0, "device name"},
    {0x1009, 0, "hardware version"},
    {0x100A, 0, "software version"},
    {0x100C, 0, "guard time"},
    {0x100D, 0, "life time factor"},
    {0x1010, kWhole, "store parameters"},
    {0x1011, kWhole, "restore parameters"},
    {0x1012, 0, "TIME COB-ID"},
    {0x1014, 0, "EMCY COB-ID"},
    {0x1015, 0, "EMCY inhibit time"},
    {0x1016, kWhole, "consumer heartbeat time"},
    {0x1017, 0, "producer heartbeat time"},
    {0x1018, 1, "vendor id"},
    {0x1018, 2, "product code"},
    {0x1018, 3, "revision"},
    {0x1018, 4, "serial number"},
    {0x1018, kWhole, "identity"},
    {0x1019, 0, "SYNC counter overflow"},
    {0x1020, 1, "configuration date"},
    {0x1020, 2, "configuration time"},
    {0x1029, kWhole, "error behaviour"},
};

/// Sub-indices of 1400h.. and 1800h.. (CiA 301, 7.5.2.35 and 37).
constexpr const char* kCommunication[] = {"highest sub-index", "COB-ID",   "transmission type",
                                          "inhibit time",      "reserved", "event timer",
                                          "SYNC start value"};

std::string pdoName(const char* kind, unsigned number, bool mapping, unsigned subindex) {
  const std::string pdo = kind + std::to_string(number);
  if (mapping) {
    return pdo +
           (subindex == 0 ? " mapping, count" : " mapping, entry " + std::to_string(subindex));
  }
  return subindex < sizeof kCommunication / sizeof *kCommunication
             ? pdo + " " + kCommunication[subindex]
             : pdo;
}

}  // namespace

std::string communicationObjectName(fieldbus::ObjectId object) {
  if (object.index >= 0x1400 && object.index < 0x1C00) {
    const unsigned group = (object.index - 0x1400U) / 0x200U;
    return pdoName(group < 2 ? "RPDO" : "TPDO", object.index % 0x200U + 1, group % 2 == 1,
                   object.subindex);
  }
  if (object.index >= 0x1200 && object.index < 0x1280) return "SDO server parameter";
  if (object.index >= 0x1F00 && object.index < 0x2000) return "";
  for (const Row& row : kRows) {
    if (row.index == object.index && (row.subindex == kWhole || row.subindex == object.subindex)) {
      return row.name;
    }
  }
  return "";
}

}  // namespace cia402::decode
