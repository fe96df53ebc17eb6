// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "can/candump_log.h"
#include "can/frame.h"
#include "canopen/config.h"
#include "config/robot.h"
#include "decode/node_values.h"
#include "decode/sdo_decoder.h"

namespace cia402::decode {

/// A frame in words. Texts hold no line ends.
struct DecodedFrame {
  std::string service;  ///< NMT, SYNC, TIME, EMCY, TPDO1, RPDO1, SDO, heartbeat, guarding, LSS,
                        ///< error, or ? for what belongs to no service of the configured bus
  std::string node;     ///< "shoulder (1)", "node 9", "all", "master"; empty where there is none
  std::string text;     ///< what it says
};

/// Puts the frames of a bus into words, with the names and units of its configuration. Fed with all
/// frames in their order, for segments of an SDO, guarding and the mode of an axis need memory.
/// Sans-IO; what it is given may be damaged or foreign, it has words for anything.
class FrameDecoder {
 public:
  /// @param robot valid, @param master made from it.
  FrameDecoder(const config::RobotConfig& robot, const canopen::MasterConfig& master);

  /// What the next frame of the bus says. To be called with each, in their order.
  DecodedFrame decode(const can::Frame& frame);

  /// "shoulder (1)", "left, right (1)"; "node 9" for one that is not configured.
  std::string nodeName(canopen::NodeId node) const;

 private:
  struct Field {
    fieldbus::ObjectId object;
    std::string name;
    unsigned shift, bits;
  };
  struct Pdo {
    std::string service;  ///< "TPDO1"
    canopen::NodeId node = 0;
    std::string name;  ///< of the axis whose objects it carries, or of the node
    std::vector<Field> fields;
    unsigned size = 0;  ///< bytes
  };
  struct Node {
    std::string name;
    std::string joints;                  ///< of its axes
    std::unique_ptr<NodeValues> values;  ///< none for a node without an axis
    SdoDecoder sdo{nullptr};
    bool guarded = false;  ///< a guarding request was seen
  };

  /// SDO on other COB-IDs than 600h and 580h + node-ID.
  struct Channel {
    canopen::NodeId node = 0;
    bool answer = false;  ///< from the drive
  };

  void addPdos(const canopen::NodeConfig& config);
  /// Name of the axis whose objects the PDO carries, or of the node where it has several.
  std::string ownerOf(const Pdo& pdo) const;
  Node& nodeOf(canopen::NodeId id);
  std::string pdoText(const Pdo& pdo, const can::Frame& frame);
  DecodedFrame broadcast(const can::Frame& frame);
  DecodedFrame errorControl(const can::Frame& frame, canopen::NodeId id);
  std::string emergencyText(const can::Frame& frame, canopen::NodeId id);

  canopen::NodeId master_;
  std::map<std::uint32_t, Pdo> pdos_;          // by COB-ID
  std::map<std::uint32_t, Channel> channels_;  // by COB-ID
  std::map<canopen::NodeId, Node> nodes_;
};

/// LSS messages in words (CiA 305). @param from_master COB-ID 7E5h, else 7E4h.
std::string lssText(const can::Frame& frame, bool from_master);
/// The TIME object (CiA 301, 7.2.6): "2026-11-21 14:37:08.123".
std::string timeText(const can::Frame& frame);

/// One line, without its end: `1700000000.123456   -0.500000  rx  TPDO1      shoulder (1)  text`.
/// Columns keep their order and are never empty ("-"), for grep and cut.
/// @param relative to the event of interest, s.
std::string formatDecoded(std::chrono::nanoseconds stamp, double relative, const char* direction,
                          const DecodedFrame& decoded);

}  // namespace cia402::decode
