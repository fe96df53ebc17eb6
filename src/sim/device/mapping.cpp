// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "sim/device/mapping.h"

#include "fieldbus/abort_code.h"

namespace cia402::sim {

namespace abort_code = fieldbus::abort_code;

namespace {

constexpr unsigned kMaxBits = 64;

ObjectId objectOf(std::uint64_t value) {
  return {static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)};
}

unsigned bitsOf(std::uint64_t value) { return static_cast<unsigned>(value & 0xFFU); }

// Width of a dummy entry: the data types 0001h..0007h themselves (CiA 301, 7.4.7.1); 0: none.
unsigned dummyBits(ObjectId id) {
  constexpr unsigned kBits[] = {0, 1, 8, 16, 32, 8, 16, 32};
  return id.index < 8 && id.subindex == 0 ? kBits[id.index] : 0;
}

bool isMappable(const Entry& entry, PdoDirection direction) {
  if (direction == PdoDirection::transmit) return entry.tpdo && entry.access != Access::wo;
  return entry.rpdo && (entry.access == Access::rw || entry.access == Access::wo);
}

std::uint64_t maskOf(unsigned bits) {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

std::uint64_t mappingValue(const ObjectDictionary& dictionary, std::uint16_t index,
                           std::uint64_t place) {
  const Entry* entry = dictionary.find({index, static_cast<std::uint8_t>(place)});
  return entry == nullptr ? 0 : entry->number;
}

}  // namespace

std::uint32_t Mapping::checkEntry(const ObjectDictionary& dictionary, std::uint64_t value,
                                  PdoDirection direction) {
  const ObjectId id = objectOf(value);
  if (direction == PdoDirection::receive && dummyBits(id) != 0) {
    return bitsOf(value) == dummyBits(id) ? 0 : abort_code::kPdoLength;
  }
  const Entry* entry = dictionary.find(id);
  if (entry == nullptr) return abort_code::kNoSuchObject;
  if (!isMappable(*entry, direction)) return abort_code::kNotMappable;
  const unsigned width = widthBits(entry->type);
  if (width == 0) return abort_code::kNotMappable;
  return bitsOf(value) == width ? 0 : abort_code::kPdoLength;
}

std::uint32_t Mapping::check(const ObjectDictionary& dictionary, std::uint16_t index,
                             std::uint64_t count, PdoDirection direction) {
  if (count > kMaxBits) return abort_code::kPdoLength;
  if (dictionary.find({index, static_cast<std::uint8_t>(count)}) == nullptr) {
    return abort_code::kPdoLength;
  }
  unsigned bits = 0;
  for (std::uint64_t place = 1; place <= count; ++place) {
    const std::uint64_t value = mappingValue(dictionary, index, place);
    if (const auto refused = checkEntry(dictionary, value, direction)) return refused;
    bits += bitsOf(value);
  }
  return bits <= kMaxBits ? 0 : abort_code::kPdoLength;
}

void Mapping::build(ObjectDictionary& dictionary, std::uint16_t index, PdoDirection direction,
                    bool fillers) {
  objects_.clear();
  bits_ = 0;
  std::uint64_t count = mappingValue(dictionary, index, 0);
  while (fillers && count > 0 && mappingValue(dictionary, index, count) == 0) --count;
  if (check(dictionary, index, count, direction) != 0) return;
  objects_.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t place = 1; place <= count; ++place) {
    const std::uint64_t value = mappingValue(dictionary, index, place);
    const ObjectId id = objectOf(value);
    const bool dummy = direction == PdoDirection::receive && dummyBits(id) != 0;
    objects_.push_back(Object{dummy ? nullptr : dictionary.find(id),
                              dummy ? nullptr : &dictionary.hooks(id), maskOf(bitsOf(value)),
                              bits_});
    bits_ += bitsOf(value);
  }
}

std::optional<unsigned> Mapping::placeOf(ObjectId id) const {
  for (const Object& object : objects_) {
    if (object.entry != nullptr && object.entry->id == id) return object.shift;
  }
  return std::nullopt;
}

std::uint64_t Mapping::pack() const {
  std::uint64_t data = 0;
  for (const Object& object : objects_) {
    if (object.hooks->read) object.hooks->read(*object.entry);
    data |= (object.entry->number & object.mask) << object.shift;
  }
  return data;
}

void Mapping::unpack(std::uint64_t data, ObjectDictionary& dictionary) const {
  for (const Object& object : objects_) {
    if (object.entry == nullptr) continue;
    dictionary.writeNumber(*object.entry, (data >> object.shift) & object.mask, *object.hooks);
  }
}

}  // namespace cia402::sim
