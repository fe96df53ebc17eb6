// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/jobs/object_address.h"

#include "drive/profile/object_value.h"

namespace cia402::bus {
namespace {

using drive::ObjectSpec;

/// "2003h:2 u32" in two; no type where the last word is none.
struct Words {
  std::string object;
  std::optional<fieldbus::DataType> type;
};

Words split(const std::string& text) {
  const std::size_t end = text.find_last_not_of(' ');
  const std::size_t blank = end == std::string::npos ? end : text.find_last_of(' ', end);
  if (blank == std::string::npos) return {text, {}};
  const auto type = fieldbus::parseTypeWord(text.substr(blank + 1, end - blank));
  if (!type) return {text, {}};
  return {text.substr(0, text.find_last_not_of(' ', blank) + 1), type};
}

std::string unknownObject(const drive::AxisConfig& axis, const std::string& text) {
  std::string why;
  if (axis.description != nullptr) {
    const auto found = axis.description->dictionary.find(text);
    if (!found) why = " (" + axis.description->file + ": " + found.error().message + ")";
  }
  return "\"" + text + "\" is neither an object of profile " + axis.profile->name +
         " nor an index such as 6041h:0" +
         (axis.profile->parameter_names.prefix.empty()
              ? ""
              : " nor a parameter such as " + axis.profile->parameter_names.prefix + "02.00") +
         why;
}

bool sameType(const ObjectSpec& spec, fieldbus::DataType type) {
  const bool both_float = type == fieldbus::DataType::real32 &&
                          drive::holdsFloat(spec.type, spec.encoding) &&
                          fieldbus::sizeBits(spec.type) == 32;
  return spec.type == type || both_float;
}

}  // namespace

Result<AddressedObject> findObject(const drive::AxisConfig& axis, const std::string& text) {
  const drive::DriveProfile& profile = *axis.profile;
  AddressedObject found;
  Words words{text, {}};
  const ObjectSpec* spec = profile.find(text);
  if (spec == nullptr) {
    words = split(text);
    spec = profile.find(words.object);
  }
  if (spec != nullptr) {
    found.id = spec->id;
  } else if (const auto id = drive::objectId(profile, words.object)) {
    found.id = *id;
    spec = profile.find(*id);
  } else {
    return Error{unknownObject(axis, words.object)};
  }
  if (spec == nullptr && fieldbus::isAmbiguousIndex(words.object)) {
    return Error{"\"" + words.object +
                 "\" names no object for sure, as YAML makes a decimal number "
                 "of 0x...: write " +
                 fieldbus::unambiguousIndex(words.object)};
  }
  const std::string of_maker = profile.parameter_names.nameOf(found.id);
  found.title = fieldbus::toString(found.id) + (of_maker.empty() ? "" : " " + of_maker) +
                (spec != nullptr ? " " + spec->name : "");
  if (spec != nullptr) found.spec = *spec;
  if (!words.type) return found;
  if (spec != nullptr && !sameType(*spec, *words.type)) {
    return Error{found.title + " is " + fieldbus::toString(spec->type) + " by profile " +
                 profile.name + ", not " + fieldbus::toString(*words.type) +
                 "; leave the type out"};
  }
  const drive::Encoding* encoding = profile.encodings.find(found.id);
  const bool in_range = encoding != nullptr && *encoding != drive::Encoding::integer;
  // One of another size, such as the sub-index that counts the others, is no float; bytes may be.
  const bool any_size = fieldbus::sizeBits(*words.type) == 0;
  const bool is_float =
      in_range && (any_size || *words.type == fieldbus::DataType::real32 ||
                   profile.encodingOf(found.id, *words.type) != drive::Encoding::integer);
  if (spec == nullptr && is_float) {
    return Error{found.title + " holds a float by profile " + profile.name +
                 " (encodings), whatever its type is; leave the type out"};
  }
  if (spec != nullptr) return found;
  found.spec.emplace();
  found.spec->id = found.id;
  found.spec->type = *words.type;
  if (*words.type == fieldbus::DataType::real32) found.spec->encoding = drive::Encoding::float32;
  return found;
}

}  // namespace cia402::bus
