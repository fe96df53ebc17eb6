// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
// `errors` and `warnings`: what the codes of a family mean, and what follows from them.
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using drive::WarningText;

/// A table of codes. @param read (Section& of the entry, Text&) what else an entry has
template <typename Text, typename Read>
void readCodes(const yaml::Value& value, std::map<std::uint16_t, Text>& codes, Read&& read) {
  yaml::Section section(value);
  for (const auto& [key, entry] : section.entries()) {
    const auto code = yaml::parseInteger(key);
    if (!code || *code < 1 || *code > 0xFFFF) {
      entry.problem("an error code is a number from 0x0001 to 0xFFFF, not `" + key + "`");
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
    if (!codes.emplace(static_cast<std::uint16_t>(*code), text).second) {
      entry.problem("the code is given twice");
    }
  }
  section.finish();
}

}  // namespace

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
    readDuration(details, "wait", yaml::Range{0.0, 3600.0, false}, error.wait);
  });
}

void readWarnings(const yaml::Value& value, DriveProfile& profile) {
  if (!profile.has_warning_bit) {
    value.problem("the drive has no warning bit (`statusword: {7: none}`)");
  }
  readCodes(value, profile.warnings, [](yaml::Section& details, WarningText& warning) {
    const auto reaction = details.get("reaction");
    const auto index = reaction ? reaction->oneOf({"goes_on", "holds"}) : std::nullopt;
    if (index) warning.reaction = static_cast<WarningText::Reaction>(*index);
  });
}

}  // namespace cia402::config
