// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "config/pdo_planner.h"

#include <algorithm>

#include "common/text.h"
#include "config/pdo_packing.h"
#include "drive/profile/outputs.h"
#include "fieldbus/object.h"

namespace cia402::config {
namespace {

using canopen::PdoDirection;
using drive::DriveProfile;
using drive::ModeSpec;
using drive::ObjectSpec;

constexpr unsigned kMaxEvery = 240;     // the slowest cyclic transmission type
constexpr unsigned kRefreshEvery = 10;  // cycles; RPDOs whose content does not change
constexpr const char* kModeObject = "mode_of_operation";
constexpr Duration kSlow = std::chrono::milliseconds(40);  // error codes, inputs

unsigned cyclesIn(Duration time, Duration cycle) {
  return static_cast<unsigned>(std::clamp<std::int64_t>(time / cycle, 1, kMaxEvery));
}

PackItem item(const ObjectSpec& object, unsigned every) {
  return {object.name, fieldbus::sizeBits(object.type), every};
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool contains(const std::vector<PackItem>& items, const std::string& name) {
  return std::any_of(items.begin(), items.end(), [&](const PackItem& i) { return i.name == name; });
}

std::string withBits(const std::vector<PackItem>& items) {
  std::string text;
  for (const PackItem& item : items) {
    append(text, item.name + " (" + std::to_string(item.bits) + ")", ", ");
  }
  return text;
}

class Planner {
 public:
  Planner(const DriveProfile& profile, const canopen::DeviceProfile& device, const PdoNeeds& needs)
      : profile_(profile), device_(device), needs_(needs) {}

  Result<PdoPlan> run() {
    Result<void> outputs = planOutputs();
    if (!outputs) return outputs.error();
    Result<void> inputs = planInputs();
    if (!inputs) return inputs.error();
    return plan_;
  }

 private:
  PackRules rules(PdoDirection direction) const {
    const bool rpdo = direction == PdoDirection::rpdo;
    PackRules rules;
    rules.pdos = rpdo ? device_.max_rpdos : device_.max_tpdos;
    rules.entries = device_.max_pdo_entries;
    rules.may_change_every_cycle = rpdo;
    const PdoNeeds::Share& share = rpdo ? needs_.rpdos : needs_.tpdos;
    rules.most = share.most;
    for (const unsigned number : share.taken) rules.fixed.push_back({number, {}});
    for (const canopen::PdoLayout& layout : device_.fixed_pdos) {
      if (layout.direction != direction) continue;
      FixedPdo fixed;
      fixed.number = layout.number;
      // Of shared PDOs those that are fixed are axis 0's.
      bool usable = profile_.offset == 0 || device_.pdos_per_axis != 0;
      for (const std::string& name : layout.objects) {
        const ObjectSpec* object = profile_.find(name);
        usable = usable && object != nullptr && (!rpdo || drive::isSetByAxis(profile_, name));
        if (object != nullptr) fixed.items.push_back(item(*object, 1));
      }
      // One with an object that nobody sets would send it as 0: its number is taken all the same.
      if (!usable) fixed.items.clear();
      rules.fixed.push_back(fixed);
    }
    return rules;
  }

  std::string rulesText(PdoDirection direction) const {
    const PackRules limits = rules(direction);
    std::string text = "the drive has " + std::to_string(limits.pdos) +
                       (direction == PdoDirection::rpdo ? " RPDO" : " TPDO") +
                       (limits.pdos == 1 ? "" : "s") + " of 64 bits with at most " +
                       std::to_string(limits.entries) + " objects";
    const auto fixed = static_cast<std::size_t>(
        std::count_if(device_.fixed_pdos.begin(), device_.fixed_pdos.end(),
                      [&](const canopen::PdoLayout& pdo) { return pdo.direction == direction; }));
    if (fixed != 0) text += ", " + std::to_string(fixed) + " of them with a mapping that is fixed";
    if (limits.most < limits.pdos) {
      text +=
          ", of which this axis gets " + std::to_string(limits.most) + " as the device has several";
    }
    return text;
  }

  /// The target of a mode as an item; nothing if it has none. The object is known to exist.
  std::optional<PackItem> target(const ModeSpec& mode, unsigned every) const {
    const ObjectSpec* object = mode.target.empty() ? nullptr : profile_.find(mode.target);
    if (object == nullptr) return {};
    return item(*object, every);
  }

  /// What a mode writes and wants to travel.
  void addMapped(const ModeSpec& mode, unsigned every, std::vector<PackItem>& items) const {
    std::vector<std::string> names = mode.mapped;
    for (const std::string& name : drive::offsetsSent(mode.offsets, needs_.feed_forward)) {
      names.push_back(name);
    }
    for (const std::string& name : names) {
      if (!contains(items, name)) items.push_back(item(*profile_.find(name), every));
    }
  }

  Result<void> planOutputs() {
    const ModeSpec* start = profile_.mode(needs_.mode);
    const ObjectSpec* controlword = profile_.find("controlword");
    if (start == nullptr || controlword == nullptr) {
      return Error{"the profile has no mode `" + needs_.mode + "` or no controlword"};
    }
    if (!controlword->rpdo) {
      return Error{"`controlword` must be mappable into an RPDO: the axis needs it in every cycle"};
    }
    const PackRules limits = rules(PdoDirection::rpdo);
    std::vector<PackItem> items = {item(*controlword, 1)};
    if (const auto of_start = target(*start, 1)) items.push_back(*of_start);
    addMapped(*start, 1, items);
    if (!reachable(*start)) return Error{unreachable(*start)};
    auto packed = packPdos(items, limits);
    if (!packed) {
      return Error{"mode `" + needs_.mode + "` needs " + withBits(items) + " in RPDOs, but " +
                   rulesText(PdoDirection::rpdo) + ": choose another mode, or give a layout that " +
                   "the drive can hold as `pdos`"};
    }
    plan_.modes = {needs_.mode};
    for (const std::string& name : needs_.modes) {
      Result<void> added = addMode(name, limits, items, *packed);
      if (!added) return added;
    }
    addModeToBrakeIn(limits, items, *packed);
    keep(*packed, PdoDirection::rpdo);
    return {};
  }

  /// Where one mode brakes another, the mode travels too, if it finds room: a drive that does not
  /// answer is braked as well.
  void addModeToBrakeIn(const PackRules& limits, std::vector<PackItem> items,
                        std::vector<PackedPdo>& packed) const {
    const ObjectSpec* object = profile_.find(kModeObject);
    const bool brakes =
        std::any_of(plan_.modes.begin(), plan_.modes.end(), [this](const std::string& name) {
          const ModeSpec& mode = *profile_.mode(name);
          return mode.stop == drive::StopBy::mode && contains(plan_.modes, mode.stop_mode);
        });
    if (!brakes || object == nullptr || !object->rpdo || contains(items, kModeObject)) return;
    items.push_back(item(*object, kRefreshEvery));
    if (auto wider = packPdos(items, limits)) packed = *wider;
  }

  Result<void> addMode(const std::string& name, const PackRules& limits,
                       std::vector<PackItem>& items, std::vector<PackedPdo>& packed) {
    const ModeSpec* mode = profile_.mode(name);
    if (mode == nullptr) return Error{"the profile has no mode `" + name + "`"};
    if (contains(plan_.modes, name)) return {};
    if (!reachable(*mode)) {
      if (needs_.modes_required) return Error{unreachable(*mode)};
      return {};
    }
    std::vector<PackItem> wider = items;
    const auto more = target(*mode, kRefreshEvery);
    if (more && !contains(items, more->name)) wider.push_back(*more);
    addMapped(*mode, kRefreshEvery, wider);
    if (auto better = packPdos(wider, limits)) {
      packed = *better;
      items = wider;
      plan_.modes.push_back(name);
    } else if (needs_.modes_required) {
      return Error{"mode `" + name + "` finds no room: " + rulesText(PdoDirection::rpdo) +
                   ", which " + withBits(items) + " fill already: `" + more->name + "` (" +
                   std::to_string(more->bits) + ") would need another one; leave out `" + name +
                   "` or one of the modes before it"};
    }
    return {};
  }

  static bool reachable(const ObjectSpec& mode_object) {
    return mode_object.writable || mode_object.rpdo;
  }
  bool reachable(const ModeSpec& mode) const {
    const ObjectSpec* object = profile_.find(kModeObject);
    if (object == nullptr || !reachable(*object)) return false;
    const ObjectSpec* goal = mode.target.empty() ? nullptr : profile_.find(mode.target);
    return mode.target.empty() || (goal != nullptr && goal->rpdo);
  }
  std::string unreachable(const ModeSpec& mode) const {
    const ObjectSpec* goal = mode.target.empty() ? nullptr : profile_.find(mode.target);
    if (goal == nullptr && !mode.target.empty()) {
      return "mode `" + mode.name + "` needs `" + mode.target + "`, which the profile lacks";
    }
    if (goal != nullptr && !goal->rpdo) {
      return "mode `" + mode.name + "` needs `" + mode.target +
             "`, which cannot be mapped into an RPDO (its `pdo:` in the profile): leave the mode "
             "out";
    }
    return "mode `" + mode.name +
           "` cannot be selected: mode_of_operation can neither be written " + "nor mapped";
  }

  /// How often a feedback object must come.
  unsigned every(const ObjectSpec& object) const {
    const bool measured = object.quantity == drive::Quantity::velocity ||
                          object.quantity == drive::Quantity::torque ||
                          object.quantity == drive::Quantity::position;
    return cyclesIn(measured ? needs_.fresh : kSlow, needs_.cycle);
  }

  Result<void> planInputs() {
    const PackRules limits = rules(PdoDirection::tpdo);
    std::vector<PackItem> items;
    for (const char* name : {"statusword", "position_actual"}) {
      const ObjectSpec* object = profile_.find(name);
      if (object == nullptr || !object->tpdo) {
        return Error{"`" + std::string(name) +
                     "` must be mappable into a TPDO: the axis needs it " + "in every cycle"};
      }
      items.push_back(item(*object, 1));
    }
    auto packed = packPdos(items, limits);
    if (!packed) {
      return Error{"the axis needs " + withBits(items) + " in TPDOs, but " +
                   rulesText(PdoDirection::tpdo) + ": no axis can be run with that"};
    }
    std::vector<std::string> wanted = {"mode_display"};
    wanted.insert(wanted.end(), needs_.feedback.begin(), needs_.feedback.end());
    for (const std::string& name : wanted) {
      const ObjectSpec* object = profile_.find(name);
      if (object == nullptr || contains(items, name)) continue;
      const unsigned often = name == "mode_display" ? 1 : every(*object);
      std::vector<PackItem> wider = items;
      wider.push_back(item(*object, often));
      auto better = object->tpdo ? packPdos(wider, limits) : std::nullopt;
      if (better) {
        packed = better;
        items = wider;
      } else {
        plan_.by_sdo.push_back(name);
      }
    }
    addRiders(limits, items, *packed);
    keep(*packed, PdoDirection::tpdo);
    return {};
  }

  /// What travels only where it costs no PDO.
  void addRiders(PackRules limits, std::vector<PackItem> items, std::vector<PackedPdo>& packed) {
    limits.most = std::min(limits.most, packed.size());
    for (const std::string& name : needs_.if_room) {
      const ObjectSpec* object = profile_.find(name);
      if (object == nullptr || !object->tpdo || contains(items, name)) continue;
      std::vector<PackItem> wider = items;
      wider.push_back(item(*object, every(*object)));
      const auto better = packPdos(wider, limits);
      if (!better) continue;
      packed = *better;
      items = wider;
      plan_.riders.push_back(name);
    }
  }

  void keep(const std::vector<PackedPdo>& packed, PdoDirection direction) {
    for (const PackedPdo& pdo : packed) {
      canopen::PdoLayout layout;
      layout.direction = direction;
      layout.number = pdo.number;
      for (const canopen::PdoLayout& fixed : device_.fixed_pdos) {
        if (fixed.direction == direction && fixed.number == pdo.number) layout = fixed;
      }
      layout.objects = pdo.items;
      if (direction == PdoDirection::rpdo) {
        layout.refresh_every = static_cast<std::uint16_t>(pdo.every);
      } else if (layout.transmission == 1) {  // nobody gave another one
        layout.transmission = static_cast<std::uint8_t>(std::min(pdo.every, kMaxEvery));
      }
      plan_.pdos.push_back(layout);
    }
  }

  const DriveProfile& profile_;
  const canopen::DeviceProfile& device_;
  const PdoNeeds& needs_;
  PdoPlan plan_;
};

}  // namespace

Result<PdoPlan> planPdos(const DriveProfile& profile, const canopen::DeviceProfile& device,
                         const PdoNeeds& needs) {
  return Planner(profile, device, needs).run();
}

}  // namespace cia402::config
