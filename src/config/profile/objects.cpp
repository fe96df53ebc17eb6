// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <map>

#include "config/profile/parts.h"
#include "drive/profile/object_value.h"

namespace cia402::config {
namespace {

void readType(yaml::Section& section, ObjectSpec& object) {
  const auto value = section.require("type", "write for example `type: uint16`");
  const auto text = value ? value->text() : std::nullopt;
  if (!text) return;
  if (const auto type = fieldbus::parseDataType(*text)) {
    object.type = *type;
    return;
  }
  value->problem("unknown type" +
                 yaml::suggestion(*text, {"boolean", "int8", "int16", "int32", "int64", "uint8",
                                          "uint16", "uint32", "uint64", "real32", "visible_string",
                                          "octet_string", "domain"}));
}

void readEncoding(yaml::Section& section, const DriveProfile& profile, ObjectSpec& object) {
  object.encoding = drive::encodingAt(profile, object.id, object.type);
  const auto value = section.get("encoding");
  const auto encoding = value ? readEncodingWord(*value) : std::nullopt;
  if (!encoding) return;
  object.encoding = *encoding;
  const unsigned bits = fieldbus::sizeBits(object.type);
  const char* const type = fieldbus::toString(object.type);
  if (object.encoding == Encoding::float32 && bits != 32) {
    value->problem(std::string("float32 needs a type of 32 bits, not ") + type);
  } else if (object.encoding > Encoding::float32 && bits != 16) {
    value->problem(std::string("floats of 16 bits need a type as wide, not ") + type);
  } else if (object.encoding == Encoding::integer && object.type == DataType::real32) {
    value->problem("real32 is a float, not an integer; leave `encoding` out");
  }
}

void readAccess(yaml::Section& section, ObjectSpec& object) {
  if (const auto value = section.get("access")) {
    const std::size_t index = value->oneOf({"rw", "ro", "wo", "const"}).value_or(0);
    object.readable = index != 2;
    object.writable = index == 0 || index == 2;
  }
  if (const auto doubt = section.get("doubt")) object.doubt = doubt->text().value_or("");
  const auto value = section.get("pdo");
  const auto index = value ? value->oneOf({"none", "rpdo", "tpdo", "both"}) : std::nullopt;
  if (!index) return;
  object.rpdo = *index == 1 || *index == 3;
  object.tpdo = *index == 2 || *index == 3;
  if (*index == 0) return;
  const unsigned bits = fieldbus::sizeBits(object.type);
  if (bits == 0) {
    value->problem(std::string("a ") + fieldbus::toString(object.type) +
                   " has no fixed length and cannot be mapped into a PDO");
  }
  if (object.rpdo && !object.writable) value->problem("a read-only object cannot be in an RPDO");
  if (object.tpdo && !object.readable) value->problem("a write-only object cannot be in a TPDO");
}

void readTransmission(yaml::Section& section, ObjectSpec& object) {
  const auto value = section.get("transmission");
  const auto type = value ? value->integer(0, 255) : std::nullopt;
  if (!type) return;
  if (!object.rpdo) return value->problem("is for objects that can be in an RPDO");
  if (*type > 240 && *type < 254) {
    return value->problem("an RPDO has a type from 0 to 240 (with SYNC), 254 or 255 (on events)");
  }
  object.transmission = static_cast<std::uint8_t>(*type);
}

void readMeaning(yaml::Section& section, ObjectSpec& object, const DriveProfile& profile) {
  if (const auto value = section.get("quantity")) {
    object.quantity = readQuantity(*value).value_or(Quantity::none);
  }
  const auto factor = section.get("factor");
  const auto number = factor ? factor->number() : std::nullopt;
  if (number && *number == 0.0) factor->problem("must not be 0");
  if (number && *number != 0.0) object.factor = *number;
  const auto unit = section.get("unit");
  if (object.quantity == Quantity::none) {
    if (unit) unit->problem("a unit needs a `quantity`");
    return;
  }
  if (unit) object.unit = readUnit(*unit, object.quantity);
  if (fieldbus::sizeBits(object.type) == 0 || object.type == DataType::boolean) {
    section.problem(std::string("a ") + fieldbus::toString(object.type) + " measures no quantity");
  }
  const Quantity counted =
      object.quantity == Quantity::distance ? Quantity::position : object.quantity;
  if (!unit && profile.units.count(counted) == 0) {
    section.problem("`units` has no entry for what it measures, and it has no `unit` of its own");
  }
}

void readRange(yaml::Section& section, ObjectSpec& object) {
  const auto value = section.get("range");
  if (!value) return;
  const std::vector<yaml::Value> ends = value->list();
  if (ends.size() != 2) {
    value->problem("is [lowest, highest], in the drive's own numbers");
    return;
  }
  if (fieldbus::sizeBits(object.type) == 0) {
    value->problem("only numbers have a range");
    return;
  }
  const auto low = ends[0].number(), high = ends[1].number();
  if (!low || !high) return;
  const bool integer = !drive::holdsFloat(object.type, object.encoding);
  const bool fits = !integer || (*low >= static_cast<double>(lowestOf(object.type)) &&
                                 *high <= static_cast<double>(highestOf(object.type)));
  if (!fits) value->problem(std::string("does not fit ") + fieldbus::toString(object.type));
  if (*low > *high) value->problem("its lowest number is above its highest");
  if (fits && *low <= *high) object.range = ObjectSpec::Range{*low, *high};
}

void readWords(yaml::Section& section, ObjectSpec& object) {
  const auto value = section.get("words");
  if (!value) return;
  const bool whole =
      fieldbus::sizeBits(object.type) != 0 && !drive::holdsFloat(object.type, object.encoding);
  if (!whole) return value->problem("are for objects that hold a whole number");
  object.words = readNumberTexts(*value);
  for (const auto& [number, text] : object.words) {
    if (number >= lowestOf(object.type) && number <= highestOf(object.type)) continue;
    value->problem(std::to_string(number) + " does not fit " + fieldbus::toString(object.type));
  }
}

void readFieldsName(yaml::Section& section, const DriveProfile& profile, ObjectSpec& object) {
  const auto value = section.get("fields");
  const auto name = value ? value->text() : std::nullopt;
  if (!name) return;
  const auto known = profile.bit_fields.find(*name);
  if (known == profile.bit_fields.end()) {
    value->problem("`bit_fields` has no `" + *name + "`");
    return;
  }
  const unsigned bits = fieldbus::sizeBits(object.type);
  for (const drive::BitField& field : known->second) {
    if (field.high >= bits) {
      value->problem("`" + field.name + "` of `" + *name + "` has bit " +
                     std::to_string(field.high) + ", which " + fieldbus::toString(object.type) +
                     " has not");
    }
  }
  object.fields = *name;
}

void readWidest(yaml::Section& section, ObjectSpec& object) {
  const auto value = section.get("widest");
  const auto bits = value ? value->oneOf({"16", "32"}) : std::nullopt;
  if (!bits) return;
  object.widest = *bits == 0 ? 16 : 32;
  const unsigned own = fieldbus::sizeBits(object.type);
  const bool integer = object.encoding == Encoding::integer && object.type != DataType::boolean;
  if (!integer || !object.readable || own == 0 || own >= object.widest) {
    value->problem("is for whole numbers that can be read and have a narrower type");
  }
}

ObjectSpec readObject(const std::string& name, const yaml::Value& value,
                      const DriveProfile& profile) {
  ObjectSpec object;
  object.name = name;
  yaml::Section section(value);
  const auto id = section.require("object", "write index and sub-index, for example \"6041:00\"");
  const auto text = id ? id->text() : std::nullopt;
  if (text) {
    const auto parsed = fieldbus::parseObjectId(*text);
    if (!parsed) id->problem("`" + *text + "` is no object; write for example \"6041:00\"");
    if (parsed) object.id = *parsed;
  }
  readType(section, object);
  readEncoding(section, profile, object);
  readAccess(section, object);
  readTransmission(section, object);
  readMeaning(section, object, profile);
  readRange(section, object);
  readWords(section, object);
  readFieldsName(section, profile, object);
  section.read("when_disabled", object.when_disabled);
  readWidest(section, object);
  section.read("high", object.high);
  section.finish();
  return object;
}

/// Both halves of a number of 64 bits are shown, none is written by itself.
void checkHigh(const ObjectSpec& object, const yaml::Value& entry, const DriveProfile& profile) {
  const ObjectSpec* high = profile.find(object.high);
  const auto fits = [](const ObjectSpec& half) {
    return half.readable && !half.writable && half.encoding == Encoding::integer &&
           fieldbus::sizeBits(half.type) == 32;
  };
  if (high == nullptr || !fits(object) || !fits(*high)) {
    entry.problem("`high` joins two read-only objects of 32 bits; `" + object.high +
                  "` is to be one of this list");
  }
}

}  // namespace

std::int64_t lowestOf(DataType type) {
  const unsigned bits = fieldbus::sizeBits(type);
  return fieldbus::isSigned(type) ? -(std::int64_t{1} << (bits - 2)) * 2 : 0;
}

std::int64_t highestOf(DataType type) {
  const unsigned bits = fieldbus::sizeBits(type) - (fieldbus::isSigned(type) ? 1 : 0);
  if (bits >= 63) return std::numeric_limits<std::int64_t>::max();
  return (std::int64_t{1} << bits) - 1;
}

drive::NumberTexts readNumberTexts(const yaml::Value& value) {
  drive::NumberTexts texts;
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto number = yaml::parseInteger(key);
    const auto text = entry.text();
    if (!number) entry.problem("`" + key + "` is no whole number");
    if (number && text) texts[*number] = *text;
  }
  section.finish();
  return texts;
}

std::optional<Encoding> readEncodingWord(const yaml::Value& value) {
  const auto index = value.oneOf(
      {"integer", "float32", "bfloat16", "float32_by_65535_unsigned", "float32_by_65535_signed"});
  if (!index) return {};
  return static_cast<Encoding>(*index);
}

void readEncodings(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto range = drive::parseObjectRange(key);
    if (!range) {
      entry.problem("`" + key +
                    "` is no range of objects; write for example \"2004\", "
                    "\"2002:01-0C\" or \"2004-2006\"");
    }
    const auto encoding = readEncodingWord(entry);
    if (range && encoding) profile.encodings.add(*range, *encoding);
  }
  section.finish();
}

void readObjects(const yaml::Value& value, DriveProfile& profile) {
  yaml::Section section(value);
  std::map<ObjectId, std::string> names;
  std::vector<std::pair<ObjectSpec, yaml::Value>> highs;
  for (const auto& [name, entry] : section.entries()) {
    const ObjectSpec object = readObject(name, entry, profile);
    if (fieldbus::parseObjectId(name)) {
      entry.problem("the name reads like an index; choose another one");
    }
    const auto [first, fresh] = names.emplace(object.id, name);
    if (!fresh && object.id.index != 0) {
      entry.problem(fieldbus::toString(object.id) + " has the name `" + first->second +
                    "` already");
    }
    if (profile.find(name) == nullptr) profile.objects.push_back(object);
    if (!object.high.empty()) highs.emplace_back(object, entry);
  }
  for (const auto& [object, entry] : highs) checkHigh(object, entry, profile);
  section.finish();
}

}  // namespace cia402::config
