// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <set>

#include "common/text.h"
#include "config/profile/parts.h"

namespace cia402::config {
namespace {

using canopen::CobIdSpec;
using canopen::PdoDirection;
using canopen::PdoLayout;

const char* word(PdoDirection direction) {
  return direction == PdoDirection::rpdo ? "an RPDO" : "a TPDO";
}

void readTransmission(yaml::Section& section, const DriveProfile& profile,
                      const canopen::DeviceProfile& device, PdoLayout& pdo) {
  const auto value = section.get("transmission");
  const auto type = value ? value->integer(0, 255) : std::nullopt;
  if (!type) return;
  const bool requested = canopen::isRequested(static_cast<std::uint8_t>(*type));
  if (requested && pdo.direction == PdoDirection::rpdo) {
    value->problem("types 252 and 253 are asked for by remote frames: only TPDOs can be");
  } else if (requested && !device.remote_requests) {
    value->problem("this drive answers no remote frames (" + drive::sourceOf(profile) +
                   ", `remote_requests`): use 0 to 240 (with SYNC), 254 or 255 (on events)");
  } else if (*type > 240 && *type < 254 && !requested) {
    value->problem(
        "transmission types 241 to 251 are reserved; use 0 to 240 (with SYNC), 252 or 253 (TPDO, "
        "asked for by remote frames), 254 or 255 (on events)");
  }
  pdo.transmission = static_cast<std::uint8_t>(*type);
}

// A time in seconds as a 16-bit number of `unit`.
std::uint16_t readTime(yaml::Section& section, const std::string& key, double unit) {
  double seconds = 0.0;
  section.read(key, seconds, yaml::Range{0.0, 65535.0 * unit, false});
  return static_cast<std::uint16_t>(std::lround(seconds / unit));
}

// Such a TPDO would never come.
void checkTimer(yaml::Section& section, const DriveProfile& profile,
                const canopen::DeviceProfile& device, const PdoLayout& pdo) {
  const bool tpdo = pdo.direction == PdoDirection::tpdo;
  if (!device.type_255_by_timer || !tpdo || pdo.transmission != 255 || pdo.event_timer != 0) {
    return;
  }
  section.get("transmission")
      ->problem("255 without `event_timer` is never sent by this drive (" +
                drive::sourceOf(profile) +
                ", `type_255_by_timer`): give it an `event_timer`, or take 254 (on a change)");
}

// What the drive takes at once, or at another SYNC than the others, may not be what it counts on.
void checkDemands(const yaml::Value& pdo, const DriveProfile& profile, const PdoLayout& layout) {
  for (const std::string& name : layout.objects) {
    const ObjectSpec* object = profile.find(name);
    if (layout.direction != PdoDirection::rpdo || !object->transmission) continue;
    const unsigned demanded = *object->transmission;
    if (demanded == layout.transmission) continue;
    pdo.problem("has transmission type " + std::to_string(layout.transmission) + ", but `" + name +
                "` must come with type " + std::to_string(demanded) + " (its `transmission` in " +
                drive::sourceOf(profile) + "): give that to the PDO, or move the object");
  }
}

// A COB-ID of a PDO: "0x1A5", "$NODEID+0x1A0", or `drive` for the drive's own.
void readCobId(yaml::Section& section, PdoLayout& pdo) {
  const auto value = section.get("cob_id");
  const auto text = value ? value->text() : std::nullopt;
  if (!text) return;
  const std::string relative = "$NODEID+";
  if (*text == "drive") {
    pdo.cob_id.kind = CobIdSpec::Kind::drive;
    return;
  }
  const bool by_node = text->compare(0, relative.size(), relative) == 0;
  const auto number = yaml::parseInteger(by_node ? text->substr(relative.size()) : *text);
  const bool known = number && *number >= (by_node ? 0x180 : 0x181) && *number <= 0x6DF;
  if (!known) {
    value->problem("must be `drive`, a number from 0x181 to 0x57F or 0x680 to 0x6DF, or such as " +
                   std::string("\"$NODEID+0x180\", not `") + *text + "`");
    return;
  }
  pdo.cob_id.kind = by_node ? CobIdSpec::Kind::node_id : CobIdSpec::Kind::absolute;
  pdo.cob_id.value = static_cast<std::uint16_t>(*number);
}

void readSyncStart(yaml::Section& section, const DriveProfile& profile,
                   const canopen::DeviceProfile& device, PdoLayout& pdo) {
  const auto value = section.get("sync_start");
  if (!value) return;
  const bool cyclic = pdo.direction == PdoDirection::tpdo && canopen::isCyclic(pdo.transmission);
  if (!device.sync_starts) {
    value->problem("this drive has no SYNC start values (" + drive::sourceOf(profile) +
                   ", `sync_starts`)");
  } else if (!cyclic) {
    value->problem("is for TPDOs of transmission types 1 to 240");
  }
  const auto start = value->integer(0, 240);
  if (start) pdo.sync_start = static_cast<std::uint8_t>(*start);
}

const ObjectSpec* readEntry(const yaml::Value& value, const DriveProfile& profile,
                            PdoDirection direction) {
  const auto text = value.text();
  if (!text) return nullptr;
  const ObjectSpec* object = drive::findObject(profile, *text);
  if (object == nullptr) {
    value.problem(drive::sourceOf(profile) + " has no object `" + *text + "`" +
                  yaml::suggestion(*text, drive::objectNames(profile)));
  } else if (!(direction == PdoDirection::rpdo ? object->rpdo : object->tpdo)) {
    value.problem("`" + object->name + "` cannot be mapped into " + word(direction) +
                  (object->from_eds ? " by " + profile.eds : " (see its `pdo:` in the profile)"));
  }
  return object;
}

void readEntries(const yaml::Value& list, const DriveProfile& profile,
                 const canopen::DeviceProfile& device, PdoLayout& pdo,
                 std::map<std::string, std::string>& mapped) {
  unsigned bits = 0;
  std::string widths;
  for (const yaml::Value& value : list.list()) {
    const ObjectSpec* object = readEntry(value, profile, pdo.direction);
    if (object == nullptr) continue;
    const auto [first, fresh] = mapped.emplace(object->name, list.path());
    if (!fresh) value.problem("`" + object->name + "` is mapped already, in " + first->second);
    const unsigned width = fieldbus::sizeBits(object->type);
    bits += width;
    append(widths, std::to_string(width), " + ");
    pdo.objects.push_back(object->name);
  }
  if (bits > 64) {
    list.problem("is " + std::to_string(bits) + " bits long (" + widths +
                 "), a PDO holds 64; move an object into another PDO");
  }
  if (pdo.objects.size() > device.max_pdo_entries) {
    list.problem("maps " + std::to_string(pdo.objects.size()) + " objects, the drive takes " +
                 std::to_string(device.max_pdo_entries) + " in a PDO");
  }
}

// "rpdo1" .. "tpdo<max>".
std::optional<PdoLayout> parseName(const std::string& name, const canopen::DeviceProfile& device) {
  PdoLayout pdo;
  const std::string kind = name.substr(0, 4);
  if (kind != "rpdo" && kind != "tpdo") return {};
  pdo.direction = kind == "rpdo" ? PdoDirection::rpdo : PdoDirection::tpdo;
  const auto number = yaml::parseInteger(name.substr(4));
  const unsigned most = pdo.direction == PdoDirection::rpdo ? device.max_rpdos : device.max_tpdos;
  if (!number || *number < 1 || *number > static_cast<std::int64_t>(most)) return {};
  pdo.number = static_cast<unsigned>(*number);
  return pdo;
}

}  // namespace

std::vector<std::string> readModeNames(const yaml::Value& list, const DriveProfile& profile) {
  std::vector<std::string> known, names;
  for (const ModeSpec& mode : profile.modes) known.push_back(mode.name);
  for (const yaml::Value& value : list.list()) {
    const auto text = value.text();
    if (!text) continue;
    names.push_back(drive::canonicalModeName(*text));
    if (profile.mode(names.back()) != nullptr) continue;
    value.problem("profile " + profile.name + " has no mode `" + *text + "`" +
                  yaml::suggestion(*text, known));
  }
  return names;
}

std::vector<std::string> readFeedbackNames(const yaml::Value& list, const DriveProfile& profile) {
  std::vector<std::string> names;
  for (const yaml::Value& value : list.list()) {
    const ObjectSpec* object = readEntry(value, profile, PdoDirection::tpdo);
    if (object != nullptr) names.push_back(object->name);
  }
  return names;
}

std::vector<PdoLayout> readPdos(const yaml::Value& value, const DriveProfile& profile,
                                const canopen::DeviceProfile& device, Sharing sharing) {
  std::vector<PdoLayout> pdos;
  std::map<std::string, std::string> mapped[2];  // per direction: object -> where
  yaml::Section section(value);
  for (const auto& [name, entry] : section.entries()) {
    auto pdo = parseName(name, device);
    if (!pdo) {
      entry.problem("no such PDO; there are rpdo1 to rpdo" + std::to_string(device.max_rpdos) +
                    " and tpdo1 to tpdo" + std::to_string(device.max_tpdos));
      continue;
    }
    auto& seen = mapped[pdo->direction == PdoDirection::rpdo ? 0 : 1];
    if (sharing == Sharing::allowed) seen.clear();
    if (!entry.isMap()) {
      readEntries(entry, profile, device, *pdo, seen);
    } else {
      yaml::Section details(entry);
      if (const auto list = details.require("objects", "list the objects by profile name")) {
        readEntries(*list, profile, device, *pdo, seen);
      }
      readTransmission(details, profile, device, *pdo);
      pdo->inhibit = readTime(details, "inhibit", 1e-4);
      pdo->event_timer = readTime(details, "event_timer", 1e-3);
      checkTimer(details, profile, device, *pdo);
      readCobId(details, *pdo);
      const bool requested = canopen::isRequested(pdo->transmission);
      if (details.has("request_every") && !requested) {
        details.get("request_every")->problem("is for TPDOs of transmission type 252 or 253");
      }
      details.readInteger("request_every", pdo->request_every, 1, 10000);
      if (details.has("refresh_every") && pdo->direction == PdoDirection::tpdo) {
        details.get("refresh_every")->problem("is for RPDOs");
      }
      details.readInteger("refresh_every", pdo->refresh_every, 1, 1000);
      readSyncStart(details, profile, device, *pdo);
      details.finish();
    }
    checkDemands(entry, profile, *pdo);
    pdos.push_back(*pdo);
  }
  section.finish();
  return pdos;
}

}  // namespace cia402::config
