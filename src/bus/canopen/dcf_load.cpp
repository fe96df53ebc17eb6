// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "bus/canopen/dcf_load.h"

#include <algorithm>
#include <utility>

#include "canopen/eds/eds.h"
#include "common/text.h"
#include "drive/profile/object_value.h"

namespace cia402::bus {
namespace {

using canopen::DictionaryEntry;
using canopen::EdsProblem;
using drive::CoordinateMark;
using fieldbus::ObjectId;
using Loaded = DcfLoading::Outcome;

constexpr std::uint16_t kFirstOfMaker = 0x2000;  // below it is communication
constexpr std::uint32_t kNotToBeWritten = 0x1;   // ObjFlags of CiA 306
constexpr std::size_t kMostListed = 20;

/// What of CiA 402-2 makes a drive do something, of the first axis.
constexpr std::uint16_t kCommands[] = {
    0x6040,                  // controlword
    0x6042, 0x6060, 0x6071,  // target velocity (vl), mode, target torque
    0x607A, 0x60B0, 0x60B1,  // target position, offsets of position and velocity
    0x60B2, 0x60B8, 0x60C1,  // of torque, touch probes, interpolation data
    0x60FE, 0x60FF,          // digital outputs, target velocity
};

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return !name.empty() && std::find(names.begin(), names.end(), name) != names.end();
}

bool commandsByStandard(ObjectId id) {
  const auto axis = drive::axisOf(id);
  if (!axis) return false;
  const auto index = static_cast<std::uint16_t>(id.index - *axis * drive::kAxisSize);
  return std::find(std::begin(kCommands), std::end(kCommands), index) != std::end(kCommands);
}

/// What only the maker may write, or of which there is an own service; empty: neither.
std::string guardOf(CoordinateMark mark) {
  if (mark == CoordinateMark::calibration) return "calibration";
  const bool service =
      mark == CoordinateMark::restore_parameters || mark == CoordinateMark::set_position;
  return service ? "it has a service of its own" : "";
}

/// Why an object is not written; empty: it is.
std::string leftOut(const drive::AxisConfig& axis, const canopen::BusSettings& bus,
                    const DictionaryEntry& entry) {
  const drive::DriveProfile& profile = *axis.profile;
  const drive::ObjectSpec* object = profile.find(entry.id);
  const std::string name = object == nullptr ? std::string() : object->name;
  const drive::ParameterRecipes& recipes = profile.parameters.recipes;
  if (commandsByStandard(entry.id) || holds(recipes.commands, name)) return "a command";
  const std::string guard = guardOf(profile.coordinateMark(entry.id));
  if (!guard.empty()) return guard;
  if (holds({bus.node_id.object, bus.bit_rate.object}, name)) return "set_bus_parameters sets it";
  if (holds({bus.memory, recipes.memory.object}, name)) return "the driver's";
  const auto owner = drive::axisOf(entry.id);
  if (owner && *owner != axis.device_axis) return "of another axis of the drive";
  if (!drive::doubtOf(axis, entry.id).empty()) return "its meaning is in doubt";
  if (object == nullptr || !drive::holdsFloat(object->type, object->encoding)) return {};
  const std::uint64_t raw = fieldbus::toUnsigned(*entry.value);
  return drive::sendable(object->type, object->encoding, raw) ? "" : "no finite number";
}

std::string dcfTitle(const drive::AxisConfig& axis, const DictionaryEntry& entry) {
  const drive::ObjectSpec* object = axis.profile->find(entry.id);
  const std::string of_maker = axis.profile->parameter_names.nameOf(entry.id);
  return fieldbus::toString(entry.id) + (of_maker.empty() ? "" : " " + of_maker) + " " +
         (object == nullptr ? entry.name : object->name);
}

DcfLoading::Item itemOf(const drive::AxisConfig& axis, const DictionaryEntry& entry) {
  DcfLoading::Item item;
  item.id = entry.id;
  item.name = dcfTitle(axis, entry);
  item.data = *entry.value;
  item.moves_zero = axis.profile->coordinateMark(entry.id) != CoordinateMark::none;
  return item;
}

void addItems(const canopen::ObjectDictionary& dictionary, const drive::AxisConfig& axis,
              const canopen::BusSettings& bus, DcfLoading& loading) {
  for (const auto& [index, object] : dictionary.objects()) {
    if (index < kFirstOfMaker) continue;
    for (const auto& [subindex, entry] : object.entries) {
      const bool wanted = isWritable(entry.access) && (entry.flags & kNotToBeWritten) == 0 &&
                          entry.value && !entry.value->empty();
      if (!wanted) continue;
      const std::string why_not = leftOut(axis, bus, entry);
      if (why_not.empty()) {
        loading.items.push_back(itemOf(axis, entry));
      } else {
        loading.left_out.push_back(dcfTitle(axis, entry) + " (" + why_not + ")");
      }
    }
  }
}

void sortLast(const drive::AxisConfig& axis, DcfLoading& loading) {
  for (const std::string& name : axis.profile->parameters.recipes.load_last) {
    const drive::ObjectSpec* object = axis.profile->find(name);
    const auto others = std::stable_partition(
        loading.items.begin(), loading.items.end(),
        [&](const DcfLoading::Item& item) { return !(item.id == object->id); });
    (void)others;
  }
}

/// Device type, maker and product say which drives it is for, not the revision or serial number.
void addIdentity(const canopen::Eds& eds, const drive::AxisConfig& axis, DcfLoading& loading) {
  const std::pair<ObjectId, std::optional<std::uint32_t>> numbers[] = {
      {{0x1000, 0}, std::nullopt},
      {{0x1018, 1}, eds.info.vendor_number},
      {{0x1018, 2}, eds.info.product_number}};
  for (const auto& [id, number] : numbers) {
    const DictionaryEntry* entry = eds.dictionary.find(id);
    if (entry != nullptr && entry->value && entry->value->size() == 4) {
      loading.identity.push_back(itemOf(axis, *entry));
    } else if (number) {
      DcfLoading::Item item;
      item.id = id;
      item.name = fieldbus::toString(id);
      item.data = fieldbus::toBytes(*number, 4);
      loading.identity.push_back(std::move(item));
    }
  }
}

/// ": a, b, ..." of those with that outcome, with their problems.
std::string namesOf(const DcfLoading& loading, Loaded outcome) {
  std::string text;
  std::size_t count = 0;
  for (const DcfLoading::Item& item : loading.items) {
    if (item.outcome != outcome || ++count > kMostListed) continue;
    append(text, item.name + (item.problem.empty() ? "" : " (" + item.problem + ")"), ", ");
  }
  if (count > kMostListed) text += ", ...";
  return text.empty() ? text : ": " + text;
}

}  // namespace

Result<std::shared_ptr<DcfLoading>> planDcf(std::string_view text, const std::string& file,
                                            const drive::AxisConfig& axis,
                                            const canopen::DeviceProfile& device) {
  const std::string who = drive::whoIs(axis) + ": " + file + " not loaded: ";
  const canopen::Eds eds = canopen::readEds(text);
  const auto bad = std::find_if(eds.problems.begin(), eds.problems.end(), [](const auto& problem) {
    return problem.severity == EdsProblem::Severity::error;
  });
  if (bad != eds.problems.end()) return Error{who + toString(*bad)};
  auto loading = std::make_shared<DcfLoading>();
  loading->file = file;
  addIdentity(eds, axis, *loading);
  if (loading->identity.empty()) {
    return Error{who + "it does not say for which drive it is (1000h, 1018h, VendorNumber)"};
  }
  addItems(eds.dictionary, axis, device.bus_settings, *loading);
  sortLast(axis, *loading);
  if (!loading->items.empty()) return loading;
  return Error{who + "it has no value (ParameterValue) that could be written"};
}

Answer dcfOutcome(const DcfLoading& loading, const drive::AxisConfig& axis) {
  const auto count = [&](Loaded outcome) {
    return std::count_if(loading.items.begin(), loading.items.end(),
                         [outcome](const auto& item) { return item.outcome == outcome; });
  };
  const auto told = [&](Loaded outcome, const char* what) {
    const auto some = count(outcome);
    return some == 0 ? std::string()
                     : ", " + std::to_string(some) + what + namesOf(loading, outcome);
  };
  Answer answer;
  const bool confirmed = count(Loaded::differs) == 0;
  answer.success = confirmed && count(Loaded::refused) == 0;
  answer.message = drive::whoIs(axis) + ": of " + std::to_string(loading.items.size()) +
                   " objects of " + loading.file + " " + std::to_string(count(Loaded::same)) +
                   " were so already" + told(Loaded::written, " were written and read back") +
                   told(Loaded::differs, " differ") + told(Loaded::refused, " were not taken");
  if (!confirmed) answer.message += "; nothing was written, call it again with confirm: true";
  std::string later;
  bool moved = false;
  for (const DcfLoading::Item& item : loading.items) {
    if (item.outcome != Loaded::written) continue;
    moved = moved || item.moves_zero;
    if (axis.profile->after_power.find(item.id) != nullptr) append(later, item.name, ", ");
  }
  if (!later.empty()) answer.message += "; once the power was off count: " + later;
  if (moved) {
    answer.message += "; " + drive::jointName(axis) + " is not homed any more, for its zero may " +
                      "be another now";
  }
  if (count(Loaded::written) != 0) {
    answer.message +=
        "; save_parameters keeps what was written, and the driver goes on writing "
        "its own settings at each boot";
  }
  if (loading.left_out.empty()) return answer;
  answer.message += "; left out: ";
  for (std::size_t i = 0; i < loading.left_out.size() && i < kMostListed; ++i) {
    answer.message += (i == 0 ? "" : ", ") + loading.left_out[i];
  }
  if (loading.left_out.size() > kMostListed) answer.message += ", ...";
  return answer;
}

}  // namespace cia402::bus
