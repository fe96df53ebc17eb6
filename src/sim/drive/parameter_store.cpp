// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/drive/parameter_store.h"

#include <utility>

#include "fieldbus/abort_code.h"
#include "sim/dictionary/axis_objects.h"

namespace cia402::sim {
namespace {

constexpr std::uint16_t kStore = 0x1010;
constexpr std::uint16_t kRestore = 0x1011;
constexpr std::uint16_t kVerifyConfiguration = 0x1020;
constexpr std::uint16_t kMode = 0x6060;
constexpr std::uint8_t kOfMaker = 4;
constexpr std::uint16_t kOutputs = 0x60FE;
constexpr std::uint64_t kSave = 0x65766173;  // "save", least significant byte first
constexpr std::uint64_t kLoad = 0x64616F6C;  // "load"

bool inGroup(std::uint16_t index, std::uint8_t subindex) {
  switch (subindex) {
    case 1:
      return true;
    case 2:
      return index < 0x2000;
    case 3:
      return index >= 0x6000;
    case 4:
      return index >= 0x2000 && index < 0x6000;
    default:
      return false;
  }
}

}  // namespace

ParameterStore::ParameterStore(ObjectDictionary& dictionary, const MemoryDefinition& memory,
                               unsigned axes, std::function<bool()> enabled,
                               std::function<void()> stored)
    : dictionary_(dictionary),
      memory_(memory),
      axes_(axes),
      enabled_(std::move(enabled)),
      stored_(std::move(stored)) {
  for (const auto& pair : dictionary_.entries()) factory_[pair.first] = pair.second.initial_number;
  install(kStore, kSave);
  install(kRestore, kLoad);
  dictionary_.onChange([this](const Entry& entry) { changed(entry); });
}

bool ParameterStore::isParameter(const Entry& entry) const {
  switch (ofFirstAxis(entry.id, axes_).index) {
    case kStore:
    case kRestore:
    case 0x1003:
    case 0x6040:
    case 0x6071:
    case 0x607A:
    case 0x60FF:
      return false;
    default:
      return entry.access == Access::rw;
  }
}

void ParameterStore::install(std::uint16_t index, std::uint64_t signature) {
  for (std::uint8_t sub = 1; sub <= 4; ++sub) {
    const ObjectId id{index, sub};
    if (dictionary_.find(id) == nullptr) continue;
    dictionary_.onWriteCheck(id, [this, signature](const Entry&, std::uint64_t number) {
      if (number != signature) return fieldbus::abort_code::kCannotTransfer;
      return enabled_() ? fieldbus::abort_code::kDeviceState : 0U;
    });
    dictionary_.onWrite(id, [this, index](const Entry& entry) {
      const std::uint8_t subindex = entry.id.subindex;
      dictionary_.find(entry.id)->number = entry.initial_number;
      index == kStore ? store(subindex) : restore(subindex);
    });
  }
}

void ParameterStore::moveDefault(ObjectId id, std::int64_t by) {
  Entry* entry = dictionary_.find(id);
  std::uint64_t& factory = factory_[id];
  const std::uint64_t moved = factory + static_cast<std::uint64_t>(by);
  if (entry != nullptr && entry->initial_number == factory) entry->initial_number = moved;
  factory = moved;
}

void ParameterStore::changed(const Entry& entry) {
  const std::uint16_t index = ofFirstAxis(entry.id, axes_).index;
  const bool commanded = index == kVerifyConfiguration || index == kMode || index == kOutputs;
  if (commanded || !isParameter(entry)) return;
  const auto reset = memory_.reset.find(entry.id);
  if (reset != memory_.reset.end()) {
    if (entry.number == static_cast<std::uint64_t>(reset->second)) resetByObject();
    dictionary_.find(entry.id)->number = entry.initial_number;
    return;
  }
  for (const std::uint8_t sub : {std::uint8_t{1}, std::uint8_t{2}}) {
    if (Entry* mark = dictionary_.find({kVerifyConfiguration, sub})) mark->number = 0;
  }
}

void ParameterStore::store(std::uint8_t subindex) {
  for (const auto& pair : dictionary_.entries()) {
    if (!inGroup(pair.first.index, subindex) || !isParameter(pair.second)) continue;
    dictionary_.find(pair.first)->initial_number = pair.second.number;
  }
  if (stored_) stored_();
}

void ParameterStore::keep(const Entry& entry, std::uint64_t number) {
  if (!memory_.keeps || !inGroup(entry.id.index, kOfMaker) || !isParameter(entry)) return;
  if (memory_.reset.count(entry.id) != 0) return;
  const Entry* keeps = dictionary_.find(*memory_.keeps);
  const bool on = keeps == &entry ? number != 0 : keeps != nullptr && keeps->number != 0;
  if (on) dictionary_.find(entry.id)->initial_number = number;
}

// What the standard has counts from the next reset on.
void ParameterStore::resetByObject() {
  restore(1);
  for (const auto& [id, number] : memory_.factory) {
    Entry* entry = dictionary_.find(id);
    if (entry != nullptr) entry->initial_number = static_cast<std::uint64_t>(number);
  }
  for (const auto& pair : dictionary_.entries()) {
    if (!inGroup(pair.first.index, kOfMaker) || !isParameter(pair.second)) continue;
    dictionary_.find(pair.first)->number = pair.second.initial_number;
  }
}

bool ParameterStore::silent() const {
  const auto differs = [this](ObjectId id, std::uint64_t number) {
    const Entry* entry = dictionary_.find(id);
    return entry != nullptr && entry->number != number;
  };
  for (const auto& [id, number] : memory_.silent_unless) {
    if (differs(id, static_cast<std::uint64_t>(number))) return true;
  }
  return false;
}

void ParameterStore::restore(std::uint8_t subindex) {
  for (const auto& pair : factory_) {
    if (inGroup(pair.first.index, subindex)) {
      dictionary_.find(pair.first)->initial_number = pair.second;
    }
  }
}

}  // namespace cia402::sim
