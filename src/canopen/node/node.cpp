// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/node.h"

#include <algorithm>
#include <utility>

#include "canopen/node/impl.h"
#include "canopen/node/terms.h"
#include "canopen/pdo/text.h"

namespace cia402::canopen {

Node::Node(const NodeConfig& config, const MasterConfig& master, can::Sink& sink, SdoPacer* turns,
           bool* deadlines_changed, can::Pacer* wire)
    : Node(std::make_unique<Impl>(config, master, sink, turns, deadlines_changed, wire)) {}
Node::Node(std::unique_ptr<Impl> impl) : Device(*impl), impl_(std::move(impl)) {}
Node::~Node() = default;
Node::Node(Node&&) noexcept = default;

NodeId Node::id() const { return impl_->config.node_id; }
const std::string& Node::name() const { return impl_->config.name; }
std::string Node::who() const { return impl_->who(); }
const NodeConfig& Node::config() const { return impl_->config; }
void Node::swapWrites(std::vector<StartupWrite>& writes, Time now) {
  impl_->config.writes.swap(writes);
  if (health() == Health::booting) boot(now, false);
}
bool Node::seesToMotors() const { return impl_->boot.seesToMotors(); }
bool Node::excused() const { return config().boot.optional && isAway(impl_->health); }
NmtState Node::nmtState() const { return impl_->nmt_state; }
const std::string& Node::bootStep() const { return impl_->step(); }
const std::string& Node::problem() const { return impl_->problem; }
std::string Node::askingRefusal(const std::string& what) const {
  if (nmtState() != NmtState::stopped) return {};
  return who() + ": " + what + " cannot be asked for: " + kStoppedIsMute;
}
const std::optional<Node::Identity>& Node::identity() const { return impl_->boot.found().identity; }
const std::vector<std::string>& Node::notes() const { return impl_->notes; }
const std::vector<std::string>& Node::remarks() const { return impl_->boot.remarks(); }
bool Node::started() const { return impl_->boot.started(); }
Node::Supervision Node::supervision() const {
  const BootFindings& found = impl_->boot.found();
  Supervision supervision;
  supervision.watched = found.supervised;
  supervision.watches_master = found.watches_master;
  supervision.kind = found.guarded      ? ErrorControl::guarding
                     : found.supervised ? ErrorControl::heartbeat
                                        : ErrorControl::none;
  return supervision;
}
std::uint32_t Node::emergencies() const { return impl_->emergencies; }
std::uint32_t Node::malformedEmergencies() const { return impl_->malformed_emergencies; }
bool Node::everHeard() const {
  const auto& answers = sdo().counters();
  return bootUps() > 0 || lastHeartbeat() != Time() || answers.completed > 0 || answers.aborted > 0;
}
Time Node::lastHeartbeat() const { return impl_->last_heartbeat; }
const std::optional<Emergency>& Node::lastEmergency() const { return impl_->last_emergency; }

SdoClient& Node::sdo() { return impl_->sdo; }
const SdoClient& Node::sdo() const { return impl_->sdo; }
fieldbus::ObjectAccess& Node::objects() { return impl_->sdo; }
fieldbus::DeviceTimes Node::times() const { return {config().boot_timeout, config().sdo}; }
const fieldbus::Terms& Node::terms() const { return kTerms; }
std::string Node::overdueText() const { return staleText(image()); }
std::string Node::missingText() const { return canopen::missingText(image()); }
std::string Node::carrierText(fieldbus::Slot output) const {
  return pdoName(image().rpdos()[image().carrierOf(output)]);
}

Time Node::nextDeadline() const { return std::min(impl_->next, impl_->sdo.nextDeadline()); }

void Node::boot(Time now, bool reset) {
  using From = BootProcedure::From;
  impl_->startBoot(reset ? From::before_reset : From::unknown, "", now);
  impl_->refresh();
}

void Node::restart(Time now) {
  command(config().reset_node_allowed ? NmtCommand::reset_node : NmtCommand::reset_communication,
          now);
}

std::string Node::restartGap() const {
  if (config().reset_node_allowed) return {};
  return "only its communication was reset (nmt_reset_node of the profile): switch it off and on";
}

void Node::look(Time at) { impl_->look(at); }

void Node::command(NmtCommand command, Time now) {
  impl_->sink.send(nmtFrame(command, id()));
  commanded(command, now);
}

void Node::commanded(NmtCommand command, Time now) {
  switch (command) {
    case NmtCommand::start:
      break;
    case NmtCommand::stop:
    case NmtCommand::enter_pre_operational:
      impl_->takeOutBy(command);
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      impl_->startBoot(BootProcedure::From::reset, "", now, command);
      break;
  }
  impl_->refresh();
}

void Node::stopAndStart(Duration stopped, Time now) {
  if (impl_->health != Health::ready) return;
  impl_->pause.begin(stopped, kStartPatience, impl_->boot.found().supervised, now);
  impl_->refresh();
}

bool Node::paused() const { return impl_->pause.active(); }

void Node::receive(const can::Frame& frame, Time stamp, Time now) {
  if (frame.id == impl_->sdo.answerId()) {
    impl_->sdo.receive(frame, now);
    // On a full bus heartbeats, the least urgent of frames, may come late while it is configured.
    if (impl_->boot.running() && impl_->consumer.armed()) impl_->consumer.heard(now);
    impl_->runBoot(now);
    impl_->runProbe(now);
    impl_->sdo_cycle.advance(now);
    impl_->refresh();
    return;
  }
  switch (frame.id & 0x780U) {  // function code, CiA 301, table 38
    case 0x080:
      impl_->onEmergency(frame, stamp);
      return;
    case 0x700:
      if (frame.size == 0) return;
      impl_->onErrorControl(frame.data[0], stamp, now);
      break;
    default:
      return;
  }
  impl_->refresh();
}

void Node::receiveTpdo(std::size_t tpdo, const can::Frame& frame, Time stamp) {
  if (!impl_->pdos_live) {  // it goes on as before; a heartbeat would tell so, but later
    if (!impl_->boot.running() || !impl_->boot.tpdoAppears(stamp)) return;
    impl_->runBoot(stamp);
    return impl_->refresh();
  }
  impl_->image.receive(tpdo, frame, stamp);
  if (impl_->health != Health::booting || !impl_->boot.tpdoHeard()) return;
  impl_->next = Time();  // the boot goes on at the next tick
  if (impl_->deadlines_changed != nullptr) *impl_->deadlines_changed = true;
}

void Node::tick(Time now) {
  impl_->sdo.tick(now);
  impl_->sdo_cycle.advance(now);
  impl_->runBoot(now);
  impl_->runProbe(now);
  impl_->checkSupervision(now);
  impl_->last_stop.tick(now);
  impl_->continuePause(now);
  impl_->tryAgain(now);
  impl_->refresh();
}

void Node::onSync(Time now) {
  if (impl_->health != Health::ready) return;
  PdoImage& image = impl_->image;
  image.age(now);
  if (image.requested().empty()) return;
  can::Frame frame;
  for (const std::size_t tpdo : image.requested()) {
    if (image.requestDue(tpdo, frame)) impl_->sink.send(frame);
  }
}

bool Node::takeCobIdChange() { return std::exchange(impl_->cob_ids_changed, false); }

void Node::refuse(const std::string& why) {
  impl_->sink.send(nmtFrame(NmtCommand::enter_pre_operational, id()));
  impl_->takeOut(Health::failed, why);
  impl_->refresh();
}

void Node::sendRpdos(Time now) {
  if (impl_->health != Health::ready) return;
  if (config().by_sdo.empty()) {
    impl_->image.sendDue(impl_->sink, now);
  } else {
    impl_->sdo_cycle.outputsSet(now);
    if (impl_->sdo_cycle.mute()) impl_->lose("answers no SDO, and nothing travels by PDO", now);
    impl_->refresh();
  }
}

}  // namespace cia402::canopen
