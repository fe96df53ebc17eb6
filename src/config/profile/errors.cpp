// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `errors` and `warnings`: what the codes of a family mean, and what follows from them.
#include "common/text.h"
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using drive::WarningText;

/// A table of codes. @param read (Section& of the entry, Text&) what else an entry has
template <typename Code, typename Text, typename Read>
void readCodes(const yaml::Value& value, std::map<Code, Text>& codes, Read&& read) {
  constexpr std::int64_t kHighest = sizeof(Code) == 2 ? 0xFFFF : 0xFFFFFFFF;
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto code = yaml::parseInteger(key);
    if (!code || *code < 1 || *code > kHighest) {
      entry.problem("an error code is a number from 0x0001 to " +
                    hexText(static_cast<std::uint64_t>(kHighest), 4) + ", not `" + key + "`");
      continue;
    }
    Text text;
    if (entry.isMap()) {
      yaml::Section details(entry);
      details.require("text", "say in words what the code means");
      details.read("text", text.text);
      details.read("cause", text.cause);
      details.read("remedy", text.remedy);
      read(details, text);
      details.finish();
    } else {
      text.text = entry.text().value_or("");
    }
    if (!codes.emplace(static_cast<Code>(*code), text).second) {
      entry.problem("the code is given twice");
    }
  }
  section.finish();
}

}  // namespace

std::optional<ErrorText::Reaction> readFaultReaction(yaml::Section& section, const char* key) {
  const auto word = section.get(key);
  const auto index = word ? word->oneOf({"brakes", "coasts"}) : std::nullopt;
  if (!index) return {};
  return static_cast<ErrorText::Reaction>(*index);
}

void readErrors(const yaml::Value& value, DriveProfile& profile) {
  readCodes(value, profile.errors, [](yaml::Section& details, ErrorText& error) {
    using Missing = ErrorText::Missing;
    if (const auto missing = details.get("missing")) {
      const bool rpdo = missing->oneOf({"sync", "rpdo"}).value_or(0) == 1;
      error.missing = rpdo ? Missing::outputs : Missing::cycle;
    }
    if (const auto reset = details.get("reset")) {
      const auto index = reset->oneOf({"by_bit", "by_itself", "power_cycle"});
      if (index) error.reset = static_cast<ErrorText::Reset>(*index);
    }
    error.reaction = readFaultReaction(details, "reaction");
    readDuration(details, "wait", yaml::Range{0.0, 3600.0, false}, error.wait);
    details.read("loses_zero", error.loses_zero);
  });
}

void readErrorDetails(const yaml::Value& value, DriveProfile& profile) {
  drive::ErrorDetails& details = profile.error_details;
  yaml::Section section(value);
  const auto name = section.require("object", "what the drive tells besides its error code");
  const ObjectSpec* object = name ? readSetting(*name, profile) : nullptr;
  if (object != nullptr) details.object = object->name;
  if (const auto bits = section.get("bits")) {
    const auto mask = bits->integer(1, 0xFFFFFFFF);
    if (mask) details.bits = static_cast<std::uint64_t>(*mask);
  }
  section.read("prefix", details.prefix);
  section.readInteger("digits", details.digits, 1, 8);
  if (const auto codes = section.get("codes")) {
    readCodes(*codes, details.codes, [](yaml::Section&, ErrorText&) {});
  }
  section.finish();
}

void readAlarmMemory(const yaml::Value& value, DriveProfile& profile) {
  drive::AlarmMemory& memory = profile.alarm_memory;
  yaml::Section section(value);
  const auto object = [&](const char* key, const char* what) {
    const auto name = section.require(key, what);
    return name ? readSetting(*name, profile) : nullptr;
  };
  const ObjectSpec* select = object("select", "the object that selects one, 0 the newest");
  const ObjectSpec* code = object("code", "the object that shows its code");
  if (select != nullptr && !select->writable) section.problem("`select` cannot be written");
  if (select != nullptr) memory.select = select->name;
  if (code != nullptr) memory.code = code->name;
  if (const auto name = section.get("time")) {
    const ObjectSpec* time = readSetting(*name, profile);
    if (time != nullptr && time->quantity != Quantity::time) {
      name->problem("`" + time->name + "` does not measure a time; see its `quantity`");
    } else if (time != nullptr) {
      memory.time = time->name;
    }
  }
  section.require("entries", "how many there are");
  section.readInteger("entries", memory.entries, 1, 100);
  section.finish();
}

void readFaultMemory(const yaml::Value& value, DriveProfile& profile) {
  drive::FaultObjects& memory = profile.fault_memory;
  yaml::Section section(value);
  int base = 0;
  section.readInteger("base", base, 0, 0xFFFF);
  memory.base = static_cast<std::uint16_t>(base);
  const auto faults = section.require("faults", "the objects of each, the newest first");
  for (const yaml::Value& item : faults ? faults->list() : std::vector<yaml::Value>()) {
    yaml::Section of_fault(item);
    drive::FaultObject fault;
    const auto code = of_fault.require("code", "the object that holds its code");
    const ObjectSpec* object = code ? readSetting(*code, profile) : nullptr;
    if (object != nullptr) fault.code = object->name;
    if (const auto with = of_fault.get("with")) fault.with = readSettings(*with, profile);
    of_fault.finish();
    if (object != nullptr) memory.faults.push_back(fault);
  }
  section.finish();
}

void readWarnings(const yaml::Value& value, DriveProfile& profile) {
  if (!profile.has_warning_bit) {
    value.problem("the drive has no warning bit (`statusword: {7: none}`)");
  }
  readCodes(value, profile.warnings, [](yaml::Section& details, WarningText& warning) {
    const auto reaction = details.get("reaction");
    const auto index = reaction ? reaction->oneOf({"goes_on", "holds", "stops"}) : std::nullopt;
    if (index) warning.reaction = static_cast<WarningText::Reaction>(*index);
  });
}

}  // namespace cia402::config
