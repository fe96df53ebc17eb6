// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <map>
#include <set>

#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using fieldbus::Access;
using fieldbus::DictionaryEntry;

// How often each name occurs: an entry's own name only counts where no other one has it.
std::map<std::string, int> countNames(const fieldbus::ObjectDictionary& dictionary) {
  std::map<std::string, int> counts;
  for (const auto& [index, object] : dictionary.objects()) {
    for (const auto& [subindex, entry] : object.entries) {
      const std::string full = fieldbus::nameKey(dictionary.fullName(entry));
      const std::string own = fieldbus::nameKey(entry.name);
      ++counts[full];
      if (own != full) ++counts[own];
      if (!entry.denotation.empty()) ++counts[fieldbus::nameKey(entry.denotation)];
    }
  }
  return counts;
}

ObjectSpec specOf(const DriveProfile& profile, const DictionaryEntry& entry) {
  ObjectSpec spec;
  spec.id = entry.id;
  spec.type = entry.type;
  spec.encoding = drive::encodingAt(profile, entry.id, entry.type);
  spec.readable = fieldbus::isReadable(entry.access);
  spec.writable = fieldbus::isWritable(entry.access);
  const bool mappable = entry.mappable && fieldbus::sizeBits(entry.type) != 0;
  spec.rpdo = mappable && spec.writable && entry.access != Access::rwr;
  spec.tpdo = mappable && spec.readable && entry.access != Access::rww;
  spec.from_eds = true;
  return spec;
}

std::string place(const fieldbus::DeviceDescription& eds, const DictionaryEntry& entry) {
  return eds.file + (entry.line != 0 ? ":" + std::to_string(entry.line) : "");
}

std::string contradiction(const DriveProfile& profile, const ObjectSpec& object,
                          const fieldbus::DeviceDescription& eds, const DictionaryEntry& entry) {
  return fieldbus::toString(object.id) + " is " + fieldbus::toString(object.type) + " in profile " +
         profile.name + " (" + object.name + "), but " + fieldbus::toString(entry.type) + " in " +
         place(eds, entry) + " (" + entry.name + ")";
}

bool sameBits(const ObjectSpec& object, const DictionaryEntry& entry) {
  return fieldbus::sizeBits(object.type) == fieldbus::sizeBits(entry.type);
}

// A float in an integer object may be called either.
bool sameKind(const ObjectSpec& object, const DictionaryEntry& entry) {
  const bool real = object.encoding == Encoding::float32;
  if (real && entry.type == DataType::real32) return true;
  return object.type == entry.type || real;
}

void compareTypes(const DriveProfile& profile, const fieldbus::DeviceDescription& eds,
                  EdsContradictions& found) {
  std::string missing;
  int missing_count = 0;
  for (const ObjectSpec& object : profile.objects) {
    if (object.from_eds) continue;
    const DictionaryEntry* entry = eds.dictionary.find(object.id);
    if (entry == nullptr) {
      missing += (missing_count++ == 0 ? "" : ", ") + object.name;
    } else if (!sameBits(object, *entry)) {
      found.problems.push_back(contradiction(profile, object, eds, *entry) +
                               "; correct the one that is wrong by the drive's manual");
    } else if (!sameKind(object, *entry)) {
      found.warnings.push_back(contradiction(profile, object, eds, *entry) +
                               "; the profile is followed");
    }
  }
  if (missing_count == 0) return;
  found.warnings.push_back(eds.file + " does not have " + std::to_string(missing_count) +
                           (missing_count == 1 ? " object" : " objects") + " of profile " +
                           profile.name + ": " + missing);
}

void compareMapping(const DriveProfile& profile, const std::vector<canopen::PdoLayout>& pdos,
                    const fieldbus::DeviceDescription& eds, EdsContradictions& found) {
  for (const canopen::PdoLayout& pdo : pdos) {
    const bool receive = pdo.direction == canopen::PdoDirection::rpdo;
    for (const std::string& name : pdo.objects) {
      const ObjectSpec* object = profile.find(name);
      const DictionaryEntry* entry =
          object != nullptr && !object->from_eds ? eds.dictionary.find(object->id) : nullptr;
      if (entry == nullptr) continue;
      const ObjectSpec by_eds = specOf(profile, *entry);
      if (receive ? by_eds.rpdo : by_eds.tpdo) continue;
      found.warnings.push_back(name + " is mapped into " + (receive ? "RPDO " : "TPDO ") +
                               std::to_string(pdo.number) + " by profile " + profile.name +
                               ", but " + place(eds, *entry) + " says that it cannot be (" +
                               toString(entry->access) +
                               ", PDOMapping=" + (entry->mappable ? "1" : "0") + ")");
    }
  }
}

}  // namespace

DriveProfile withEds(DriveProfile profile, const fieldbus::DeviceDescription& eds) {
  profile.eds = eds.file;
  const std::map<std::string, int> counts = countNames(eds.dictionary);
  std::map<ObjectId, std::size_t> known;
  std::set<std::string> names;
  for (std::size_t i = 0; i < profile.objects.size(); ++i) {
    known.emplace(profile.objects[i].id, i);
    names.insert(profile.objects[i].name);
  }
  for (const auto& [index, object] : eds.dictionary.objects()) {
    if (index < 0x1000) continue;  // data types, no objects
    for (const auto& [subindex, entry] : object.entries) {
      const auto [place, fresh] = known.emplace(entry.id, profile.objects.size());
      const std::string full = eds.dictionary.fullName(entry);
      if (fresh) {
        profile.objects.push_back(specOf(profile, entry));
        // An index in words would hide the object that really has it.
        const bool usable = names.count(full) == 0 && !fieldbus::parseObjectId(full);
        profile.objects.back().name = usable ? full : full + " (" + toString(entry.id) + ")";
        names.insert(profile.objects.back().name);
      }
      ObjectSpec& spec = profile.objects[place->second];
      for (const std::string& name : {full, entry.name, entry.denotation}) {
        const std::string key = fieldbus::nameKey(name);
        const auto count = counts.find(key);
        if (count == counts.end() || count->second != 1 || fieldbus::parseObjectId(key)) continue;
        spec.eds_keys.push_back(key);
      }
    }
  }
  return profile;
}

EdsContradictions compareWithEds(const DriveProfile& profile, const canopen::DeviceConfig& device,
                                 const canopen::PdoSet& pdos,
                                 const fieldbus::DeviceDescription& eds) {
  EdsContradictions found;
  compareTypes(profile, eds, found);
  compareMapping(profile, pdos.pdos, eds, found);
  const auto vendor = device.eds->vendor_number.value_or(0);
  const auto expected = device.profile->vendor_id;
  if (expected && vendor != 0 && vendor != *expected) {
    found.warnings.push_back(eds.file + " is of vendor " + std::to_string(vendor) +
                             ", but profile " + profile.name + " of vendor " +
                             std::to_string(*expected) + "; is it the right file?");
  }
  return found;
}

}  // namespace cia402::config
