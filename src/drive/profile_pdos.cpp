// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <set>

#include "profile_parts.h"

namespace cia402::drive {
namespace {

using canopen::PdoDirection;

const char* word(PdoDirection direction) {
  return direction == PdoDirection::rpdo ? "an RPDO" : "a TPDO";
}

void readTransmission(YamlSection& section, PdoLayout& pdo) {
  const auto value = section.get("transmission");
  const auto type = value ? value->integer(0, 255) : std::nullopt;
  if (!type) return;
  if (*type > 240 && *type < 254) {
    value->problem(
        "transmission types 241 to 253 are reserved or asked for by remote frames; use "
        "0 to 240 (with SYNC), 254 or 255 (on events)");
  }
  pdo.transmission = static_cast<std::uint8_t>(*type);
}

// A time in seconds as a 16-bit number of `unit`.
std::uint16_t readTime(YamlSection& section, const std::string& key, double unit) {
  double seconds = 0.0;
  section.read(key, seconds, Range{0.0, 65535.0 * unit, false});
  return static_cast<std::uint16_t>(std::lround(seconds / unit));
}

const ObjectSpec* readEntry(const YamlValue& value, const DriveProfile& profile,
                            PdoDirection direction) {
  const auto text = value.text();
  if (!text) return nullptr;
  const ObjectSpec* object = findObject(profile, *text);
  if (object == nullptr) {
    value.problem(sourceOf(profile) + " has no object `" + *text + "`" +
                  suggestion(*text, objectNames(profile)));
  } else if (!(direction == PdoDirection::rpdo ? object->rpdo : object->tpdo)) {
    value.problem("`" + object->name + "` cannot be mapped into " + word(direction) +
                  (object->from_eds ? " by " + profile.eds : " (see its `pdo:` in the profile)"));
  }
  return object;
}

void readEntries(const YamlValue& list, const DriveProfile& profile, PdoLayout& pdo,
                 std::map<std::string, std::string>& mapped) {
  unsigned bits = 0;
  std::string widths;
  for (const YamlValue& value : list.list()) {
    const ObjectSpec* object = readEntry(value, profile, pdo.direction);
    if (object == nullptr) continue;
    const auto [first, fresh] = mapped.emplace(object->name, list.path());
    if (!fresh) value.problem("`" + object->name + "` is mapped already, in " + first->second);
    const unsigned width = canopen::sizeBits(object->type);
    bits += width;
    widths += (widths.empty() ? "" : " + ") + std::to_string(width);
    pdo.objects.push_back(object->name);
  }
  if (bits > 64) {
    list.problem("is " + std::to_string(bits) + " bits long (" + widths +
                 "), a PDO holds 64; move an object into another PDO");
  }
  if (pdo.objects.size() > profile.max_pdo_entries) {
    list.problem("maps " + std::to_string(pdo.objects.size()) + " objects, the drive takes " +
                 std::to_string(profile.max_pdo_entries) + " in a PDO");
  }
}

// "rpdo1" .. "tpdo<max>".
std::optional<PdoLayout> parseName(const std::string& name, unsigned max_pdos) {
  PdoLayout pdo;
  const std::string kind = name.substr(0, 4);
  if (kind != "rpdo" && kind != "tpdo") return {};
  pdo.direction = kind == "rpdo" ? PdoDirection::rpdo : PdoDirection::tpdo;
  const auto number = parseInteger(name.substr(4));
  if (!number || *number < 1 || *number > static_cast<std::int64_t>(max_pdos)) return {};
  pdo.number = static_cast<unsigned>(*number);
  return pdo;
}

}  // namespace

std::vector<PdoLayout> readPdos(const YamlValue& value, const DriveProfile& profile) {
  std::vector<PdoLayout> pdos;
  std::map<std::string, std::string> mapped[2];  // per direction: object -> where
  YamlSection section(value);
  for (const auto& [name, entry] : section.entries()) {
    auto pdo = parseName(name, profile.max_pdos);
    if (!pdo) {
      const std::string most = std::to_string(profile.max_pdos);
      entry.problem("no such PDO; there are rpdo1 to rpdo" + most + " and tpdo1 to tpdo" + most);
      continue;
    }
    auto& seen = mapped[pdo->direction == PdoDirection::rpdo ? 0 : 1];
    if (!entry.isMap()) {
      readEntries(entry, profile, *pdo, seen);
    } else {
      YamlSection details(entry);
      if (const auto list = details.require("objects", "list the objects by profile name")) {
        readEntries(*list, profile, *pdo, seen);
      }
      readTransmission(details, *pdo);
      pdo->inhibit = readTime(details, "inhibit", 1e-4);
      pdo->event_timer = readTime(details, "event_timer", 1e-3);
      details.finish();
    }
    pdos.push_back(*pdo);
  }
  section.finish();
  return pdos;
}

}  // namespace cia402::drive
