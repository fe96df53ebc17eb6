// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "canopen/config.h"
#include "canopen/scripted_peer.h"

namespace cia402::canopen::test {

/// "603 40 00 10 00 00 00 00 00" for (0x600, 3, "40 00 10 00 00 00 00 00").
inline std::string line(unsigned function, unsigned node, const std::string& bytes) {
  char id[8];
  std::snprintf(id, sizeof(id), "%03X ", function + node);
  return id + bytes;
}
inline std::string request(unsigned node, const std::string& bytes) {
  return line(0x600, node, bytes);
}
inline std::string answer(unsigned node, const std::string& bytes) {
  return line(0x580, node, bytes);
}
inline std::string nmt(const std::string& command, unsigned node) {
  char text[16];
  std::snprintf(text, sizeof(text), "000 %s %02X", command.c_str(), node);
  return text;
}

/// A drive that has a device type, an identity, both heartbeat objects, TPDO 1 and RPDO 1, both
/// mapped as servoConfig() wants them. Each line: what it is asked, what it says.
inline const std::vector<std::pair<const char*, const char*>>& servoScript() {
  static const std::vector<std::pair<const char*, const char*>> script{
      {"40 00 10 00 00 00 00 00", "43 00 10 00 92 01 02 00"},  // 1000h = 0x00020192
      {"40 18 10 00 00 00 00 00", "4F 18 10 00 04 00 00 00"},  // identity of four entries
      {"40 18 10 01 00 00 00 00", "43 18 10 01 CD AB 00 00"},  // vendor 0x0000ABCD
      {"40 18 10 02 00 00 00 00", "43 18 10 02 17 01 0D 00"},  // product 0x000D0117
      {"40 18 10 03 00 00 00 00", "43 18 10 03 02 00 01 00"},  // revision 0x00010002
      {"40 18 10 04 00 00 00 00", "43 18 10 04 39 30 00 00"},  // serial 12345
      {"23 16 10 01 2C 01 7F 00", "60 16 10 01 00 00 00 00"},  // 1016:01 = node 127, 300 ms
      {"2B 17 10 00 64 00 00 00", "60 17 10 00 00 00 00 00"},  // 1017h = 100 ms
      {"40 05 10 00 00 00 00 00", "43 05 10 00 80 00 00 00"},  // 1005h = 0x80, makes no SYNC
      {"40 01 14 01 00 00 00 00", "80 01 14 01 00 00 02 06"},  // there is no RPDO 2
      {"40 02 14 01 00 00 00 00", "80 02 14 01 00 00 02 06"},
      {"40 03 14 01 00 00 00 00", "80 03 14 01 00 00 02 06"},
      {"40 01 18 01 00 00 00 00", "80 01 18 01 00 00 02 06"},  // there is no TPDO 2
      {"40 02 18 01 00 00 00 00", "80 02 18 01 00 00 02 06"},
      {"40 03 18 01 00 00 00 00", "80 03 18 01 00 00 02 06"},
      {"40 00 14 02 00 00 00 00", "4F 00 14 02 01 00 00 00"},
      {"40 00 14 05 00 00 00 00", "4B 00 14 05 00 00 00 00"},
      {"40 00 16 00 00 00 00 00", "4F 00 16 00 02 00 00 00"},
      {"40 00 16 01 00 00 00 00", "43 00 16 01 10 00 40 60"},
      {"40 00 16 02 00 00 00 00", "43 00 16 02 20 00 7A 60"},
      {"40 00 18 02 00 00 00 00", "4F 00 18 02 01 00 00 00"},
      {"40 00 18 03 00 00 00 00", "4B 00 18 03 00 00 00 00"},
      {"40 00 18 05 00 00 00 00", "4B 00 18 05 00 00 00 00"},
      {"40 00 1A 00 00 00 00 00", "4F 00 1A 00 02 00 00 00"},
      {"40 00 1A 01 00 00 00 00", "43 00 1A 01 10 00 41 60"},
      {"40 00 1A 02 00 00 00 00", "43 00 1A 02 20 00 64 60"}};
  return script;
}

/// Puts such a drive on the wire. It answers NMT start with a heartbeat and reset communication
/// with a boot-up message.
inline void addServo(ScriptedPeer& peer, unsigned node) {
  for (const auto& [asked, said] : servoScript()) {
    peer.on(request(node, asked), std::vector<std::string>{answer(node, said)});
  }
  char id[4];
  std::snprintf(id, sizeof(id), "%02X", node);  // COB-IDs 200h + node and 180h + node
  peer.on(request(node, "40 00 14 01 00 00 00 00"),
          std::vector<std::string>{answer(node, std::string("43 00 14 01 ") + id + " 02 00 00")});
  std::snprintf(id, sizeof(id), "%02X", 0x80 + node);
  peer.on(request(node, "40 14 10 00 00 00 00 00"),  // 1014h = 0x80 + node
          std::vector<std::string>{answer(node, std::string("43 14 10 00 ") + id + " 00 00 00")});
  peer.on(request(node, "40 00 18 01 00 00 00 00"),
          std::vector<std::string>{answer(node, std::string("43 00 18 01 ") + id + " 01 00 00")});
  peer.on(nmt("01", node), std::vector<std::string>{line(0x700, node, "05")});
  peer.on(nmt("82", node), std::vector<std::string>{line(0x700, node, "00")});
}

inline NodeConfig servoConfig(NodeId node, const std::string& name) {
  NodeConfig config;
  config.node_id = node;
  config.name = name;
  PdoConfig tpdo;
  tpdo.direction = PdoDirection::tpdo;
  tpdo.cob_id = static_cast<std::uint16_t>(0x180 + node);
  tpdo.entries = {{{0x6041, 0}, 16, "statusword"}, {{0x6064, 0}, 32, "position"}};
  PdoConfig rpdo;
  rpdo.direction = PdoDirection::rpdo;
  rpdo.cob_id = static_cast<std::uint16_t>(0x200 + node);
  rpdo.entries = {{{0x6040, 0}, 16, "controlword"}, {{0x607A, 0}, 32, "target"}};
  config.pdos = {rpdo, tpdo};
  return config;
}

}  // namespace cia402::canopen::test
