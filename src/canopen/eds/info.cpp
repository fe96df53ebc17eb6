// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "canopen/eds/info.h"

#include <string>

#include "canopen/eds/value.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kBaudRates[] = {10, 20, 50, 125, 250, 500, 800, 1000};

std::string textOf(const EdsSection& section, const char* key) {
  const EdsKey* found = section.find(key);
  return found == nullptr ? std::string() : found->value;
}

void readFileInfo(const EdsSection* section, EdsInfo& info) {
  if (section == nullptr) return;
  info.file_name = textOf(*section, "filename");
  info.description = textOf(*section, "description");
  info.created_by = textOf(*section, "createdby");
  info.modified_by = textOf(*section, "modifiedby");
  info.eds_version = textOf(*section, "edsversion");
  info.creation_date = textOf(*section, "creationdate");
  info.creation_time = textOf(*section, "creationtime");
  info.modification_date = textOf(*section, "modificationdate");
  info.modification_time = textOf(*section, "modificationtime");
  info.last_eds = textOf(*section, "lasteds");
}

void readDeviceInfo(const EdsSection* section, EdsKeys& keys, EdsInfo& info) {
  if (section == nullptr) return;
  const auto word = [&](const char* key) -> std::optional<std::uint32_t> {
    const auto value = keys.number(*section, key, 0xFFFFFFFF);
    if (!value) return {};
    return static_cast<std::uint32_t>(*value);
  };
  info.vendor_name = textOf(*section, "vendorname");
  info.product_name = textOf(*section, "productname");
  info.order_code = textOf(*section, "ordercode");
  info.vendor_number = word("vendornumber");
  info.product_number = word("productnumber");
  info.revision_number = word("revisionnumber");
  for (unsigned rate : kBaudRates) {
    if (keys.flag(*section, ("baudrate_" + std::to_string(rate)).c_str())) {
      info.baud_rates.push_back(rate);
    }
  }
  info.rpdo_count = static_cast<std::uint16_t>(keys.numberOr0(*section, "nrofrxpdo", 512));
  info.tpdo_count = static_cast<std::uint16_t>(keys.numberOr0(*section, "nroftxpdo", 512));
  info.compact_pdo = static_cast<std::uint8_t>(keys.numberOr0(*section, "compactpdo", 0xFF));
  info.granularity = static_cast<std::uint8_t>(keys.numberOr0(*section, "granularity", 64));
  info.lss_supported = keys.flag(*section, "lss_supported");
  info.boot_up_master = keys.flag(*section, "simplebootupmaster");
  info.boot_up_slave = keys.flag(*section, "simplebootupslave");
  info.group_messaging = keys.flag(*section, "groupmessaging");
  info.dynamic_channels =
      static_cast<std::uint8_t>(keys.numberOr0(*section, "dynamicchannelssupported", 0xFF));
}

// CiA 306 writes DeviceComissioning; who knows better English is read, too.
void readCommissioning(const EdsText& text, EdsKeys& keys, EdsProblems& problems, EdsInfo& info) {
  const EdsSection* section = text.find("devicecomissioning");
  if (section == nullptr) {
    section = text.find("devicecommissioning");
    if (section == nullptr) return;
    problems.warning(section->line, "[" + section->name + "] should be [DeviceComissioning]");
  }
  const auto id = keys.number(*section, "nodeid", 127);
  if (id && *id != 0) info.node_id = static_cast<NodeId>(*id);
  info.node_name = textOf(*section, "nodename");
  info.baud_rate = static_cast<unsigned>(keys.numberOr0(*section, "baudrate", 1000));
  const auto serial = keys.number(*section, "lss_serialnumber", 0xFFFFFFFF);
  if (serial) info.lss_serial = static_cast<std::uint32_t>(*serial);
}

void readDummies(const EdsText& text, EdsKeys& keys, EdsProblems& problems, EdsInfo& info) {
  const EdsSection* section = text.find("dummyusage");
  if (section == nullptr) return;
  for (const auto& [name, key] : section->keys) {
    const auto code =
        name.substr(0, 5) == "dummy" ? parseEdsNumber("0x" + name.substr(5)) : std::nullopt;
    if (!code || code->magnitude == 0 || code->magnitude > 0xFF) {
      problems.warning(key.line, quoteEds(key.name) + " is no data type like Dummy0005");
    } else if (!key.value.empty() && keys.numberOf(key, 1).value_or(0) == 1) {
      info.dummies.push_back(static_cast<std::uint16_t>(code->magnitude));
    }
  }
}

void readComments(const EdsText& text, EdsKeys& keys, EdsProblems& problems, EdsInfo& info) {
  const EdsSection* section = text.find("comments");
  if (section == nullptr) return;
  std::size_t found = 0;
  for (std::size_t i = 1; i <= section->keys.size(); ++i) {
    const EdsKey* line = section->find("line" + std::to_string(i));
    if (line == nullptr) break;
    info.comments.push_back(line->value);
    ++found;
  }
  const EdsKey* lines = section->given("lines");
  if (lines == nullptr) {
    problems.warning(section->line, "[" + section->name + "] has no Lines");
  } else if (keys.numberOf(*lines, 0xFFFF).value_or(found) != found) {
    problems.warning(lines->line, "[" + section->name + "] has " + std::to_string(found) +
                                      " lines, not " + lines->value);
  }
}

}  // namespace

void readEdsInfo(const EdsText& text, EdsKeys& keys, EdsProblems& problems, EdsInfo& info) {
  readFileInfo(keys.require(text, "FileInfo"), info);
  readDeviceInfo(keys.require(text, "DeviceInfo"), keys, info);
  readCommissioning(text, keys, problems, info);
  readDummies(text, keys, problems, info);
  readComments(text, keys, problems, info);
}

}  // namespace cia402::canopen
