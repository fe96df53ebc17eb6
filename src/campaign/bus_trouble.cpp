// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/bus_trouble.h"

#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

#include "campaign/verbs.h"

namespace cia402::campaign {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kNodeBits = 0x7F;  // of an identifier of the predefined connection set
constexpr Duration kHeard = 5ms;           // by then a drive has left operational, if it is to
constexpr std::uint8_t kNmtStart = 1;
constexpr std::uint8_t kNmtResetNode = 129, kNmtResetCommunication = 130;
constexpr std::pair<const char*, std::uint8_t> kNmtCommands[] = {
    {"start", kNmtStart},
    {"stop", 2},
    {"pre_operational", 128},
    {"reset_node", kNmtResetNode},
    {"reset_communication", kNmtResetCommunication}};

const Verbs<BusTrouble> kBusVerbs{
    {"loss", &BusTrouble::lose},       {"duplicate", &BusTrouble::duplicate},
    {"corrupt", &BusTrouble::corrupt}, {"delay", &BusTrouble::delay},
    {"sync", &BusTrouble::sync},       {"foreign_nmt", &BusTrouble::foreignNmt},
    {"unheard", &BusTrouble::unheard}, {"nmt_loss", &BusTrouble::loseNmt},
    {"cable", &BusTrouble::pullCable}, {"bus_off", &BusTrouble::busOff}};

std::uint8_t nmtCommand(const std::string& name) {
  for (const auto& [known, code] : kNmtCommands) {
    if (name == known) return code;
  }
  throw std::invalid_argument("no such NMT command");
}

}  // namespace

BusTrouble::BusTrouble(Session& session)
    : session_(session), foreign_(&session.stage.world().bus().attach(deaf_, "foreign")) {
  foreign_->setAttached(false);
}

bool BusTrouble::act(const Words& words) { return actBy(kBusVerbs, *this, words); }

void BusTrouble::calm() {
  rates_ = {};
  session_.stage.world().bus().faults().clear();
  foreign_->setAttached(false);
}

void BusTrouble::lose(const Words& words) { disturb(&sim::FaultRates::loss, words); }
void BusTrouble::duplicate(const Words& words) { disturb(&sim::FaultRates::duplicate, words); }
void BusTrouble::corrupt(const Words& words) { disturb(&sim::FaultRates::corrupt, words); }

void BusTrouble::delay(const Words& words) {
  rates_.longest_delay = toDuration(words.at(3));
  disturb(&sim::FaultRates::delay, words);
}

void BusTrouble::disturb(double sim::FaultRates::*rate, const Words& words) {
  rates_.*rate = toNumber(words.at(1));
  const Duration length = toDuration(words.at(2));
  const Time now = session_.now();
  session_.stage.world().bus().faults().setRates(rates_);
  Conditions::extend(session_.conditions.lossy, now + length + 300ms);
  // Who follows a SYNC from elsewhere stands still where that is lost.
  const Duration waits = session_.stage.loaded().robot.bus.external_sync ? length : 0ms;
  for (std::size_t i = 0; i < session_.truths.size(); ++i) {
    session_.permits.stretch(i, 500ms + waits, now + length + waits + 1s);
  }
  session_.later(length, [this, rate] {
    rates_.*rate = 0.0;
    session_.stage.world().bus().faults().setRates(rates_);
  });
}

void BusTrouble::sync(const Words& words) {
  foreign_->setAttached(true);
  const Time end = session_.now() + toDuration(words.at(2));
  Conditions::extend(session_.conditions.foreign, end + 500ms);
  const Duration period = toDuration(words.at(1));
  session_.later(0ms, [this, end, period] { produceSync(end, period, 0); });
}

/// @param counter of the last SYNC, where the bus counts them.
void BusTrouble::produceSync(Time end, Duration period, int counter) {
  if (session_.now() >= end) return;
  const int overflow = session_.stage.loaded().robot.bus.sync_counter;
  can::Frame frame(0x80, {});
  if (overflow != 0) {
    counter = counter % overflow + 1;
    frame = can::Frame(0x80, {static_cast<std::uint8_t>(counter)});
  }
  foreign_->send(frame, session_.now());
  session_.later(period, [this, end, period, counter] { produceSync(end, period, counter); });
}

void BusTrouble::foreignNmt(const Words& words) {
  foreign_->setAttached(true);
  const std::uint8_t code = nmtCommand(words.at(2));
  const AxisFacts* const facts = session_.stage.find(words.at(1));
  if (facts == nullptr && words.at(1) != "all") return;
  const std::uint8_t node = facts != nullptr ? facts->node_id : std::uint8_t{0};
  const Time now = session_.now();
  foreign_->send(can::Frame(0x000, {code, node}), now);
  for (std::size_t i : session_.stage.named(words.at(1))) {
    Conditions::extend(session_.conditions.foreign, now + 500ms);
    if (code == kNmtResetNode) session_.mayCoastInDriveOf(i);
    const auto operational = [this, i] {
      return !session_.truths.empty() && session_.truths[i].nmt == canopen::NmtState::operational;
    };
    const bool resets = code == kNmtResetNode || code == kNmtResetCommunication;
    const Duration away =
        resets ? session_.stage.driveOf(i).device().behaviour().boot_time : Duration::zero();
    if (code == kNmtStart) {
      if (!operational()) session_.loseCommands(i, 1s);
      continue;
    }
    // A drive that goes on has not heard it, and what it was told counts on.
    session_.later(kHeard, [this, i, away, operational] {
      if (!operational()) session_.loseCommands(i, 1s + away);
    });
  }
}

void BusTrouble::unheard(const Words& words) {
  const Duration length = toDuration(words.at(3));
  for (std::size_t i : session_.stage.drivesNamed(words.at(1))) {
    const DriveFacts& drive = session_.stage.drives()[i];
    session_.breakLink(drive.axes.front(), length);
    std::set<std::uint32_t> ids{0x580U + drive.node_id, 0x700U + drive.node_id};  // SDO, heartbeat
    if (words.at(2) == "all") {
      ids = {drive.node_id};
      for (const PdoPlace& place : session_.stage.tpdos()) {
        const bool own = session_.stage.axes()[place.axis].place.drive == i;
        if (own && (place.cob_id & kNodeBits) != drive.node_id) ids.insert(place.cob_id);
      }
    }
    for (const std::uint32_t id : ids) loseAtHost(id, length);
  }
}

/// @param id a COB-ID, or a node-ID: all frames with the COB-IDs that it has by default.
void BusTrouble::loseAtHost(std::uint32_t id, Duration length) {
  sim::FaultRule rule;
  rule.id = id;
  if (id <= kNodeBits) rule.mask = kNodeBits;
  rule.count = std::numeric_limits<unsigned>::max();
  rule.receiver = session_.stage.host().interface().port().name();
  session_.stage.world().bus().faults().add(rule);
  session_.later(length, [this, rule] { session_.stage.world().bus().faults().remove(rule); });
}

void BusTrouble::loseNmt(const Words& words) {
  for (std::size_t i : session_.stage.drivesNamed(words.at(1))) {
    sim::FaultRule rule;
    rule.count = static_cast<unsigned>(toNumber(words.at(2)));
    rule.receiver = session_.stage.world().port(i).name();
    session_.stage.world().bus().faults().add(rule);
  }
}

/// @return the ports that lose their bus; those that it cuts off are told to the session.
std::vector<sim::Port*> BusTrouble::breakLinks(const Words& words) {
  Stage& stage = session_.stage;
  const bool host = words.at(1) == "host";
  const Duration length = toDuration(words.at(2));
  for (std::size_t i : stage.named(host ? "all" : words.at(1))) session_.breakLink(i, length);
  std::vector<sim::Port*> ports;
  if (host) ports.push_back(&stage.host().interface().port());
  for (std::size_t i : stage.drivesNamed(words.at(1))) ports.push_back(&stage.world().port(i));
  return ports;
}

void BusTrouble::pullCable(const Words& words) {
  for (sim::Port* port : breakLinks(words)) {
    port->setAttached(false);
    session_.later(toDuration(words.at(2)), [port] { port->setAttached(true); });
  }
}

void BusTrouble::busOff(const Words& words) {
  for (sim::Port* port : breakLinks(words)) {
    port->forceBusOff();
    session_.later(toDuration(words.at(2)), [port] { port->requestRecovery(); });
  }
}

}  // namespace cia402::campaign
