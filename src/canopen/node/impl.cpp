// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/node/impl.h"

#include <algorithm>
#include <utility>

#include "canopen/boot/text.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr std::uint8_t kBootUp = 0x00;

NmtState stateOf(std::uint8_t byte) {
  const auto state = static_cast<NmtState>(byte & 0x7F);  // bit 7: node guarding's toggle bit
  switch (state) {
    case NmtState::stopped:
    case NmtState::operational:
    case NmtState::pre_operational:
      return state;
    case NmtState::boot_up:
    case NmtState::unknown:
      break;
  }
  return NmtState::unknown;
}

}  // namespace

Node::Impl::Impl(const NodeConfig& node_config, const MasterConfig& master, can::Sink& frame_sink,
                 SdoPacer* shared_turns, bool* changed, can::Pacer* wire)
    : image(node_config.by_sdo.empty() ? node_config.pdos : node_config.by_sdo),
      config(node_config),
      sink(frame_sink),
      deadlines_changed(changed),
      sdo(config.node_id, sink, config.sdo, config.sdo_channel, wire, config.lock),
      consumer(config.heartbeat_timeout),
      guard(config.node_id, config.guard_time, config.life_time_factor),
      boot(config, master, sdo, sink, shared_turns != nullptr ? *shared_turns : own_turns),
      retry(config.boot),
      last_stop(config, sdo, sink),
      pause(config.node_id, sink),
      sdo_cycle(config, image, sdo),
      kept(image, sdo) {
  process = &image;
  sdo.tellWhenQueued(changed);
}

std::string Node::Impl::who() const {
  if (!config.title.empty()) return config.title;
  const std::string node = "node " + std::to_string(config.node_id);
  return config.name.empty() ? node : config.name + " (" + node + ")";
}

std::string Node::Impl::sentence(const std::string& text) const { return who() + ": " + text; }

const std::string& Node::Impl::step() const {
  const std::string search = boot.running() ? std::string() : retry.searchText();
  step_text = search.empty() ? retry.attemptText() + boot.step() : search;
  return step_text;
}

void Node::Impl::refresh() {
  ++changes;
  next = std::min({sdo.nextDeadline(), consumer.deadline(), guard.deadline(), boot.deadline(),
                   retry.deadline(), last_stop.deadline(), pause.deadline()});
  if (deadlines_changed != nullptr) *deadlines_changed = true;
  pdos_live = boot.started() && (health == Health::ready || health == Health::booting);
}

void Node::Impl::startBoot(BootProcedure::From from, const std::string& why, Time now,
                           NmtCommand reset) {
  retry.reset();
  taken_out.clear();
  beginBoot(from, why, now, reset);
}

void Node::Impl::beginBoot(BootProcedure::From from, const std::string& why, Time now,
                           NmtCommand reset) {
  begun = true;
  takeOut(Health::booting, why);
  if (from == BootProcedure::From::boot_up) {
    sdo.serverRestarted();
    last_stop.forgetSetPoints();
  }
  notes.clear();
  half_floats_adopted = false;
  boot.stopUnasked(last_identity.has_value() && last_stop.ramps());
  boot.start(from, now, nmt_state, reset);
}

void Node::Impl::takeOut(Health as, const std::string& why) {
  boot.stop();
  last_stop.end();
  pause.end();
  sdo_cycle.stop();
  consumer.disarm();
  guard.stop();
  sdo.cancelAll(why.empty() ? "the node is booted again" : "the node " + why);
  probe.reset();
  if (health == Health::ready) last_stop.remember(image);
  image.invalidate();
  health = as;
  problem = why.empty() ? std::string() : sentence(why);
}

void Node::Impl::takeOutBy(NmtCommand command) {
  if (!begun) return;
  const std::string why = std::string("was taken out of operation by the NMT command '") +
                          toString(command) + "'; boot it (recover) to use it again";
  const std::string outlook = retry.outlook();
  const bool repeats = retry.deadline() != kNever;
  retry.reset();
  if (isAway(health)) {  // it may be optional, so it stays away until it is heard
    taken_out = why;
    takeOut(health, std::string("is ") + toString(health) + " and " + why);
  } else if (health != Health::failed) {
    takeOut(Health::failed, why);
  } else if (repeats) {
    problem.resize(problem.size() - outlook.size());
    problem += "; it is not tried again, for it " + why;
  }
}

void Node::Impl::lose(const std::string& why, Time now) {
  sdo.cancelAll("the node is lost: " + why);
  if (health != Health::ready) last_stop.remember(image);  // else takeOut() does
  takeOut(Health::lost, why + ": check power and cable; it is configured again when it is back");
  last_stop.begin(now);
  retry.search(now, last_stop.over());
}

void Node::Impl::runBoot(Time now) {
  if (!boot.running()) return;
  const std::size_t adopted = boot.found().cob_ids.size();
  const BootProcedure::Status status = boot.advance(now);
  if (boot.found().cob_ids.size() != adopted) adoptCobIds();
  if (boot.found().half_floats_known && !half_floats_adopted) adoptHalfFloats();
  const bool wide = !boot.found().widths.empty();
  if (boot.found().left_out.size() != left_out || wide || widened) adoptLeftOut();
  widened = wide;
  switch (status) {
    case BootProcedure::Status::running:
      superviseWhileBooting(now);
      break;
    case BootProcedure::Status::done:
      succeed(now);
      break;
    case BootProcedure::Status::failed:
      endBoot(Health::failed, now);
      break;
    case BootProcedure::Status::absent:
      endBoot(Health::absent, now);
      break;
    case BootProcedure::Status::idle:
      break;
  }
}

void Node::Impl::adoptCobIds() {
  for (const AdoptedCobId& pdo : boot.found().cob_ids) {
    image.setCobId(pdo.direction, pdo.number, pdo.cob_id);
    cob_ids_changed = true;
  }
}

void Node::Impl::adoptLeftOut() {
  left_out = boot.found().left_out.size();
  image.includeAll();
  for (const LearnedWidth& width : boot.found().widths) {
    image.widen(width.object, static_cast<unsigned>(8 * width.actual), width.is_signed);
  }
  for (const LeftOutEntry& entry : boot.found().left_out) {
    image.leaveOut(entry.direction, entry.number, entry.object);
  }
}

/// What travels by SDO is as wide for everybody; see SdoClient::halfFloats().
void Node::Impl::adoptHalfFloats() {
  half_floats_adopted = true;
  if (config.by_sdo.empty()) image.setHalfFloats(config.half_floats, sdo.halfFloats());
}

void Node::Impl::superviseWhileBooting(Time now) {
  const BootFindings& found = boot.found();
  const bool ask = boot.takeStateRequest();
  if (found.guarded) {
    if (!guard.active()) {
      guard.start(found.after_reset, sink, now);
    } else if (ask) {
      guard.ask(sink, now);
    }
  } else if (found.supervised) {
    consumer.allow();
  } else if (ask) {
    sink.send(NodeGuard::request(config.node_id));
  }
}

void Node::Impl::succeed(Time now) {
  health = Health::ready;
  problem.clear();
  retry.reset();
  sdo_cycle.start();
  kept.begin(boot.found().kept);
  if (boot.found().supervised && !boot.found().guarded) consumer.arm(now);
  notes = boot.notes();
  compareWithLastIdentity();
}

void Node::Impl::compareWithLastIdentity() {
  const Node::Identity& now = *boot.found().identity;
  if (last_identity) {
    const Node::Identity& then = *last_identity;
    const bool same_kind = now.vendor_id == then.vendor_id && now.product_code == then.product_code;
    if (now.serial != then.serial || !same_kind) {
      notes.push_back("is another drive than before: its serial number (1018:04) is " +
                      std::to_string(now.serial) + ", it was " + std::to_string(then.serial) +
                      (same_kind ? "" : ", and its vendor or product is another one, too") +
                      "; check its position and parameters before it moves, or give `serial` under "
                      "`identity` so that a strange drive is refused");
    }
  }
  last_identity = now;
}

void Node::Impl::endBoot(Health end, Time now) {
  consumer.disarm();
  guard.stop();
  health = end;
  notes = boot.notes();
  if (end == Health::absent) {
    retry.search(now);
  } else {
    retry.failed(boot.failure(), now);
  }
  problem = sentence(boot.error() + retry.outlook());
}

void Node::Impl::onBootUp(Time now) {
  ++boot_ups;
  nmt_state = NmtState::boot_up;
  if (!begun) return;
  const bool surprise = health == Health::ready;
  startBoot(BootProcedure::From::boot_up,
            surprise
                ? "rebooted by itself (boot-up message in operation): look for a power dip or a "
                  "watchdog reset; it is configured again and stays disabled"
                : "",
            now);
}

void Node::Impl::onErrorControl(std::uint8_t byte, Time stamp, Time now) {
  if (byte == kBootUp) {
    onBootUp(now);
  } else if (!guard.active() || guard.receive(byte, now)) {
    onHeartbeat(stateOf(byte), stamp, now);
  }
}

void Node::Impl::onHeartbeat(NmtState state, Time stamp, Time now) {
  last_heartbeat = stamp;
  consumer.heard(now);
  if (boot.overtakenByTpdo(state)) return;
  nmt_state = state;
  if (boot.running()) {
    stopUnasked(state, now);
    boot.heartbeatHeard(state, now);
    runBoot(now);
    return;
  }
  if (pause.active()) return pause.heard(state);
  // What was asked for before its heartbeat told can only time out.
  if (state == NmtState::stopped && !isAway(health) && !sdo.idle()) sdo.cancelAll(kStoppedIsMute);
  if (!begun) return;
  if (isAway(health) && !taken_out.empty()) {
    takeOut(Health::failed, std::exchange(taken_out, {}));
  } else if (isAway(health)) {
    if (last_stop.insists(state, now)) return;
    startBoot(BootProcedure::From::heard, "", now);
  } else if (health == Health::ready && state != NmtState::operational &&
             state != NmtState::unknown) {
    startBoot(BootProcedure::From::heard,
              std::string("became ") + toString(state) +
                  " without our command: look for another NMT master or a reset; it is configured "
                  "again and stays disabled",
              now);
    sdo.tick(now);
    stopUnasked(state, now);
  }
}

/// It goes on as before, and so may its motor. Who it is was seen before: that need not be waited
/// for, nor answers, each of which may be lost.
void Node::Impl::stopUnasked(NmtState state, Time now) {
  if (!last_identity) return;
  const bool asked_in_vain = boot.asksForMotors(state);
  if (boot.ignoresReset(state, now)) {
    last_stop.stopMotor();
  } else if (asked_in_vain) {
    last_stop.stopBesides(state, now);
  }
}

void Node::Impl::onEmergency(const can::Frame& frame, Time stamp) {
  const auto emergency = decodeEmergency(frame, stamp);
  if (!emergency) {
    ++malformed_emergencies;
    return;
  }
  last_emergency = emergency;
  ++emergencies;
}

void Node::Impl::checkSupervision(Time now) {
  if (consumer.expired(now)) {
    lose("no heartbeat for " + secondsText(consumer.timeout()), now);
    return;
  }
  if (!guard.expired(now)) {
    guard.tick(sink, now);
    return;
  }
  if (!boot.running() || guard.answered()) {
    lose(guard.loss(), now);
    return;
  }
  const std::string why = "boot failed: " + guard.loss() +
                          "; if the drive has no node guarding, choose another `error_control`";
  takeOut(Health::failed, why);
  retry.failed(BootFailure::timed_out, now);
  problem = sentence(why + retry.outlook());
}

void Node::Impl::continuePause(Time now) {
  if (pause.tick(now)) return;
  startBoot(BootProcedure::From::unknown,
            "was stopped (NMT) for a fault reset and did not become operational again; it is "
            "configured again and stays disabled",
            now);
}

void Node::Impl::tryAgain(Time now) {
  if (retry.retryDue(now)) {
    retry.begun();
    beginBoot(BootProcedure::From::unknown, "", now);
  } else if (retry.searchDue(now)) {
    retry.begun();
    // It may have heard the stop after its loss, and a stopped node answers no SDO.
    sink.send(nmtFrame(NmtCommand::enter_pre_operational, config.node_id));
    SdoOptions once = config.sdo;
    once.retries = 0;
    probe = sdo.upload({0x1000, 0}, "device type", once);
    sdo.tick(now);
    // A guarded drive that is deaf to NMT has no SDO in that state, and tells it if asked.
    const bool guarded = config.error_control == ErrorControl::guarding;
    if (guarded) sink.send(NodeGuard::request(config.node_id));
  }
}

void Node::Impl::look(Time at) {
  if (!begun || !isAway(health) || !taken_out.empty() || probe) return;
  retry.look(std::max(at, last_stop.over()));
  refresh();
}

/// Any answer to the search, a refusal as well, tells that somebody is there.
void Node::Impl::runProbe(Time now) {
  if (!probe || !probe->done()) return;
  const SdoTicket answer = std::exchange(probe, {});
  if (answer->ok() || answer->failure() == fieldbus::Transfer::Failure::aborted_by_server) {
    startBoot(BootProcedure::From::heard, "", now);
  } else {
    retry.notFound(now);
  }
}

}  // namespace cia402::canopen
