// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "can/bus.h"
#include "can/pacer.h"
#include "canopen/config.h"
#include "canopen/nmt/heartbeat.h"
#include "canopen/node/node.h"
#include "canopen/sync/sync.h"
#include "canopen/sync/time_producer.h"

namespace cia402::canopen {

/// What the master tells the layers above, as it happens (in receive() or tick()).
class MasterListener {
 public:
  virtual ~MasterListener() = default;
  virtual void onEmergency(Node&, const Emergency&) {}
  /// A frame of so many bytes where an emergency was expected: it holds no error code.
  virtual void onMalformedEmergency(Node&, std::size_t /*size*/) {}
  /// A frame came on the COB-ID on which a node answers by SDO.
  virtual void onSdoAnswer(Node&) {}
  virtual void onBootUp(Node&, Time) {}  ///< a boot-up frame, expected or not
  virtual void onHealthChange(Node&, Health /*before*/, Time) {}
  /// Another device has sent SYNC. @param stamp when it was on the wire
  virtual void onForeignSync(const can::Frame&, Time /*stamp*/, Time /*now*/) {}
};

/// CANopen master of one bus (CiA 301): NMT, heartbeat, SYNC, and one Node per device. Sans-IO: the
/// owner hands in frames and time and sends nothing else on the bus. One thread.
class Master {
 public:
  /// @param sink must outlive the master. @throws std::invalid_argument for node-IDs out of range
  /// or used twice and for TPDO and SDO COB-IDs that are no 11-bit identifiers or used twice.
  Master(MasterConfig config, can::Sink& sink, MasterListener* listener = nullptr);

  Master(const Master&) = delete;  ///< the nodes know where it is
  Master& operator=(const Master&) = delete;

  /// Boots all nodes in parallel. @param reset NMT reset communication to each of them first, or in
  /// one frame to all nodes of the bus (MasterConfig::reset_all)
  void start(Time now, bool reset = true);
  void receive(const can::Frame& frame, Time stamp, Time now);
  /// Time-outs, heartbeat, SDO queues, boot procedures.
  void tick(Time now);
  Time nextDeadline() const {
    if (deadlines_changed_) findDeadline();
    return deadline_;
  }

  /// Produces SYNC now (with counter if configured).
  void sendSync(Time now);
  /// To be called instead when somebody else has produced it, or should have: counts the cycle for
  /// the age of the nodes' inputs and asks for TPDOs by remote frames.
  void syncPassed(Time now);
  /// Sends every ready node's RPDOs that are due.
  void sendRpdos(Time now);
  /// Tells the wall-clock time for TIME messages; without it none are sent.
  void setWallTime(UnixTime wall, Time now) {
    time_.setWallTime(wall, now);
    deadlines_changed_ = true;
  }
  /// NMT command to all nodes.
  void commandAll(NmtCommand command, Time now);

  std::vector<Node>& nodes() { return nodes_; }
  const std::vector<Node>& nodes() const { return nodes_; }
  /// nullptr if no such node is configured.
  Node* find(NodeId id);
  const MasterConfig& config() const { return config_; }
  /// Frames whose COB-ID belongs to no configured node.
  std::uint64_t strayFrames() const { return stray_frames_; }

 private:
  void findDeadline() const;
  enum class Service : std::uint8_t {
    none,
    tpdo,
    emergency,
    sdo,
    heartbeat,
    sync,
    rpdo,
    sdo_request,  ///< like RPDOs sent by us alone
  };
  /// Where a frame goes, by its identifier.
  struct Route {
    Service service = Service::none;
    std::uint8_t node = 0;  ///< index in nodes_
    std::uint8_t pdo = 0;   ///< index in PdoImage::tpdos() or rpdos()
  };
  static constexpr std::size_t kIdentifiers = 2048;  ///< of 11 bits

  void receiveOther(Route route, const can::Frame& frame, Time stamp, Time now);
  void addRoutes(std::size_t node);
  void addRoute(std::uint32_t cob_id, Route route);
  std::string addPdoRoutes(std::size_t node);
  void followCobIds(std::size_t node);
  void tell(std::size_t node, Time now);

  MasterConfig config_;
  can::Pacer sink_;
  MasterListener* listener_;
  SdoPacer pacer_;
  std::vector<Node> nodes_;
  std::vector<Health> told_;  ///< what the listener knows of each node
  std::array<Route, kIdentifiers> routes_{};
  SyncProducer sync_;
  HeartbeatProducer heartbeat_;
  TimeProducer time_;
  std::uint64_t stray_frames_ = 0;
  // The earliest deadline of all is kept: it is asked for with every frame.
  mutable bool deadlines_changed_ = true;
  mutable Time deadline_ = kNever;
};

}  // namespace cia402::canopen
