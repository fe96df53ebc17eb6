// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_draft.h"

#include <cmath>
#include <iterator>

namespace cia402::bus {
namespace {

using fieldbus::Access;
using fieldbus::DataType;
using fieldbus::DictionaryEntry;
using fieldbus::DictionaryObject;
using fieldbus::ObjectCode;
using fieldbus::ObjectId;

constexpr std::size_t kMostNamed = 10;
constexpr const char* kHighest = "Highest sub-index supported";
constexpr std::uint32_t kNotToBeRead = 0x2;  // ObjFlags of CiA 306

// C drives pad their names with zeros.
fieldbus::Bytes withoutPadding(fieldbus::Bytes data) {
  while (!data.empty() && data.back() == 0) data.pop_back();
  return data;
}

DictionaryEntry entryOf(ObjectId id, std::string name, DataType type, Access access) {
  DictionaryEntry entry;
  entry.id = id;
  entry.name = std::move(name);
  entry.type = type;
  entry.access = access;
  return entry;
}

std::string nameOf(const DcfReading::Item& item, const std::string& problem) {
  return fieldbus::toString(item.id) + " " + item.name + " (" + problem + ")";
}

}  // namespace

DcfDraft::DcfDraft(const drive::AxisConfig& axis, const canopen::DeviceConfig& device,
                   const DcfStamp& stamp, const std::vector<const drive::AxisConfig*>& others)
    : axis_(axis.name), who_(drive::whoIs(axis)), has_eds_(device.eds != nullptr) {
  if (has_eds_) {
    info_ = *device.eds;
    info_.last_eds = axis.description->file;
    dictionary_ = axis.description->dictionary;
  } else {
    info_.description = "Written without an EDS, by profile " + axis.profile->name;
    info_.granularity = 8;
    std::vector<const drive::AxisConfig*> axes = others;
    axes.insert(axes.begin(), &axis);
    for (const drive::AxisConfig* each : axes) addProfileObjects(*each->profile);
    addCommunicationObjects();
    for (const drive::AxisConfig* each : axes) {
      addPdoObjects(*device.profile, device.profile->pdos_per_axis * each->device_axis);
    }
  }
  info_.file_name = stamp.file_name;
  info_.node_id = device.node_id;
  info_.node_name = axis.name;
  info_.modification_date = stamp.date;
  info_.modification_time = stamp.time;
  info_.modified_by = "cia402_driver";
  if (info_.creation_date.empty()) {
    info_.creation_date = stamp.date;
    info_.creation_time = stamp.time;
    info_.created_by = "cia402_driver";
  }
  plan();
}

void DcfDraft::plan() {
  for (auto& [index, object] : dictionary_.objects()) {
    for (auto& [subindex, entry] : object.entries) {
      entry.value.reset();
      const bool wanted = isReadable(entry.access) && (entry.flags & kNotToBeRead) == 0 &&
                          entry.upload_file.empty() && index >= 0x1000;
      if (!wanted) continue;
      DcfReading::Item item;
      item.id = entry.id;
      item.name = dictionary_.fullName(entry);
      item.guessed = !has_eds_;
      reading_->items.push_back(std::move(item));
    }
  }
}

void DcfDraft::addProfileObjects(const drive::DriveProfile& profile) {
  for (const drive::ObjectSpec& spec : profile.objects) {
    auto& objects = dictionary_.objects();
    DictionaryObject& object = objects[spec.id.index];
    const bool first = object.entries.empty();
    object.index = spec.id.index;
    const Access access = !spec.readable ? Access::wo : !spec.writable ? Access::ro : Access::rw;
    DictionaryEntry entry = entryOf(spec.id, spec.name, spec.type, access);
    entry.mappable = spec.rpdo || spec.tpdo;
    object.entries[spec.id.subindex] = std::move(entry);
    // A record has it, whether or not the profile makes use of it.
    object.entries.try_emplace(0,
                               entryOf({spec.id.index, 0}, kHighest, DataType::uint8, Access::ro));
    const bool single = first && spec.id.subindex == 0;
    object.code = single ? ObjectCode::variable : ObjectCode::record;
    object.name = single ? spec.name : fieldbus::toString(spec.id).substr(0, 4);
  }
}

void DcfDraft::addRecord(std::uint16_t index, const char* name, const std::vector<DataType>& types,
                         const std::vector<const char*>& names, Access count, Access others) {
  auto [place, fresh] = dictionary_.objects().try_emplace(index);
  if (!fresh) return;  // the profile names it
  DictionaryObject& object = place->second;
  object.index = index;
  object.name = name;
  object.code = ObjectCode::record;
  for (std::size_t i = 0; i < types.size(); ++i) {
    const ObjectId id{index, static_cast<std::uint8_t>(i)};
    object.entries[id.subindex] = entryOf(id, names[i], types[i], i == 0 ? count : others);
  }
}

void DcfDraft::addCommunicationObjects() {
  static constexpr struct {
    std::uint16_t index;
    const char* name;
    DataType type;
    Access access;
  } kVariables[] = {
      {0x1000, "Device type", DataType::uint32, Access::ro},
      {0x1001, "Error register", DataType::uint8, Access::ro},
      {0x1005, "COB-ID SYNC message", DataType::uint32, Access::rw},
      {0x1006, "Communication cycle period", DataType::uint32, Access::rw},
      {0x1007, "Synchronous window length", DataType::uint32, Access::rw},
      {0x1008, "Manufacturer device name", DataType::visible_string, Access::constant},
      {0x1009, "Manufacturer hardware version", DataType::visible_string, Access::constant},
      {0x100A, "Manufacturer software version", DataType::visible_string, Access::constant},
      {0x100C, "Guard time", DataType::uint16, Access::rw},
      {0x100D, "Life time factor", DataType::uint8, Access::rw},
      {0x1014, "COB-ID emergency message", DataType::uint32, Access::rw},
      {0x1015, "Inhibit time emergency", DataType::uint16, Access::rw},
      {0x1017, "Producer heartbeat time", DataType::uint16, Access::rw},
      {0x1019, "Synchronous counter overflow value", DataType::uint8, Access::rw},
  };
  for (const auto& row : kVariables) {
    auto [place, fresh] = dictionary_.objects().try_emplace(row.index);
    if (!fresh) continue;
    place->second = {row.index, row.name, ObjectCode::variable, {}};
    place->second.entries[0] = entryOf({row.index, 0}, row.name, row.type, row.access);
  }
  const DataType u8 = DataType::uint8, u32 = DataType::uint32;
  addRecord(0x1016, "Consumer heartbeat time", {u8, u32}, {kHighest, "Consumer heartbeat time 1"},
            Access::ro, Access::rw);
  addRecord(0x1018, "Identity object", {u8, u32, u32, u32, u32},
            {kHighest, "Vendor-ID", "Product code", "Revision number", "Serial number"}, Access::ro,
            Access::ro);
}

void DcfDraft::addPdoObjects(const canopen::DeviceProfile& profile, unsigned first) {
  const DataType u8 = DataType::uint8, u16 = DataType::uint16, u32 = DataType::uint32;
  std::vector<DataType> mapped(9, u32);
  mapped[0] = u8;
  const std::vector<const char*> mapped_names = {
      "Number of mapped objects", "Mapped object 1", "Mapped object 2",
      "Mapped object 3",          "Mapped object 4", "Mapped object 5",
      "Mapped object 6",          "Mapped object 7", "Mapped object 8"};
  for (const unsigned base : {0x1400U, 0x1800U}) {
    const bool receive = base == 0x1400;
    const unsigned count = receive ? profile.max_rpdos : profile.max_tpdos;
    for (unsigned i = 0; i < count; ++i) {
      addRecord(static_cast<std::uint16_t>(base + first + i),
                receive ? "RPDO communication parameter" : "TPDO communication parameter",
                {u8, u32, u8, u16, u8, u16, u8},
                {kHighest, "COB-ID", "Transmission type", "Inhibit time", "Reserved", "Event timer",
                 "SYNC start value"},
                Access::ro, Access::rw);
      addRecord(static_cast<std::uint16_t>(base + 0x200 + first + i),
                receive ? "RPDO mapping parameter" : "TPDO mapping parameter", mapped, mapped_names,
                Access::rw, Access::rw);
    }
  }
}

DcfAnswer DcfDraft::finish() {
  for (const DcfReading::Item& item : reading_->items) take(item);
  DcfAnswer answer;
  if (read_ == 0) {
    answer.message = who_ + ": no DCF: the drive gave none of its objects";
    return answer;
  }
  setIdentity();
  info_.baud_rate = static_cast<unsigned>(std::lround(reading_->bitrate / 1000.0));
  answer.success = true;
  answer.message = who_ + ": " + std::to_string(read_) + " objects read";
  answer.text = canopen::writeDcf(info_, dictionary_);
  if (unwritable_ != 0) {
    answer.message += ", " + std::to_string(unwritable_) +
                      " of them left out because no line of text can hold their bytes";
  }
  if (unread_.empty()) return answer;
  answer.message += ", " + std::to_string(unread_.size()) + " could not be read: ";
  for (std::size_t i = 0; i < unread_.size() && i < kMostNamed; ++i) {
    answer.message += (i == 0 ? "" : "; ") + unread_[i];
  }
  if (unread_.size() > kMostNamed) answer.message += "; ...";
  return answer;
}

void DcfDraft::take(const DcfReading::Item& item) {
  using Outcome = DcfReading::Outcome;
  if (item.outcome == Outcome::read) store(item);
  if (item.outcome == Outcome::refused) unread_.push_back(nameOf(item, item.problem));
  const bool failed = item.outcome == Outcome::refused || item.outcome == Outcome::absent;
  if (!failed || !item.guessed) return;
  // Nobody says that the drive has it.
  const auto object = dictionary_.objects().find(item.id.index);
  if (object == dictionary_.objects().end()) return;
  object->second.entries.erase(item.id.subindex);
  if (object->second.entries.empty() || item.id.subindex == 0) dictionary_.objects().erase(object);
}

void DcfDraft::store(const DcfReading::Item& item) {
  DictionaryEntry& entry = dictionary_.objects().at(item.id.index).entries.at(item.id.subindex);
  const unsigned bits = fieldbus::sizeBits(entry.type);
  if (bits != 0 && item.data.size() != (bits + 7) / 8) {
    unread_.push_back(nameOf(item, std::to_string(item.data.size()) + " bytes, but it should be " +
                                       fieldbus::toString(entry.type)));
    return;
  }
  ++read_;
  entry.value = entry.type == DataType::visible_string ? withoutPadding(item.data) : item.data;
  if (!entry.value->empty() && !canopen::fitsDcf(entry.type, *entry.value)) ++unwritable_;
}

// Who the device is, where no EDS says it.
void DcfDraft::setIdentity() {
  const auto number = [&](std::uint8_t subindex) -> std::optional<std::uint32_t> {
    const DictionaryEntry* entry = dictionary_.find(ObjectId{0x1018, subindex});
    if (entry == nullptr || !entry->value || entry->value->size() != 4) return {};
    return static_cast<std::uint32_t>(fieldbus::toUnsigned(*entry->value));
  };
  if (!info_.vendor_number) info_.vendor_number = number(1);
  if (!info_.product_number) info_.product_number = number(2);
  if (!info_.revision_number) info_.revision_number = number(3);
  info_.lss_serial = number(4);
  const DictionaryEntry* name = dictionary_.find(ObjectId{0x1008, 0});
  if (info_.product_name.empty() && name != nullptr && name->value) {
    info_.product_name.assign(name->value->begin(), name->value->end());
  }
  const auto count = [&](std::uint16_t first) {
    const auto& objects = dictionary_.objects();
    const auto end = objects.lower_bound(static_cast<std::uint16_t>(first + 0x200));
    return static_cast<std::uint16_t>(std::distance(objects.lower_bound(first), end));
  };
  if (has_eds_) return;
  info_.rpdo_count = count(0x1400);
  info_.tpdo_count = count(0x1800);
}

}  // namespace cia402::bus
