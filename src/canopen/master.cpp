// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/master.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "common/text.h"

namespace cia402::canopen {

Master::Master(MasterConfig config, can::Sink& sink, MasterListener* listener)
    : config_(std::move(config)),
      sink_(sink, config_.bitrate),
      listener_(listener),
      pacer_(config_.bitrate),
      told_(config_.nodes.size(), Health::absent),
      sync_(config_.sync_counter),
      heartbeat_(config_.node_id, config_.heartbeat),
      time_(config_.time_interval) {
  routes_[kSyncCobId].service = Service::sync;
  nodes_.reserve(config_.nodes.size());
  for (const NodeConfig& node : config_.nodes) {
    nodes_.emplace_back(node, config_, sink_, &pacer_, &deadlines_changed_, &sink_);
    addRoutes(nodes_.size() - 1);
  }
}

void Master::addRoutes(std::size_t node) {
  const NodeId id = nodes_[node].id();
  if (id < 1 || id > 127) {
    throw std::invalid_argument("node-ID " + std::to_string(id) + " is not in 1..127");
  }
  const auto index = static_cast<std::uint8_t>(node);
  addRoute(0x080U + id, {Service::emergency, index, 0});
  const SdoClient& sdo = std::as_const(nodes_[node]).sdo();
  addRoute(sdo.answerId(), {Service::sdo, index, 0});
  addRoute(sdo.requestId(), {Service::sdo_request, index, 0});
  addRoute(0x700U + id, {Service::heartbeat, index, 0});
  const std::string conflict = addPdoRoutes(node);
  if (!conflict.empty()) throw std::invalid_argument(nodes_[node].name() + ": " + conflict);
}

/// RPDOs have no way in, but nobody else may use their identifiers. PDOs whose COB-ID only the
/// drive knows (0) follow when it boots.
/// @return what is in the way, in words
std::string Master::addPdoRoutes(std::size_t node) {
  const PdoImage& image = nodes_[node].image();
  for (const Service service : {Service::tpdo, Service::rpdo}) {
    const auto& pdos = service == Service::tpdo ? image.tpdos() : image.rpdos();
    for (std::size_t i = 0; i < pdos.size(); ++i) {
      if (pdos[i].cob_id == 0) continue;
      const std::string pdo = std::string(service == Service::tpdo ? "TPDO " : "RPDO ") +
                              std::to_string(pdos[i].number) + " with COB-ID " +
                              hexText(pdos[i].cob_id, 3);
      if (pdos[i].cob_id >= kIdentifiers) return pdo + ": that has more than 11 bits";
      Route& route = routes_[pdos[i].cob_id];
      if (route.service == Service::sync) return pdo + ": that is used twice, it is SYNC";
      if (route.service != Service::none) {
        return pdo + ": that is used twice, by " + nodes_[route.node].name() + " already";
      }
      route = {service, static_cast<std::uint8_t>(node), static_cast<std::uint8_t>(i)};
    }
  }
  return {};
}

/// A drive has told other COB-IDs of its PDOs than those that were configured.
void Master::followCobIds(std::size_t node) {
  for (Route& route : routes_) {
    const bool pdo = route.service == Service::tpdo || route.service == Service::rpdo;
    if (pdo && route.node == node) route = Route();
  }
  const std::string conflict = addPdoRoutes(node);
  if (conflict.empty()) return;
  nodes_[node].refuse("cannot be used: " + conflict +
                      "; give the drive another COB-ID there, or leave that PDO out");
}

void Master::addRoute(std::uint32_t cob_id, Route route) {
  if (cob_id >= kIdentifiers) {
    throw std::invalid_argument(nodes_[route.node].name() + ": COB-ID " + hexText(cob_id, 3) +
                                " has more than 11 bits");
  }
  if (routes_[cob_id].service != Service::none) {
    throw std::invalid_argument("COB-ID " + hexText(cob_id, 3) + " is used twice, by " +
                                nodes_[routes_[cob_id].node].name() + " and " +
                                nodes_[route.node].name());
  }
  routes_[cob_id] = route;
}

void Master::start(Time now, bool reset) {
  sink_.setTime(now);
  sync_.restart();
  heartbeat_.start(sink_, now);
  time_.start(now);
  deadlines_changed_ = true;
  if (reset && config_.reset_all) {
    commandAll(NmtCommand::reset_communication, now);
    return;
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].boot(now, reset);
    tell(i, now);
  }
}

void Master::receive(const can::Frame& frame, Time stamp, Time now) {
  if (frame.error) return;
  sink_.setTime(now);
  sink_.heard(frame, now);
  if (frame.extended || frame.remote || frame.id >= kIdentifiers) {
    ++stray_frames_;
    return;
  }
  const Route& route = routes_[frame.id];
  if (route.service != Service::tpdo) return receiveOther(route, frame, stamp, now);
  pacer_.occupied(1, now);
  nodes_[route.node].receiveTpdo(route.pdo, frame, stamp);
}

/// What does not come in every cycle, and is not inlined where TPDOs are received.
[[gnu::noinline]] void Master::receiveOther(Route route, const can::Frame& frame, Time stamp,
                                            Time now) {
  if (route.service == Service::sync) {
    if (listener_ != nullptr) listener_->onForeignSync(frame, stamp, now);
    return;
  }
  if (route.service == Service::none || route.service == Service::rpdo ||
      route.service == Service::sdo_request) {
    ++stray_frames_;
    return;
  }
  Node& node = nodes_[route.node];
  const std::uint32_t boot_ups = node.bootUps();
  const std::uint32_t emergencies = node.emergencies();
  const std::uint32_t malformed = node.malformedEmergencies();
  node.receive(frame, stamp, now);
  if (node.takeCobIdChange()) followCobIds(route.node);
  if (listener_ != nullptr) {
    if (route.service == Service::sdo) listener_->onSdoAnswer(node);
    if (node.emergencies() != emergencies) listener_->onEmergency(node, *node.lastEmergency());
    if (node.malformedEmergencies() != malformed) {
      listener_->onMalformedEmergency(node, frame.size);
    }
    if (node.bootUps() != boot_ups) listener_->onBootUp(node, now);
  }
  tell(route.node, now);
}

void Master::tick(Time now) {
  sink_.setTime(now);
  heartbeat_.tick(sink_, now);
  time_.tick(sink_, now);
  deadlines_changed_ = true;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].nextDeadline() > now) continue;
    nodes_[i].tick(now);
    if (nodes_[i].takeCobIdChange()) followCobIds(i);
    tell(i, now);
  }
}

/// Tells the listener what it does not know yet; a node may also have been commanded from outside.
void Master::tell(std::size_t node, Time now) {
  const Health before = std::exchange(told_[node], nodes_[node].health());
  if (listener_ == nullptr || before == told_[node]) return;
  listener_->onHealthChange(nodes_[node], before, now);
}

/// Not inlined: nextDeadline() is asked for with every frame, and seldom comes here.
[[gnu::noinline]] void Master::findDeadline() const {
  deadlines_changed_ = false;
  deadline_ = std::min(heartbeat_.deadline(), time_.deadline());
  for (const Node& node : nodes_) deadline_ = std::min(deadline_, node.nextDeadline());
}

void Master::sendSync(Time now) {
  sink_.setTime(now);
  sink_.send(sync_.next());
  sink_.syncSent(now, config_.sync_period);
  syncPassed(now);
}

void Master::syncPassed(Time now) {
  for (Node& node : nodes_) node.onSync(now);
}

void Master::sendRpdos(Time now) {
  sink_.setTime(now);
  for (Node& node : nodes_) {
    if (node.health() != Health::ready) continue;
    node.sendRpdos(now);
    pacer_.occupied(static_cast<unsigned>(node.image().rpdos().size()), now);
  }
}

void Master::commandAll(NmtCommand command, Time now) {
  sink_.setTime(now);
  sink_.send(nmtFrame(command, 0));
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].commanded(command, now);
    tell(i, now);
  }
}

Node* Master::find(NodeId id) {
  const auto found = std::find_if(nodes_.begin(), nodes_.end(),
                                  [id](const Node& node) { return node.id() == id; });
  return found == nodes_.end() ? nullptr : &*found;
}

}  // namespace cia402::canopen
