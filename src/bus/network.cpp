// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/network.h"

#include <algorithm>
#include <utility>

#include "bus/canopen/lss_supervisor.h"
#include "bus/canopen/node_unit.h"
#include "bus/canopen/start_up.h"
#include "canopen/received_identifiers.h"
#include "drive/profile/fault_text.h"

namespace cia402::bus {
namespace {

constexpr Duration kFirstFeedback =
    std::chrono::milliseconds(500);  // may take so long after a boot

/// By value: std::min() has its arguments put into memory.
Time earlier(Time a, Time b) { return a < b ? a : b; }

}  // namespace

Network::Network(config::RobotConfig robot, canopen::MasterConfig master, can::Sink& sink,
                 EventSink& events)
    : config_(std::move(robot)),
      events_(events),
      foreseen_(canopen::receivedIdentifiers(master)),
      master_(std::move(master), sink, this),
      cycle_(config_, places(), *this, events),
      sync_(config_.bus, master_, cycle_, events),
      nodes_(std::make_unique<NodeUnits>()),
      lss_(std::make_unique<LssSupervisor>(master_, *nodes_, cycle_, sink, events)),
      start_up_(std::make_unique<StartUp>(master_.config(), config_.bus.listen, cycle_, events)) {
  addNodes();
}

Network::~Network() = default;

std::vector<AxisUnit::Place> Network::places() {
  std::vector<AxisUnit::Place> places;
  for (const drive::AxisConfig& axis : config_.axes) {
    const canopen::DeviceConfig& device = config_.deviceOf(axis);
    canopen::Node& node = *master_.find(device.node_id);
    places.push_back({&node, node.who(), kFirstFeedback + device.stale_after * axis.cycle});
  }
  return places;
}

void Network::addNodes() {
  const std::vector<canopen::DeviceConfig>& devices = config_.devices;
  for (canopen::Node& node : master_.nodes()) {
    const auto device = std::find_if(devices.begin(), devices.end(), [&](const auto& candidate) {
      return candidate.node_id == node.id();
    });
    nodes_->add(NodeUnit(node, *device, cycle_, events_));
  }
  for (AxisUnit& unit : cycle_.units()) {
    const canopen::DeviceConfig& device = config_.deviceOf(config_.axes[unit.index]);
    const canopen::Node* node = master_.find(device.node_id);
    nodes_->addAxis(static_cast<std::size_t>(node - master_.nodes().data()), unit);
  }
}

NodeUnit* Network::unitOf(const canopen::Node& node) {
  NodeUnit& unit = nodes_->all()[static_cast<std::size_t>(&node - master_.nodes().data())];
  return unit.empty() ? nullptr : &unit;
}

canopen::Node& Network::node(std::size_t axis) { return nodes_->ofAxis(axis).node(); }

void Network::start(Time now) {
  if (started()) return;
  cycle_.setTime(now);
  phase_ = Phase::listening;
  if (!start_up_->begin(now)) beginSending(now);
}

void Network::listen(Time now) {
  cycle_.setTime(now);
  if (cycle_.shutdown().begun() && !start_up_->mayEnd(!bus_lost_.empty())) {
    phase_ = Phase::ended;
    return cycle_.finishShutdown();
  }
  if (!start_up_->tick(!bus_lost_.empty(), now)) return;
  beginSending(now);
  for (Command& command : start_up_->takeDeferred()) execute(std::move(command), now);
}

void Network::beginSending(Time now) {
  phase_ = Phase::running;
  cycle_.sayStep("");
  if (cycle_.shutdown().begun() || !lss_->begin()) boot(now);
}

void Network::boot(Time now) {
  sync_.begin(now);
  master_.start(now, !cycle_.shutdown().begun());  // a reset would come before what stops motors
}

void Network::busLost(const std::string& why, Time now) {
  cycle_.setTime(now);
  if (!started() || !bus_lost_.empty()) return;
  bus_lost_ = why;
  cycle_.loseBus(why);
}

void Network::busBack(bool is_news, Time now) {
  if (bus_lost_.empty()) return;
  bus_lost_.clear();
  if (!is_news) return;
  tell(Event::Severity::info,
       config_.bus.interface +
           " is back: drives that were lost are configured again; the axes stay "
           "disabled until enable or recover",
       now);
}

void Network::receive(const can::Frame& frame, Time stamp, Time now) {
  cycle_.setTime(now);
  if (phase_ == Phase::listening) {
    start_up_->receive(frame, now);
    if (frame.id == canopen::kSyncCobId) return;  // there is no cycle yet that it could lead
  }
  lss_->receive(frame, now);
  master_.receive(frame, stamp, now);
}

/// Asked for with every frame; LSS seldom has anything to do.
Time Network::nextDeadline() const {
  const Time due = earlier(sync_.deadline(), master_.nextDeadline());
  if (phase_ == Phase::running && !lss_->busy()) return due;
  const Time with_lss = earlier(due, lss_->deadline());
  if (phase_ == Phase::running) return with_lss;
  return phase_ == Phase::listening ? earlier(with_lss, start_up_->deadline()) : kNever;
}

void Network::produceSync(Time now) {
  if (phase_ != Phase::running || !sync_.ownSyncDue(now)) return;
  cycle_.setTime(now);
  sync_.onSyncDue(now);
}

/// With most frames nothing is due but to note the time.
void Network::tick(Time now) {
  const bool waits = phase_ == Phase::running && !cycle_.answered() && !sync_.anythingDue(now) &&
                     now < master_.nextDeadline() && now < lss_->deadline();
  if (!waits) return act(now);
  cycle_.setTime(now);
}

/// Not inlined: tick() would save the registers for all of it with every frame.
[[gnu::noinline]] void Network::act(Time now) {
  if (phase_ == Phase::listening) return listen(now);
  if (phase_ != Phase::running) return;
  cycle_.setTime(now);
  cycle_.hurry(now);
  if (sync_.syncDue(now)) sync_.onSyncDue(now);
  if (sync_.cycleDue(now)) stepCycle(now);
  if (now >= master_.nextDeadline()) master_.tick(now);
  if (now >= lss_->deadline() && lss_->tick(now)) boot(now);
}

void Network::stepCycle(Time now) {
  sync_.beginCycle();
  cycle_.move(now);
  master_.sendRpdos(now);
  cycle_.stepJobs(now);
  lss_->lookForLostDrives(now);
  cycle_.stepShutdown(now);
  cycle_.watch(now, [&](AxisUnit& unit) { nodes_->ofAxis(unit.index).watch(unit, now); });
  sync_.watch(now);
}

std::string Network::refusal() const {
  if (!started()) return "the bus interface " + config_.bus.interface + " is not there yet";
  if (lss_->starting()) {
    return "the drives are being given their node-IDs (" + lss_->step() + ")";
  }
  if (bus_lost_.empty()) return {};
  return bus_lost_ +
         ", nothing reaches the drives; those that watch the master's heartbeat stop by themselves";
}

void Network::execute(Command command, Time now) {
  const BusParts parts{cycle_, *this};
  cycle_.setTime(now);
  if (cycle_.shutdown().begun()) return command.refuse("refused: the driver is shutting down");
  if (!command.needsBus()) return command.begin(parts, now);
  if (phase_ == Phase::listening) return start_up_->take(std::move(command));
  const std::string why_not = refusal();
  if (!why_not.empty()) return command.refuse("refused: " + why_not);
  command.begin(parts, now);
}

/// A driver that is gone may have left motors turning. So drives that were not looked at yet are
/// looked at first: the boot begins with a stop of those that turn.
void Network::beginShutdown(Time now) {
  if (cycle_.shutdown().begun()) return;
  const bool stops = phase_ == Phase::running || start_up_->mayEnd(!bus_lost_.empty());
  cycle_.beginShutdown(stops, now);
  start_up_->refuseDeferred("the driver is shutting down");
  const bool unbooted = lss_->starting();
  lss_->abandon("ended by the shutdown of the driver", now);
  if (!stops) phase_ = Phase::ended;
  if (unbooted) boot(now);
  cycle_.endMotion(now);
}

void Network::releaseDevices(Time now) {
  master_.commandAll(canopen::NmtCommand::enter_pre_operational, now);
  phase_ = Phase::ended;
}

std::string Network::enableProblem() const {
  std::string problem = lss_->bitTiming().enableProblem();
  return problem.empty() ? sync_.enableProblem() : problem;
}

std::string Network::preparationOf(std::size_t axis) const { return lss_->preparationOf(axis); }

bool Network::prepareRecovery(const std::vector<AxisUnit*>& units) {
  return lss_->prepareRecovery(units);
}

void Network::fill(NetworkSnapshot& snapshot) const {
  snapshot.now = cycle_.now();
  snapshot.statistics = sync_.statistics();
  snapshot.shut_down = shutDown();
  const bool waits = !start_up_->problem().empty();
  snapshot.sync_problem = waits ? start_up_->problem() : sync_.problem();
  snapshot.missed_syncs = sync_.missed();
  snapshot.foreign_syncs = sync_.foreign();
  const std::vector<AxisUnit>& units = cycle_.units();
  snapshot.axes.resize(units.size());
  AxisSnapshot* axis = snapshot.axes.data();
  for (const AxisUnit& unit : units) {
    unit.fill(*axis);
    nodes_->ofAxis(unit.index).fill(*axis++, foreseen_);
  }
  const auto& joints = cycle_.joints().all();
  snapshot.joints.resize(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i]->show(snapshot.joints[i]);
  const std::vector<Group>& groups = cycle_.groups();
  snapshot.groups.resize(groups.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    snapshot.groups[i] = {groups[i].executing(), groups[i].stopping()};
  }
}

void Network::onSdoAnswer(canopen::Node& node) {
  if (NodeUnit* unit = unitOf(node)) {
    unit->forEachAxis([&](AxisUnit& axis) { cycle_.noteAnswer(axis); });
  }
}

void Network::onEmergency(canopen::Node& node, const fieldbus::Emergency& emergency) {
  NodeUnit* const unit = unitOf(node);
  if (unit == nullptr) return;
  const drive::DriveProfile& profile = *unit->axis().axis.config().profile;
  const bool misses =
      drive::missingByCode(profile, emergency.code) != drive::ErrorText::Missing::nothing;
  const std::string excuse = misses ? sync_.ownLateness(emergency.stamp) : std::string();
  unit->onEmergency(emergency, excuse, cycle_.now());
}

void Network::onMalformedEmergency(canopen::Node& node, std::size_t size) {
  if (NodeUnit* unit = unitOf(node)) unit->onMalformedEmergency(size, cycle_.now());
}

void Network::onBootUp(canopen::Node& node, Time now) {
  if (NodeUnit* unit = unitOf(node)) unit->onBootUp(now);
}

void Network::onHealthChange(canopen::Node& node, fieldbus::Health, Time now) {
  if (NodeUnit* unit = unitOf(node)) unit->onHealthChange(now);
  const bool lost = node.health() == fieldbus::Health::lost && !node.excused();
  if (!config_.bus.stop_all_on_loss || !lost || cycle_.shutdown().begun()) return;
  cycle_.quickStop(node.who() + " is lost: all axes get a quick stop (bus/stop_all_on_loss)", now);
}

void Network::onForeignSync(const can::Frame& frame, Time stamp, Time now) {
  if (started()) sync_.onForeignSync(frame, stamp, now);
}

}  // namespace cia402::bus
