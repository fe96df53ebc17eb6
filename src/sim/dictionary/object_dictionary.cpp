// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/dictionary/object_dictionary.h"

#include <utility>

#include "fieldbus/abort_code.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

std::uint64_t truncate(std::uint64_t number, unsigned bits) {
  return bits >= 64 ? number : number & ((std::uint64_t{1} << bits) - 1);
}

std::int64_t signExtend(std::uint64_t number, unsigned bits) {
  if (bits == 0 || bits >= 64) return static_cast<std::int64_t>(number);
  const std::uint64_t sign = std::uint64_t{1} << (bits - 1);
  return static_cast<std::int64_t>((truncate(number, bits) ^ sign) - sign);
}

bool isReal(DataType type) { return type == DataType::real32 || type == DataType::real64; }

bool isSignedInteger(DataType type) {
  return type == DataType::int8 || type == DataType::int16 || type == DataType::int24 ||
         type == DataType::int32 || type == DataType::int40 || type == DataType::int48 ||
         type == DataType::int56 || type == DataType::int64;
}

// Bytes a value takes in an SDO; a boolean takes a whole one. 0: any length.
std::size_t sizeBytes(DataType type) { return (widthBits(type) + 7U) / 8U; }

std::uint32_t checkAccess(const Entry& entry) {
  const bool writable = entry.access == Access::rw || entry.access == Access::wo;
  return writable ? 0 : abort_code::kReadOnly;
}

std::uint32_t checkLength(const Entry& entry, std::size_t size) {
  const std::size_t expected = sizeBytes(entry.type);
  if (expected == 0 || size == expected) return 0;
  return size > expected ? abort_code::kLengthTooHigh : abort_code::kLengthTooLow;
}

std::uint32_t checkRange(const Entry& entry, std::uint64_t number) {
  if (isReal(entry.type)) return 0;
  if (isSignedInteger(entry.type)) {
    const std::int64_t value = signExtend(number, widthBits(entry.type));
    if (entry.high && value > *entry.high) return abort_code::kValueTooHigh;
    if (entry.low && value < *entry.low) return abort_code::kValueTooLow;
    return 0;
  }
  if (entry.high && *entry.high >= 0 && number > static_cast<std::uint64_t>(*entry.high)) {
    return abort_code::kValueTooHigh;
  }
  if (entry.low && *entry.low > 0 && number < static_cast<std::uint64_t>(*entry.low)) {
    return abort_code::kValueTooLow;
  }
  return 0;
}

}  // namespace

std::int64_t asSigned(const Entry& entry) {
  return signExtend(entry.number, widthBits(entry.type));
}

Entry& ObjectDictionary::add(Entry entry) {
  const unsigned bits = widthBits(entry.type);
  if (bits != 0) entry.number = truncate(entry.number, bits);
  entry.initial_number = entry.number;
  entry.initial_bytes = entry.bytes;
  Entry& place = entries_[entry.id];
  place = std::move(entry);
  return place;
}

Entry* ObjectDictionary::find(ObjectId id) {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

const Entry* ObjectDictionary::find(ObjectId id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

bool ObjectDictionary::hasIndex(std::uint16_t index) const {
  const auto found = entries_.lower_bound(ObjectId{index, 0});
  return found != entries_.end() && found->first.index == index;
}

void ObjectDictionary::onWriteCheck(ObjectId id, WriteCheck check) {
  hooks_[id].check = std::move(check);
}

void ObjectDictionary::onWrite(ObjectId id, WriteHook hook) { hooks_[id].write = std::move(hook); }

void ObjectDictionary::onRead(ObjectId id, ReadHook hook) { hooks_[id].read = std::move(hook); }

const ObjectDictionary::Hooks& ObjectDictionary::hooks(ObjectId id) { return hooks_[id]; }

std::uint32_t ObjectDictionary::read(ObjectId id, std::vector<std::uint8_t>& out) {
  Entry* entry = find(id);
  if (entry == nullptr) {
    return hasIndex(id.index) ? abort_code::kNoSuchSubindex : abort_code::kNoSuchObject;
  }
  if (entry->access == Access::wo) return abort_code::kWriteOnly;
  const auto hooks = hooks_.find(id);
  if (hooks != hooks_.end() && hooks->second.read) {
    if (const std::uint32_t refused = hooks->second.read(*entry)) return refused;
  }
  const std::size_t size = sizeBytes(entry->type);
  if (size == 0) {
    out = entry->bytes;
    return 0;
  }
  out.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    out[i] = static_cast<std::uint8_t>(entry->number >> (8 * i));
  }
  return 0;
}

std::uint32_t ObjectDictionary::checkWritable(ObjectId id, std::optional<std::size_t> size) const {
  const Entry* entry = find(id);
  if (entry == nullptr) {
    return hasIndex(id.index) ? abort_code::kNoSuchSubindex : abort_code::kNoSuchObject;
  }
  if (const std::uint32_t refused = checkAccess(*entry)) return refused;
  return size ? checkLength(*entry, *size) : 0;
}

std::uint32_t ObjectDictionary::write(ObjectId id, const std::vector<std::uint8_t>& data) {
  if (const std::uint32_t refused = checkWritable(id, data.size())) return refused;
  Entry& entry = *find(id);
  if (widthBits(entry.type) != 0) {
    std::uint64_t number = 0;
    for (std::size_t i = data.size(); i-- > 0;) number = (number << 8U) | data[i];
    if (entry.type == DataType::boolean && number > 1) return abort_code::kInvalidValue;
    const std::uint64_t before = entry.number;
    const std::uint32_t refused = writeNumber(entry, number);
    if (refused == 0 && change_ && entry.number != before) change_(entry);
    return refused;
  }
  const auto found = hooks_.find(id);
  const Hooks none;
  const Hooks& hooks = found == hooks_.end() ? none : found->second;
  if (hooks.check) {
    if (const std::uint32_t refused = hooks.check(entry, 0)) return refused;
  }
  const bool changes = entry.bytes != data;
  entry.bytes = data;
  if (hooks.write) hooks.write(entry);
  if (changes && change_) change_(entry);
  return 0;
}

std::uint32_t ObjectDictionary::writeNumber(Entry& entry, std::uint64_t number) {
  static const Hooks none;
  const auto found = hooks_.find(entry.id);
  return writeNumber(entry, number, found == hooks_.end() ? none : found->second);
}

std::uint32_t ObjectDictionary::writeNumber(Entry& entry, std::uint64_t number,
                                            const Hooks& hooks) {
  if (const std::uint32_t refused = checkAccess(entry)) return refused;
  std::uint64_t value = truncate(number, widthBits(entry.type));
  if (const std::uint32_t refused = checkRange(entry, value)) {
    if (!entry.clamps) return refused;
    const auto& limit = refused == abort_code::kValueTooHigh ? entry.high : entry.low;
    value = truncate(static_cast<std::uint64_t>(*limit), widthBits(entry.type));
  }
  if (hooks.check) {
    if (const std::uint32_t refused = hooks.check(entry, value)) return refused;
  }
  if (entry.deaf) return 0;
  entry.number = value;
  if (hooks.write) hooks.write(entry);
  return 0;
}

void ObjectDictionary::restoreInitial() { restoreInitial(0x0000, 0xFFFF); }

void ObjectDictionary::restoreInitial(std::uint16_t first, std::uint16_t last) {
  for (auto it = entries_.lower_bound(ObjectId{first, 0});
       it != entries_.end() && it->first.index <= last; ++it) {
    it->second.number = it->second.initial_number;
    it->second.bytes = it->second.initial_bytes;
  }
}

}  // namespace cia402::sim
