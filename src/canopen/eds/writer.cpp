// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "canopen/eds/eds.h"
#include "canopen/eds/strings.h"
#include "canopen/eds/value.h"
#include "common/text.h"

namespace cia402::canopen {
namespace {

constexpr unsigned kBaudRates[] = {10, 20, 50, 125, 250, 500, 800, 1000};

/// Builds the text of a file, section by section.
class DcfText {
 public:
  void section(const std::string& name) {
    text_ += (text_.empty() ? "[" : "\r\n[") + name + "]\r\n";
  }
  void key(const std::string& name, const std::string& value) {
    text_ += name + "=" + value + "\r\n";
  }
  void number(const std::string& name, std::uint64_t value) { key(name, std::to_string(value)); }
  /// Only if there is something to write.
  void optional(const std::string& name, const std::string& value) {
    if (!value.empty()) key(name, value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

// Names come from files that were read line by line, or from configurations: what would not stay
// one line is replaced.
std::string oneLine(std::string_view text) {
  std::string line;
  for (char c : text) line += isControl(c) ? ' ' : c;
  for (std::size_t at = 0; (at = line.find(';', at)) != std::string::npos; ++at) {
    if (at == 0 || line[at - 1] == ' ') line[at] = ',';
  }
  return std::string(trimmed(line));
}

void writeInfo(const EdsInfo& info, DcfText& text) {
  text.section("FileInfo");
  text.optional("FileName", oneLine(info.file_name));
  text.number("FileVersion", 1);
  text.number("FileRevision", 0);
  text.key("EDSVersion", info.eds_version.empty() ? "4.0" : oneLine(info.eds_version));
  text.optional("Description", oneLine(info.description));
  text.optional("CreationTime", oneLine(info.creation_time));
  text.optional("CreationDate", oneLine(info.creation_date));
  text.optional("CreatedBy", oneLine(info.created_by));
  text.optional("ModificationTime", oneLine(info.modification_time));
  text.optional("ModificationDate", oneLine(info.modification_date));
  text.optional("ModifiedBy", oneLine(info.modified_by));
  text.optional("LastEDS", oneLine(info.last_eds));
}

void writeDevice(const EdsInfo& info, DcfText& text) {
  text.section("DeviceInfo");
  text.optional("VendorName", oneLine(info.vendor_name));
  if (info.vendor_number) text.key("VendorNumber", hexText(*info.vendor_number, 8));
  text.optional("ProductName", oneLine(info.product_name));
  if (info.product_number) text.key("ProductNumber", hexText(*info.product_number, 8));
  if (info.revision_number) text.key("RevisionNumber", hexText(*info.revision_number, 8));
  text.optional("OrderCode", oneLine(info.order_code));
  for (unsigned rate : kBaudRates) {
    const auto& rates = info.baud_rates;
    const bool has = std::find(rates.begin(), rates.end(), rate) != rates.end();
    text.number("BaudRate_" + std::to_string(rate), has ? 1 : 0);
  }
  text.number("SimpleBootUpMaster", info.boot_up_master ? 1 : 0);
  text.number("SimpleBootUpSlave", info.boot_up_slave ? 1 : 0);
  text.number("Granularity", info.granularity);
  text.number("DynamicChannelsSupported", info.dynamic_channels);
  text.number("GroupMessaging", info.group_messaging ? 1 : 0);
  text.number("NrOfRXPDO", info.rpdo_count);
  text.number("NrOfTXPDO", info.tpdo_count);
  text.number("LSS_Supported", info.lss_supported ? 1 : 0);
  text.number("CompactPDO", info.compact_pdo);
}

void writeCommissioning(const EdsInfo& info, DcfText& text) {
  if (info.node_id) {
    text.section("DeviceComissioning");  // spelt as CiA 306 spells it
    text.key("NodeID", hexText(*info.node_id, 2));
    text.optional("NodeName", oneLine(info.node_name));
    if (info.baud_rate != 0) text.number("Baudrate", info.baud_rate);
    if (info.lss_serial) text.key("LSS_SerialNumber", hexText(*info.lss_serial, 8));
  }
  text.section("DummyUsage");
  for (std::uint16_t code = 1; code <= 0x1B; ++code) {
    const auto& dummies = info.dummies;
    const bool has = std::find(dummies.begin(), dummies.end(), code) != dummies.end();
    if (has || code <= 7) text.number("Dummy" + hexText(code, 4).substr(2), has ? 1 : 0);
  }
  if (info.comments.empty()) return;
  text.section("Comments");
  text.number("Lines", info.comments.size());
  for (std::size_t i = 0; i < info.comments.size(); ++i) {
    text.key("Line" + std::to_string(i + 1), oneLine(info.comments[i]));
  }
}

bool isMandatory(std::uint16_t index) {
  return index == 0x1000 || index == 0x1001 || index == 0x1018;
}
bool isManufacturers(std::uint16_t index) { return index >= 0x2000 && index < 0x6000; }
bool isOptional(std::uint16_t index) {
  return index >= 0x1000 && !isMandatory(index) && !isManufacturers(index);
}

void writeList(const char* name, bool (*belongs)(std::uint16_t), const ObjectDictionary& dictionary,
               DcfText& text) {
  std::vector<std::uint16_t> indices;
  for (const auto& [index, object] : dictionary.objects()) {
    if (belongs(index)) indices.push_back(index);
  }
  text.section(name);
  text.number("SupportedObjects", indices.size());
  for (std::size_t i = 0; i < indices.size(); ++i) {
    text.key(std::to_string(i + 1), hexText(indices[i], 4));
  }
}

void writeValue(const char* name, const std::optional<ObjectValue>& value, DataType type,
                DcfText& text) {
  if (!value) return;
  if (const auto line = formatEdsValue(*value, type)) text.key(name, *line);
}

void writeDefault(const DictionaryEntry& entry, std::optional<NodeId> node_id, DcfText& text) {
  if (!entry.default_value || !entry.default_adds_node_id || !node_id) {
    writeValue("DefaultValue", entry.default_value, entry.type, text);
    return;
  }
  std::uint64_t raw = 0;
  for (std::size_t i = entry.default_value->size(); i-- > 0;) {
    raw = raw << 8U | (*entry.default_value)[i];
  }
  text.key("DefaultValue", "$NODEID+" + hexText(raw - *node_id, 1));
}

void writeEntry(const DictionaryEntry& entry, std::optional<NodeId> node_id, DcfText& text) {
  text.key("DataType", hexText(dataTypeCode(entry.type), 4));
  text.key("AccessType", toString(entry.access));
  writeValue("LowLimit", entry.low, entry.type, text);
  writeValue("HighLimit", entry.high, entry.type, text);
  writeDefault(entry, node_id, text);
  text.number("PDOMapping", entry.mappable ? 1 : 0);
  if (entry.flags != 0) text.key("ObjFlags", hexText(entry.flags, 1));
  writeValue("ParameterValue", entry.value, entry.type, text);
  text.optional("Denotation", oneLine(entry.denotation));
  text.optional("UploadFile", oneLine(entry.upload_file));
  text.optional("DownloadFile", oneLine(entry.download_file));
}

void writeObject(const DictionaryObject& object, std::optional<NodeId> node_id, DcfText& text) {
  const std::string name = hexText(object.index, 4).substr(2);
  const auto single = object.entries.find(0);
  text.section(name);
  text.key("ParameterName", oneLine(object.name));
  text.key("ObjectType", hexText(static_cast<std::uint64_t>(object.code), 1));
  if (object.code < ObjectCode::array && object.code != ObjectCode::defstruct &&
      single != object.entries.end()) {
    writeEntry(single->second, node_id, text);
    return;
  }
  text.number("SubNumber", object.entries.size());
  for (const auto& [subindex, entry] : object.entries) {
    text.section(name + "sub" + hexText(subindex, 1).substr(2));
    text.key("ParameterName", oneLine(entry.name));
    const bool domain = entry.type == DataType::domain;
    text.key("ObjectType",
             hexText(static_cast<unsigned>(domain ? ObjectCode::domain : ObjectCode::variable), 1));
    writeEntry(entry, node_id, text);
  }
}

}  // namespace

bool fitsDcf(DataType type, const ObjectValue& value) {
  return formatEdsValue(value, type).has_value();
}

std::string writeDcf(const EdsInfo& info, const ObjectDictionary& dictionary) {
  DcfText text;
  writeInfo(info, text);
  writeDevice(info, text);
  writeCommissioning(info, text);
  writeList("MandatoryObjects", isMandatory, dictionary, text);
  writeList("OptionalObjects", isOptional, dictionary, text);
  writeList("ManufacturerObjects", isManufacturers, dictionary, text);
  for (const auto& [index, object] : dictionary.objects()) {
    writeObject(object, info.node_id, text);
  }
  return text.take();
}

}  // namespace cia402::canopen
