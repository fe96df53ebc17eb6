// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/pdo_server.h"

#include <algorithm>

namespace cia402::sim {

namespace {

constexpr unsigned kMaxPdos = 512;
constexpr std::uint16_t kRpdoCommunication = 0x1400;
constexpr std::uint16_t kTpdoCommunication = 0x1800;

}  // namespace

void PdoServer::serveObjects() {
  const auto exists = [this](unsigned index) {
    return context_.dictionary.find({static_cast<std::uint16_t>(index), pdo_sub::kCobId}) !=
           nullptr;
  };
  rpdos_.clear();
  tpdos_.clear();
  for (unsigned number = 0; number < kMaxPdos; ++number) {
    if (exists(kRpdoCommunication + number)) rpdos_.emplace_back(context_, emergency_, number);
    if (exists(kTpdoCommunication + number)) tpdos_.emplace_back(context_, number);
  }
  due_.reserve(tpdos_.size());
  for (SlaveRpdo& pdo : rpdos_) {
    serveRecords(pdo.records(), [&pdo] { pdo.configure(); });
  }
  for (SlaveTpdo& pdo : tpdos_) {
    serveRecords(pdo.records(), [&pdo] { pdo.configure(); });
  }
}

void PdoServer::serveRecords(const PdoRecords& pdo, const std::function<void()>& configure) {
  const auto taken = [this, pdo, configure](const Entry& entry) {
    if (entry.id.index == pdo.mapping && entry.id.subindex != 0) countEntries(context_, pdo);
    configure();
    configured();
  };
  for (unsigned sub = 1; sub <= pdo_sub::kSyncStart; ++sub) {
    context_.serveWrites(
        {pdo.communication, static_cast<std::uint8_t>(sub)},
        [this, pdo](const Entry& entry, std::uint64_t number) {
          return checkCommunication(context_, pdo, entry, number);
        },
        taken);
  }
  for (unsigned sub = 0; sub <= 64; ++sub) {
    context_.serveWrites(
        {pdo.mapping, static_cast<std::uint8_t>(sub)},
        [this, pdo](const Entry& entry, std::uint64_t number) {
          return checkMapping(context_, pdo, entry, number);
        },
        taken);
  }
}

void PdoServer::configure() {
  for (SlaveRpdo& pdo : rpdos_) {
    countEntries(context_, pdo.records());
    pdo.configure();
  }
  for (SlaveTpdo& pdo : tpdos_) {
    setRtrBit(context_, pdo.records());
    countEntries(context_, pdo.records());
    pdo.configure();
  }
  configured();
}

void PdoServer::configured() {
  ids_.reset();
  for (const SlaveRpdo& pdo : rpdos_) {
    if (pdo.canId() < ids_.size()) ids_.set(pdo.canId());
  }
  for (const SlaveTpdo& pdo : tpdos_) {
    if (pdo.requestId() < ids_.size()) ids_.set(pdo.requestId());
  }
  event_driven_ = std::any_of(tpdos_.begin(), tpdos_.end(),
                              [](const SlaveTpdo& pdo) { return pdo.eventDriven(); });
  timed_ = event_driven_ || std::any_of(rpdos_.begin(), rpdos_.end(),
                                        [](const SlaveRpdo& pdo) { return pdo.supervised(); });
}

void PdoServer::start() {
  for (SlaveTpdo& pdo : tpdos_) pdo.start();
}

void PdoServer::stop() {
  for (SlaveRpdo& pdo : rpdos_) pdo.stop();
  for (SlaveTpdo& pdo : tpdos_) pdo.stop();
}

void PdoServer::sendOnStart() {
  if (!sendsOnChange()) return;
  context_.application.beforeTpdo(context_.now);
  for (SlaveTpdo& pdo : tpdos_) pdo.onStart();
}

void PdoServer::receive(const can::Frame& frame) {
  if (!frame.remote) {
    for (SlaveRpdo& pdo : rpdos_) {
      if (pdo.canId() == frame.id) pdo.receive(frame);
    }
    return;
  }
  for (SlaveTpdo& pdo : tpdos_) {
    if (pdo.requestId() != frame.id) continue;
    context_.application.beforeTpdo(context_.now);
    pdo.onRequest();
  }
}

void PdoServer::applySynchronous() {
  for (SlaveRpdo& pdo : rpdos_) pdo.onSync();
}

void PdoServer::sendSynchronous(std::uint8_t counter) {
  due_.clear();
  for (SlaveTpdo& pdo : tpdos_) {
    if (pdo.wantsSample(counter)) due_.push_back(&pdo);
  }
  if (due_.empty()) return;
  context_.application.beforeTpdo(context_.now);
  for (SlaveTpdo* pdo : due_) pdo->onSync();
}

bool PdoServer::anySendsOnChange() const {
  return std::any_of(tpdos_.begin(), tpdos_.end(),
                     [](const SlaveTpdo& pdo) { return pdo.sendsOnChange(); });
}

void PdoServer::notifyChange() {
  for (SlaveTpdo& pdo : tpdos_) pdo.onChange();
}

void PdoServer::tick() {
  if (!timed_) return;
  for (SlaveRpdo& pdo : rpdos_) pdo.tick();
  bool refreshed = false;
  for (SlaveTpdo& pdo : tpdos_) {
    if (pdo.deadline() > context_.now) continue;
    if (!refreshed) context_.application.beforeTpdo(context_.now);
    refreshed = true;
    pdo.tick();
  }
}

Time PdoServer::deadline() const {
  Time earliest = kNever;
  if (!timed_) return earliest;
  for (const SlaveRpdo& pdo : rpdos_) earliest = std::min(earliest, pdo.deadline());
  for (const SlaveTpdo& pdo : tpdos_) earliest = std::min(earliest, pdo.deadline());
  return earliest;
}

}  // namespace cia402::sim
