// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/entry.h"

#include "canopen/eds/value.h"

namespace cia402::canopen {
namespace {

constexpr std::uint16_t kFirstDefinedType = 0x0020;  // records of CiA 301, then the device's own

std::string typeText(std::uint16_t code) { return "0x" + toString(ObjectId{code, 0}).substr(0, 4); }

bool isZero(const ObjectValue& value) {
  for (std::uint8_t byte : value) {
    if (byte != 0) return false;
  }
  return true;
}

std::optional<DataType> unsignedOf(std::uint64_t bits) {
  constexpr DataType kTypes[] = {DataType::uint8,  DataType::uint16, DataType::uint24,
                                 DataType::uint32, DataType::uint40, DataType::uint48,
                                 DataType::uint56, DataType::uint64};
  if (bits == 1) return DataType::boolean;
  if (bits == 0 || bits > 64 || bits % 8 != 0) return {};
  return kTypes[bits / 8 - 1];
}

}  // namespace

DictionaryEntry EdsEntryReader::read(const EdsSection& section, ObjectId id, ObjectCode code) {
  DictionaryEntry entry;
  entry.id = id;
  entry.line = section.line;
  const EdsKey* name = section.given("parametername");
  if (name == nullptr && id.subindex != 0) {
    problems_.warning(section.line, "[" + section.name + "] has no ParameterName");
  }
  entry.name = name != nullptr ? name->value : toString(id);
  if (const EdsKey* denotation = section.given("denotation")) entry.denotation = denotation->value;
  if (const EdsKey* kind = section.given("objecttype")) {
    const auto number = code == ObjectCode::variable ? keys_.numberOf(*kind, 0xFFFF) : std::nullopt;
    if (number && *number == 2) code = ObjectCode::domain;
  }
  entry.type = readType(section, code);
  entry.access = readAccess(section, entry.type);
  entry.mappable = keys_.flag(section, "pdomapping");
  entry.flags = static_cast<std::uint32_t>(keys_.numberOr0(section, "objflags", 0xFFFFFFFF));
  readValues(section, entry);
  readFiles(section, entry);
  return entry;
}

DataType EdsEntryReader::readType(const EdsSection& section, ObjectCode code) {
  const EdsKey* key = section.given("datatype");
  if (key == nullptr) {
    if (code == ObjectCode::domain) return DataType::domain;
    if (code == ObjectCode::deftype) return DataType::uint32;
    problems_.error(section.line, "[" + section.name + "] has no DataType; read as DOMAIN");
    return DataType::domain;
  }
  const auto number = keys_.numberOf(*key, 0xFFFF);
  if (!number) return DataType::domain;
  const auto type_code = static_cast<std::uint16_t>(*number);
  if (const auto type = dataTypeOfCode(type_code)) return *type;
  return definedType(*key, type_code);
}

// A type that the file defines itself: a DEFTYPE says its type or its length in bits; some editors
// write a DEFSTRUCT whose sub-index 1 holds the number of the type it is made of.
DataType EdsEntryReader::definedType(const EdsKey& key, std::uint16_t code) {
  const auto definition = sections_.objects().find(code);
  const bool is_defined = definition != sections_.objects().end();
  const EdsSections::SubSections* subs = sections_.subSectionsOf(code);
  if (code >= kFirstDefinedType && is_defined) {
    const EdsSection* section = definition->second;
    const EdsKey* base = section->given("datatype");
    if (subs != nullptr) {
      const auto first = subs->find(1);
      base = first != subs->end() ? first->second->given("defaultvalue") : base;
    }
    const auto base_code = base != nullptr ? parseEdsNumber(base->value) : std::nullopt;
    if (base_code && base_code->magnitude < kFirstDefinedType) {
      const auto type = dataTypeOfCode(static_cast<std::uint16_t>(base_code->magnitude));
      const EdsKey* bits = section->given("defaultvalue");
      const auto length = bits != nullptr ? parseEdsNumber(bits->value) : std::nullopt;
      const auto by_length = length ? unsignedOf(length->magnitude) : std::nullopt;
      // DataType=7 with DefaultValue=16: the length of the type, itself an UNSIGNED32.
      if (subs == nullptr && type == DataType::uint32 && by_length) return *by_length;
      if (type) return *type;
    }
  }
  problems_.error(key.line,
                  "DataType=" + key.value +
                      (is_defined ? ": [" + definition->second->name + "] does not say its type"
                                  : " is unknown, and there is no section [" +
                                        typeText(code).substr(2) + "] for it") +
                      "; read as DOMAIN, bytes of any length");
  return DataType::domain;
}

Access EdsEntryReader::readAccess(const EdsSection& section, DataType type) {
  const EdsKey* key = section.given("accesstype");
  if (key == nullptr) {
    if (type != DataType::domain) {
      problems_.error(section.line, "[" + section.name + "] has no AccessType; read as rw");
    }
    return Access::rw;
  }
  const std::string word = nameKey(key->value);
  for (const Access access :
       {Access::ro, Access::wo, Access::rw, Access::rwr, Access::rww, Access::constant}) {
    if (word == toString(access)) return access;
  }
  problems_.error(key->line, "AccessType=" + quoteEds(key->value) +
                                 " is none of ro, wo, rw, rwr, rww, const; read as rw");
  return Access::rw;
}

std::optional<ObjectValue> EdsEntryReader::readValue(const EdsKey* key, DataType type,
                                                     bool* adds_node_id) {
  if (key == nullptr) return {};
  EdsValue value = parseEdsValue(key->value, type, node_id_);
  if (!value.error.empty()) {
    problems_.error(key->line, key->name + ": " + value.error + "; it is left out");
  } else if (!value.note.empty()) {
    problems_.warning(key->line, key->name + ": " + value.note);
  }
  if (adds_node_id != nullptr) *adds_node_id = value.adds_node_id;
  return std::move(value.bytes);
}

void EdsEntryReader::readValues(const EdsSection& section, DictionaryEntry& entry) {
  if (sizeBits(entry.type) != 0) {
    entry.low = readValue(section.given("lowlimit"), entry.type);
    entry.high = readValue(section.given("highlimit"), entry.type);
  }
  entry.default_value =
      readValue(section.given("defaultvalue"), entry.type, &entry.default_adds_node_id);
  entry.value = readValue(section.given("parametervalue"), entry.type);
  checkLimits(section, entry);
}

void EdsEntryReader::checkLimits(const EdsSection& section, DictionaryEntry& entry) {
  const auto drop = [&](const char* why) {
    problems_.warning(section.find("lowlimit")->line, why);
    entry.low.reset();
    entry.high.reset();
  };
  if (entry.low && entry.high) {
    if (compareValues(entry.type, *entry.low, *entry.high) > 0) {
      drop("LowLimit is above HighLimit; both are left out");
    } else if (isZero(*entry.low) && isZero(*entry.high) && isWritable(entry.access)) {
      drop("LowLimit and HighLimit are 0, which would allow no other value; both are left out");
    }
  }
  const auto check = [&](const char* key, const std::optional<ObjectValue>& value) {
    if (!value) return;
    const bool low = entry.low && compareValues(entry.type, *value, *entry.low) < 0;
    const bool high = entry.high && compareValues(entry.type, *value, *entry.high) > 0;
    if (!low && !high) return;
    problems_.warning(section.find(key)->line,
                      section.find(key)->name + " " + describeValue(entry.type, *value) + " is " +
                          (low ? "below LowLimit " : "above HighLimit ") +
                          describeValue(entry.type, low ? *entry.low : *entry.high));
  };
  check("defaultvalue", entry.default_value);
  check("parametervalue", entry.value);
}

void EdsEntryReader::readFiles(const EdsSection& section, DictionaryEntry& entry) {
  const EdsKey* upload = section.given("uploadfile");
  const EdsKey* download = section.given("downloadfile");
  if (upload != nullptr) entry.upload_file = upload->value;
  if (download != nullptr) entry.download_file = download->value;
  for (const EdsKey* file : {upload, download}) {
    if (file != nullptr && entry.type != DataType::domain) {
      problems_.warning(file->line, file->name + " makes sense for a DOMAIN only, not for " +
                                        toString(entry.type));
    }
  }
}

}  // namespace cia402::canopen
