// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/text.h"
#include "config/profile/parts.h"
#include "drive/profile/object_value.h"

namespace cia402::config {
const std::vector<std::string>& configurationSources() {
  static const std::vector<std::string> kSources = {
      "limits.lower",  "limits.upper",           "limits.velocity",      "limits.acceleration",
      "limits.jerk",   "limits.effort",          "sync_period.value",    "sync_period.exponent",
      "homing.method", "homing.search_velocity", "homing.zero_velocity", "homing.acceleration",
      "homing.offset", "quick_stop.hold",        "sync_period.ms",       "homing.timeout",
  };
  return kSources;
}

namespace {

// The object by name or index; its type from `type:` where the profile does not name it.
const ObjectSpec* readTarget(yaml::Section& section, const DriveProfile& profile,
                             NamedWrite& write) {
  const auto value = section.require("object", "name it by profile name or index");
  const auto type_value = section.get("type");
  const auto type_text = type_value ? type_value->text() : std::nullopt;
  if (type_text) {
    write.type = fieldbus::parseDataType(*type_text);
    if (!write.type) type_value->problem("unknown type `" + *type_text + "`");
  }
  const auto text = value ? value->text() : std::nullopt;
  if (!text) return nullptr;
  write.object = *text;
  const ObjectSpec* object = drive::findObject(profile, *text);
  if (object != nullptr) {
    if (!object->writable) value->problem("`" + *text + "` is read-only");
    return object;
  }
  if (!drive::objectId(profile, *text)) {
    value->problem(drive::sourceOf(profile) + " has no object `" + *text + "`" +
                   yaml::suggestion(*text, drive::objectNames(profile)));
  } else if (fieldbus::isAmbiguousIndex(*text)) {
    value->problem("`" + *text + "` names no object for sure, as YAML makes a decimal number of " +
                   "0x...: write " + fieldbus::unambiguousIndex(*text));
  } else if (!type_value) {
    value->problem(drive::sourceOf(profile) + " does not name " + *text +
                   "; add its type, for example `type: uint16`");
  } else if (write.type && fieldbus::sizeBits(*write.type) == 0) {
    type_value->problem("only numbers can be written");
  }
  return nullptr;
}

/// How the object holds its number.
struct Coding {
  DataType type;
  Encoding encoding;
};

void readRaw(const yaml::Value& value, Coding coding, NamedWrite& write) {
  const unsigned bits = fieldbus::sizeBits(coding.type);
  if (bits == 0) {
    value.problem("only numbers can be written");
    return;
  }
  const auto raw = value.integer(lowestOf(coding.type), highestOf(coding.type));
  if (!raw) return;
  const std::uint64_t pattern =
      static_cast<std::uint64_t>(*raw) & (~std::uint64_t{0} >> (64 - bits));
  if (drive::sendable(coding.type, coding.encoding, pattern)) {
    write.raw = raw;
  } else {
    value.problem(drive::notFinite(coding.type, pattern));
  }
}

/// The drive's own number: a whole one, or the float of an object that holds one.
void readDeviceNumber(const yaml::Value& value, Coding coding, NamedWrite& write) {
  if (!drive::holdsFloat(coding.type, coding.encoding)) {
    readRaw(value, coding, write);
    return;
  }
  const auto number = value.number();
  if (!number) return;
  const auto bits = drive::floatBits(coding.type, coding.encoding, *number);
  if (bits) write.raw = static_cast<std::int64_t>(*bits);
  if (!bits) value.problem("does not fit the float that the object holds");
}

/// In the words of the object, where it has any. @return true if it is in words
bool readWord(const yaml::Value& value, const ObjectSpec* object, NamedWrite& write) {
  const bool words = object != nullptr && !object->words.empty() && value.isScalar() &&
                     !yaml::parseInteger(value.node().Scalar());
  if (!words) return false;
  std::string known;
  for (const auto& [number, text] : object->words) {
    if (text == value.node().Scalar()) write.raw = number;
    append(known, std::to_string(number) + " (" + text + ")", ", ");
  }
  if (!write.raw) {
    value.problem("must be a number or words of " + object->name + ": " + known + "; not `" +
                  value.node().Scalar() + "`");
  }
  return true;
}

void readValue(yaml::Section& section, const DriveProfile& profile, const ObjectSpec* object,
               NamedWrite& write) {
  const auto value = section.get("value");
  const auto raw = section.get("raw");
  if (value && raw) section.problem("has both `value` and `raw`; keep one");
  if (!value && !raw && write.from.empty()) {
    section.problem("has no value: write `value`, `raw` or `from`");
  }
  const std::optional<DataType> type = object != nullptr ? object->type : write.type;
  if (!type) return;
  Coding coding{*type, Encoding::integer};
  if (object != nullptr) {
    coding.encoding = object->encoding;
  } else if (const auto id = drive::objectId(profile, write.object)) {
    coding.encoding = drive::encodingAt(profile, *id, *type);
  }
  const bool by_index = object == nullptr || write.object != object->name;
  if (raw && !readWord(*raw, object, write)) readRaw(*raw, coding, write);
  if (!value || readWord(*value, object, write)) return;
  if (!by_index && !object->from_eds) {
    const bool most = value->isScalar() && value->node().Scalar() == "most";
    write.value = most ? std::numeric_limits<double>::infinity() : value->number();
    return;
  }
  if (object != nullptr && !object->from_eds && coding.encoding == Encoding::integer &&
      value->isScalar() && !yaml::parseInteger(value->node().Scalar())) {
    value->problem("by index a value is the drive's own whole number; write `object: " +
                   object->name + "` to give it in SI units");
    return;
  }
  readDeviceNumber(*value, coding, write);
}

void readFrom(yaml::Section& section, const DriveProfile& profile, const ObjectSpec* object,
              WriteList kind, NamedWrite& write) {
  if (section.read("times", write.times, yaml::kPositive) && !section.has("from")) {
    section.problem("`times` multiplies what `from` names; there is no `from`");
  }
  const auto value = section.get("from");
  const auto text = value ? value->text() : std::nullopt;
  if (!text) return;
  write.from = *text;
  const auto& sources = configurationSources();
  if (std::find(sources.begin(), sources.end(), *text) != sources.end()) return;
  const ObjectSpec* source = profile.find(*text);
  if (source == nullptr) {
    value->problem("unknown source `" + *text + "`" + yaml::suggestion(*text, sources));
  } else if (kind == WriteList::boot) {
    value->problem("copying `" + *text +
                   "` is only possible in before_enable, entry_writes and "
                   "homing, when the drive can be asked");
  } else if (!source->readable) {
    value->problem("`" + *text + "` cannot be read");
  } else if (object != nullptr &&
             (source->type != object->type || source->encoding != object->encoding)) {
    value->problem("`" + *text + "` is not coded as `" + object->name + "` is");
  }
}

void checkRange(yaml::Section& section, const ObjectSpec* object, const NamedWrite& write) {
  if (object == nullptr || !write.raw || object->takes(static_cast<std::uint64_t>(*write.raw))) {
    return;
  }
  section.problem(object->name + " (" + fieldbus::toString(object->id) + ") takes " +
                  object->rangeText() + " in the drive's own numbers, not " +
                  std::to_string(*write.raw));
}

void readIfGiven(yaml::Section& section, NamedWrite& write) {
  const auto value = section.get("if_given");
  if (!value) return;
  const auto& sources = configurationSources();
  if (const auto index = value->oneOf(sources)) write.if_given = sources[*index];
}

bool isPositionLimit(const ObjectSpec* object, const NamedWrite& write) {
  return object != nullptr && object->quantity == Quantity::position &&
         (write.from == "limits.lower" || write.from == "limits.upper");
}

// A position limit that the drive gets before it has found its zero makes it move when enabled.
void readWhen(yaml::Section& section, const ObjectSpec* object, WriteList kind, NamedWrite& write) {
  const auto value = section.get("when");
  const bool limit = isPositionLimit(object, write);
  if (value) write.when_homed = value->oneOf({"homed"}).has_value();
  if (value && !(limit && kind == WriteList::boot)) {
    value->problem(
        "is for position objects with `from: limits.lower` or `limits.upper` in startup "
        "and `write`");
    write.when_homed = false;
  } else if (!value && limit) {
    section.problem(
        "limits the position in the drive's coordinates, which are those of the joint "
        "only once its zero is known; add `when: homed`" +
        std::string(kind == WriteList::boot ? "" : " and move it to startup"));
  }
}

}  // namespace

std::vector<NamedWrite> readWrites(const yaml::Value& list, const DriveProfile& profile,
                                   WriteList kind) {
  std::vector<NamedWrite> writes;
  for (const yaml::Value& value : list.list()) {
    NamedWrite write;
    yaml::Section section(value);
    const ObjectSpec* object = readTarget(section, profile, write);
    readFrom(section, profile, object, kind, write);
    readValue(section, profile, object, write);
    checkRange(section, object, write);
    readIfGiven(section, write);
    readWhen(section, object, kind, write);
    section.read("optional", write.optional);
    if (kind == WriteList::boot) section.read("before_pdos", write.before_pdos);
    section.finish();
    writes.push_back(write);
  }
  return writes;
}

}  // namespace cia402::config
