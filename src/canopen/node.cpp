// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "cia402_driver/canopen/node.h"

#include <algorithm>
#include <utility>

#include "boot.h"
#include "boot_text.h"
#include "cia402_driver/canopen/heartbeat.h"

namespace cia402::canopen {
namespace {

NmtState stateOf(std::uint8_t heartbeat) {
  const auto state = static_cast<NmtState>(heartbeat & 0x7F);  // bit 7: node guarding's toggle bit
  switch (state) {
    case NmtState::boot_up:
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational:
      return state;
    case NmtState::unknown:
      break;
  }
  return NmtState::unknown;
}

}  // namespace

const char* toString(NodeHealth health) {
  switch (health) {
    case NodeHealth::absent:
      return "absent";
    case NodeHealth::booting:
      return "booting";
    case NodeHealth::ready:
      return "ready";
    case NodeHealth::failed:
      return "failed";
    case NodeHealth::lost:
      break;
  }
  return "lost";
}

struct Node::Impl {
  Impl(const NodeConfig& node_config, const MasterConfig& master, can::Sink& frame_sink,
       bool* changed)
      : config(node_config),
        sink(frame_sink),
        deadlines_changed(changed),
        sdo(config.node_id, sink, config.sdo),
        image(config.pdos),
        consumer(config.heartbeat_timeout),
        boot(config, master, sdo, sink) {}

  void startBoot(BootProcedure::From from, const std::string& why, Time now);
  void runBoot(Time now);
  void adoptCobIds();
  void endBoot(NodeHealth end);
  void takeOut(NodeHealth as, const std::string& why);
  void onBootUp(Time now);
  void onHeartbeat(NmtState state, Time stamp, Time now);
  void onEmergency(const can::Frame& frame, Time stamp);
  void refresh();
  std::string sentence(const std::string& text) const;

  const NodeConfig config;
  can::Sink& sink;
  bool* deadlines_changed;  ///< may be nullptr
  SdoClient sdo;
  ProcessImage image;
  HeartbeatConsumer consumer;
  BootProcedure boot;

  NodeHealth health = NodeHealth::absent;
  NmtState nmt_state = NmtState::unknown;
  std::string problem;
  bool begun = false;             ///< boot() was called: from now on the node boots by itself, too
  bool pdos_live = false;         ///< TPDOs are those that were configured
  bool cob_ids_changed = false;   ///< since takeCobIdChange()
  Time next = kNever;             ///< of all deadlines
  mutable bool sdo_lent = false;  ///< somebody may have queued a transfer: `next` is not known
  std::uint32_t boot_ups = 0, emergencies = 0;
  Time last_heartbeat{};
  std::optional<Emergency> last_emergency;
};

std::string Node::Impl::sentence(const std::string& text) const {
  const std::string node = "node " + std::to_string(config.node_id);
  return (config.name.empty() ? node : config.name + " (" + node + ")") + ": " + text;
}

void Node::Impl::refresh() {
  next = std::min({sdo.nextDeadline(), consumer.deadline(), boot.deadline()});
  sdo_lent = false;
  if (deadlines_changed != nullptr) *deadlines_changed = true;
  pdos_live = boot.started() && (health == NodeHealth::ready || health == NodeHealth::booting);
}

void Node::Impl::startBoot(BootProcedure::From from, const std::string& why, Time now) {
  begun = true;
  takeOut(NodeHealth::booting, why);
  boot.start(from, now);
}

/// Whatever was known of the node or on its way to it is void.
void Node::Impl::takeOut(NodeHealth as, const std::string& why) {
  boot.stop();
  consumer.disarm();
  sdo.cancelAll(why.empty() ? "the node is booted again" : "the node " + why);
  image.invalidate();
  health = as;
  problem = why.empty() ? std::string() : sentence(why);
}

void Node::Impl::runBoot(Time now) {
  if (!boot.running()) return;
  const std::size_t adopted = boot.adoptedCobIds().size();
  const BootProcedure::Status status = boot.advance(now);
  if (boot.adoptedCobIds().size() != adopted) adoptCobIds();
  switch (status) {
    case BootProcedure::Status::running:
      if (boot.supervised()) consumer.allow();
      break;
    case BootProcedure::Status::done:
      health = NodeHealth::ready;
      problem.clear();
      if (boot.supervised()) consumer.arm(now);
      break;
    case BootProcedure::Status::failed:
      endBoot(NodeHealth::failed);
      break;
    case BootProcedure::Status::absent:
      endBoot(NodeHealth::absent);
      break;
    case BootProcedure::Status::idle:
      break;
  }
}

void Node::Impl::adoptCobIds() {
  for (const BootProcedure::CobId& pdo : boot.adoptedCobIds()) {
    image.setCobId(pdo.direction, pdo.number, pdo.cob_id);
    cob_ids_changed = true;
  }
}

void Node::Impl::endBoot(NodeHealth end) {
  consumer.disarm();
  health = end;
  problem = sentence(boot.error());
}

void Node::Impl::onBootUp(Time now) {
  ++boot_ups;
  nmt_state = NmtState::boot_up;
  if (!begun) return;
  const bool surprise = health == NodeHealth::ready;
  startBoot(BootProcedure::From::boot_up,
            surprise
                ? "rebooted by itself (boot-up message in operation): look for a power dip or a "
                  "watchdog reset; it is configured again and stays disabled"
                : "",
            now);
}

void Node::Impl::onHeartbeat(NmtState state, Time stamp, Time now) {
  last_heartbeat = stamp;
  nmt_state = state;
  consumer.heard(now);
  if (boot.running()) {
    boot.heartbeatHeard(state);
    runBoot(now);
    return;
  }
  if (!begun) return;
  if (health == NodeHealth::absent || health == NodeHealth::lost) {
    startBoot(BootProcedure::From::unknown, "", now);
  } else if (health == NodeHealth::ready && state != NmtState::operational &&
             state != NmtState::unknown) {
    startBoot(BootProcedure::From::unknown,
              std::string("became ") + toString(state) +
                  " without our command: look for another NMT master or a reset; it is configured "
                  "again and stays disabled",
              now);
  }
}

void Node::Impl::onEmergency(const can::Frame& frame, Time stamp) {
  if (frame.size < 2) return;
  Emergency emergency;
  emergency.code = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8);
  if (frame.size > 2) emergency.error_register = frame.data[2];
  for (std::size_t i = 3; i < frame.size; ++i) emergency.vendor[i - 3] = frame.data[i];
  emergency.stamp = stamp;
  last_emergency = emergency;
  ++emergencies;
}

Node::Node(const NodeConfig& config, const MasterConfig& master, can::Sink& sink,
           bool* deadlines_changed)
    : impl_(std::make_unique<Impl>(config, master, sink, deadlines_changed)) {}
Node::~Node() = default;
Node::Node(Node&&) noexcept = default;

NodeId Node::id() const { return impl_->config.node_id; }
const std::string& Node::name() const { return impl_->config.name; }
const NodeConfig& Node::config() const { return impl_->config; }
NodeHealth Node::health() const { return impl_->health; }
NmtState Node::nmtState() const { return impl_->nmt_state; }
const std::string& Node::bootStep() const { return impl_->boot.step(); }
const std::string& Node::problem() const { return impl_->problem; }
const std::optional<Node::Identity>& Node::identity() const { return impl_->boot.identity(); }
const std::vector<std::string>& Node::notes() const { return impl_->boot.notes(); }
ProcessImage& Node::image() { return impl_->image; }
const ProcessImage& Node::image() const { return impl_->image; }
std::uint32_t Node::bootUps() const { return impl_->boot_ups; }
std::uint32_t Node::emergencies() const { return impl_->emergencies; }
Time Node::lastHeartbeat() const { return impl_->last_heartbeat; }
const std::optional<Emergency>& Node::lastEmergency() const { return impl_->last_emergency; }

SdoClient& Node::sdo() {
  impl_->sdo_lent = true;
  if (impl_->deadlines_changed != nullptr) *impl_->deadlines_changed = true;
  return impl_->sdo;
}

Time Node::nextDeadline() const {
  return impl_->sdo_lent ? std::min(impl_->next, impl_->sdo.nextDeadline()) : impl_->next;
}

bool Node::sdoLent() const { return impl_->sdo_lent; }

void Node::boot(Time now, bool reset) {
  if (reset) {
    command(NmtCommand::reset_communication, now);
    return;
  }
  impl_->startBoot(BootProcedure::From::unknown, "", now);
  impl_->refresh();
}

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
      if (impl_->health != NodeHealth::ready && impl_->health != NodeHealth::booting) break;
      impl_->takeOut(NodeHealth::failed,
                     std::string("was taken out of operation by the NMT command '") +
                         toString(command) + "'; boot it (recover) to use it again");
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      impl_->startBoot(BootProcedure::From::reset, "", now);
      break;
  }
  impl_->refresh();
}

void Node::receive(const can::Frame& frame, Time stamp, Time now) {
  switch (frame.id & 0x780U) {  // function code, CiA 301, table 38
    case 0x080:
      impl_->onEmergency(frame, stamp);
      return;
    case 0x580:
      impl_->sdo.receive(frame, now);
      impl_->runBoot(now);
      break;
    case 0x700: {
      if (frame.size == 0) return;
      const NmtState state = stateOf(frame.data[0]);
      if (state == NmtState::boot_up) {
        impl_->onBootUp(now);
      } else {
        impl_->onHeartbeat(state, stamp, now);
      }
      break;
    }
    default:
      return;
  }
  impl_->refresh();
}

void Node::receiveTpdo(std::size_t tpdo, const can::Frame& frame, Time stamp) {
  if (impl_->pdos_live) impl_->image.receive(tpdo, frame, stamp);
}

void Node::tick(Time now) {
  impl_->sdo.tick(now);
  impl_->runBoot(now);
  if (impl_->consumer.expired(now)) {
    // It may still hear us and go on with its last set-point, which nobody sends any more.
    impl_->sink.send(nmtFrame(NmtCommand::stop, id()));
    impl_->takeOut(NodeHealth::lost,
                   "no heartbeat for " + secondsText(impl_->consumer.timeout()) +
                       ": check power and cable; it is configured again when it is back");
  }
  impl_->refresh();
}

void Node::onSync(Time now) {
  if (impl_->health != NodeHealth::ready) return;
  ProcessImage& image = impl_->image;
  image.age(now);
  can::Frame frame;
  for (const std::size_t tpdo : image.requested()) {
    if (image.requestDue(tpdo, frame)) impl_->sink.send(frame);
  }
}

bool Node::takeCobIdChange() { return std::exchange(impl_->cob_ids_changed, false); }

void Node::refuse(const std::string& why, Time) {
  impl_->sink.send(nmtFrame(NmtCommand::enter_pre_operational, id()));
  impl_->takeOut(NodeHealth::failed, why);
  impl_->refresh();
}

void Node::sendRpdos(Time now) {
  if (impl_->health != NodeHealth::ready) return;
  ProcessImage& image = impl_->image;
  can::Frame frame;
  for (std::size_t i = 0; i < image.rpdos().size(); ++i) {
    if (!image.packDue(i, frame, now)) continue;
    if (!impl_->sink.send(frame)) image.repeat(i);
  }
}

}  // namespace cia402::canopen
