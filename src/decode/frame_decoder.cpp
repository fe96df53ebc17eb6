// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "decode/frame_decoder.h"

#include <algorithm>
#include <cstdio>

#include "can/error_frame.h"
#include "canopen/nmt/nmt.h"
#include "common/text.h"
#include "fieldbus/emergency.h"

namespace cia402::decode {
namespace {

using can::Frame;
using canopen::NodeId;

std::uint64_t wordOf(const Frame& frame) {
  std::uint64_t word = 0;
  for (unsigned i = 0; i < frame.size && i < 8; ++i) {
    word |= static_cast<std::uint64_t>(frame.data[i]) << (8 * i);
  }
  return word;
}

std::string dataText(const Frame& frame) {
  if (frame.remote) return "remote request, " + std::to_string(frame.size) + " bytes";
  return bytesText(fieldbus::Bytes(frame.data.begin(), frame.data.begin() + frame.size));
}

const char* nmtStateText(std::uint8_t state) {
  switch (state & 0x7F) {
    case 0x00:
      return "boot-up";
    case 0x04:
      return "stopped";
    case 0x05:
      return "operational";
    case 0x7F:
      return "pre-operational";
    default:
      return nullptr;
  }
}

std::string nmtCommandText(std::uint8_t command) {
  switch (command) {
    case 0x01:
      return "start";
    case 0x02:
      return "stop";
    case 0x80:
      return "enter pre-operational";
    case 0x81:
      return "reset node";
    case 0x82:
      return "reset communication";
    default:
      return "unknown command " + hexText(command, 2);
  }
}

}  // namespace

FrameDecoder::FrameDecoder(const config::RobotConfig& robot, const canopen::MasterConfig& master)
    : master_(master.node_id) {
  for (const drive::AxisConfig& axis : robot.axes) {
    const canopen::NodeId id = robot.deviceOf(axis).node_id;
    Node& node = nodes_[id];
    const std::string place = std::to_string(id);
    node.joints += (node.joints.empty() ? "" : ", ") + axis.joint;
    node.name = node.values ? node.joints + " (" + place + ")" : drive::whoIs(axis, place);
    if (!node.values) node.values = std::make_unique<NodeValues>();
    node.values->add(axis);
    node.sdo = SdoDecoder(node.values.get());
  }
  for (const canopen::NodeConfig& node : master.nodes) {
    addPdos(node);
    const canopen::SdoChannel& sdo = node.sdo_channel;
    if (sdo.request != 0) channels_[sdo.request] = {node.node_id, false};
    if (sdo.answer != 0) channels_[sdo.answer] = {node.node_id, true};
  }
}

void FrameDecoder::addPdos(const canopen::NodeConfig& config) {
  for (const canopen::PdoConfig& from : config.pdos) {
    if (!from.enabled || from.cob_id == 0) continue;
    Pdo pdo;
    pdo.service = (from.direction == canopen::PdoDirection::rpdo ? "RPDO" : "TPDO") +
                  std::to_string(from.number);
    pdo.node = config.node_id;
    unsigned shift = 0;
    for (const canopen::PdoEntry& entry : from.entries) {
      if (shift + entry.bits > 64) break;
      pdo.fields.push_back({entry.object, entry.name, shift, entry.bits});
      shift += entry.bits;
    }
    pdo.size = (shift + 7) / 8;
    pdo.name = ownerOf(pdo);
    pdos_[from.cob_id] = std::move(pdo);
  }
}

std::string FrameDecoder::ownerOf(const Pdo& pdo) const {
  const auto known = nodes_.find(pdo.node);
  if (known == nodes_.end() || !known->second.values || pdo.fields.empty()) {
    return nodeName(pdo.node);
  }
  const Node& node = known->second;
  const drive::AxisConfig& axis = node.values->of(pdo.fields.front().object).axis();
  const bool one = std::all_of(pdo.fields.begin(), pdo.fields.end(), [&](const Field& field) {
    return &node.values->of(field.object).axis() == &axis;
  });
  return one ? drive::whoIs(axis, std::to_string(pdo.node)) : node.name;
}

FrameDecoder::Node& FrameDecoder::nodeOf(NodeId id) {
  Node& node = nodes_[id];
  if (node.name.empty()) {
    node.name = id == master_ ? "master" : "node " + std::to_string(id);
  }
  return node;
}

std::string FrameDecoder::nodeName(NodeId node) const {
  const auto known = nodes_.find(node);
  if (known != nodes_.end() && !known->second.name.empty()) return known->second.name;
  return node == master_ ? "master" : "node " + std::to_string(node);
}

std::string FrameDecoder::pdoText(const Pdo& pdo, const Frame& frame) {
  if (frame.remote) return "asked for";
  const NodeValues* const values = nodeOf(pdo.node).values.get();
  const std::uint64_t word = wordOf(frame);
  const auto raw = [&](const Field& field) {
    const std::uint64_t mask =
        field.bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << field.bits) - 1;
    return word >> field.shift & mask;
  };
  const auto present = [&](const Field& field) {
    return field.shift + field.bits <= 8U * frame.size;
  };
  std::string text;
  if (frame.size < pdo.size) {
    text =
        "too short, " + std::to_string(frame.size) + " of " + std::to_string(pdo.size) + " bytes";
  }
  if (values == nullptr) {
    append(text, hexBytes(frame.data.data(), frame.size));
    return text;
  }
  for (const Field& field : pdo.fields) {  // the mode first: it names bits of the other values
    if (present(field)) values->of(field.object).note(field.object, raw(field));
  }
  for (const Field& field : pdo.fields) {
    if (!present(field)) break;
    append(text,
           (field.name.empty() ? fieldbus::toString(field.object) : field.name) + " " +
               values->of(field.object).describe(field.object, raw(field), field.bits),
           " | ");
  }
  return text;
}

std::string FrameDecoder::emergencyText(const Frame& frame, NodeId id) {
  if (frame.size < 3) return "too short for an emergency: " + dataText(frame);
  const auto code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  const NodeValues* const values = nodeOf(id).values.get();
  std::string text = code == 0           ? "0x0000 error reset or no error"
                     : values != nullptr ? errorText(code, *values->axis().profile)
                                         : hexText(code, 4) + " " + fieldbus::emergencyText(code);
  text += "; error register " + hexText(frame.data[2], 2) + " " +
          fieldbus::errorRegisterText(frame.data[2]);
  const std::string vendor = hexBytes(frame.data.data() + 3, frame.size - 3U);
  if (vendor.find_first_not_of("0 ") != std::string::npos) text += "; manufacturer " + vendor;
  return text;
}

/// COB-ID 700h + node-ID: boot-up, heartbeat and node guarding (CiA 301, 7.2.8).
DecodedFrame FrameDecoder::errorControl(const Frame& frame, NodeId id) {
  Node& node = nodeOf(id);
  if (frame.remote) {
    node.guarded = true;
    return {"guarding", node.name, "asked for its state"};
  }
  if (frame.size == 0) return {"heartbeat", node.name, "empty"};
  const std::uint8_t state = frame.data[0];
  if (state == 0) node.guarded = false;
  const char* const words = nmtStateText(state);
  const std::string text = words != nullptr ? words : "unknown state " + hexText(state, 2);
  if (!node.guarded && (state & 0x80) == 0) return {"heartbeat", node.name, text};
  return {"guarding", node.name, text + ((state & 0x80) != 0 ? ", toggle 1" : ", toggle 0")};
}

/// What belongs to no single node by its identifier.
DecodedFrame FrameDecoder::broadcast(const Frame& frame) {
  if (frame.id == 0x000) {
    if (frame.size < 2) return {"NMT", "", "too short: " + dataText(frame)};
    const NodeId id = frame.data[1];
    return {"NMT", id == 0 ? "all" : nodeName(id), nmtCommandText(frame.data[0])};
  }
  if (frame.id == 0x080) {
    return {"SYNC", "", frame.size == 0 ? "" : "counter " + std::to_string(frame.data[0])};
  }
  if (frame.id == 0x100) return {"TIME", "", timeText(frame)};
  if (frame.id == 0x7E5 || frame.id == 0x7E4) {
    return {"LSS", frame.id == 0x7E5 ? "master" : "slave", lssText(frame, frame.id == 0x7E5)};
  }
  return {"?", "", hexText(frame.id, 4) + ": " + dataText(frame)};
}

DecodedFrame FrameDecoder::decode(const Frame& frame) {
  if (frame.error) return {"error", "", can::describeErrorFrame(frame)};
  if (frame.extended) return {"?", "", hexText(frame.id, 8) + ": " + dataText(frame)};
  const auto pdo = pdos_.find(frame.id);
  if (pdo != pdos_.end()) {
    return {pdo->second.service, pdo->second.name, pdoText(pdo->second, frame)};
  }
  const auto channel = channels_.find(frame.id);
  if (channel != channels_.end()) {
    Node& node = nodeOf(channel->second.node);
    return {"SDO", node.name,
            channel->second.answer ? node.sdo.answer(frame) : node.sdo.request(frame)};
  }
  const auto id = static_cast<NodeId>(frame.id & 0x7F);
  if (id == 0 || frame.id == 0x7E4 || frame.id == 0x7E5) return broadcast(frame);
  switch (frame.id & 0x780U) {  // function code, CiA 301, table 38
    case 0x080:
      return {"EMCY", nodeOf(id).name, emergencyText(frame, id)};
    case 0x580:
      return {"SDO", nodeOf(id).name, nodeOf(id).sdo.answer(frame)};
    case 0x600:
      return {"SDO", nodeOf(id).name, nodeOf(id).sdo.request(frame)};
    case 0x700:
      return errorControl(frame, id);
    default:
      return broadcast(frame);
  }
}

std::string formatDecoded(std::chrono::nanoseconds stamp, double relative, const char* direction,
                          const DecodedFrame& decoded) {
  const auto column = [](const std::string& text) { return text.empty() ? "-" : text.c_str(); };
  const long long microseconds = stamp.count() / 1000;
  char head[128];
  std::snprintf(head, sizeof head, "%lld.%06lld %+11.6f  %-2s  %-9s  %-16s  ",
                microseconds / 1'000'000, microseconds % 1'000'000, relative, direction,
                column(decoded.service), column(decoded.node));
  return head + (decoded.text.empty() ? "-" : decoded.text);
}

}  // namespace cia402::decode
