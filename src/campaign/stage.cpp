// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/stage.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "campaign/joints.h"
#include "campaign/random.h"
#include "sim/dictionary/axis_objects.h"

namespace cia402::campaign {
namespace {

constexpr double kNearSwitch = 0.05;  // turns of the shaft
constexpr Duration kForEver = std::chrono::hours(1);

/// Whether the drive does anything about the loss of its master (6007h or by its nature).
bool watchesMaster(const sim::DriveDefinition& definition, const sim::ObjectDictionary& objects) {
  const bool told = objects.find({0x1016, 1}) != nullptr || objects.find({0x100D, 0}) != nullptr;
  if (!told) return false;
  return definition.master_lost != sim::ConnectionLoss::none ||
         objects.find({0x6007, 0}) != nullptr;
}

AxisFacts factsOf(const Loaded& loaded, std::size_t index) {
  const config::RobotConfig& robot = loaded.robot;
  const drive::AxisConfig& axis = robot.axes[index];
  const canopen::DeviceConfig& device = robot.deviceOf(axis);
  AxisFacts facts;
  facts.name = axis.name;
  facts.index = index;
  facts.config = &axis;
  facts.node_id = device.node_id;
  facts.place = sim::findAxis(loaded.drives, axis.name).value();
  const drive::AxisGeometry& geometry = axis.geometry;
  const bool linear = geometry.prismatic();
  const double ratio = axis.profile->output_shaft ? 1.0 : geometry.gear_ratio;
  facts.units_per_turn = (linear ? geometry.lead : kTwoPi) / ratio * geometry.direction;
  if (!axis.profile->output_shaft) {
    facts.units_per_count = facts.units_per_turn / geometry.counts_per_turn;
    const auto unit = axis.profile->units.find(drive::Quantity::torque);
    const double scale = unit == axis.profile->units.end() ? 1.0 : unit->second.scale;
    facts.effort_per_count =
        geometry.rated_torque * 1e-3 * scale * kTwoPi / std::fabs(facts.units_per_turn);
  }
  facts.velocity = axis.limits.velocity.value_or(1.0);
  facts.acceleration = axis.limits.acceleration.value_or(linear ? 0.5 : 5.0);
  facts.master_timeout = device.error_control.master_timeout.value_or(3 * robot.bus.heartbeat);
  if (axis.homing) {
    const int method = axis.homing->method.value_or(37);
    facts.homes_by_moving = method != 35 && method != 37;
    facts.homing_timeout = axis.homing->timeout;
  }
  return facts;
}

std::vector<DriveFacts> drivesOf(const Loaded& loaded, const std::vector<AxisFacts>& axes) {
  std::vector<DriveFacts> drives(loaded.drives.size());
  for (const AxisFacts& axis : axes) {
    drives[axis.place.drive].node_id = axis.node_id;
    drives[axis.place.drive].axes.push_back(axis.index);
  }
  return drives;
}

/// The objects of a drive itself count as those of its axis 0.
std::vector<PdoPlace> pdosOf(const Loaded& loaded, const std::vector<AxisFacts>& axes,
                             canopen::PdoDirection direction) {
  std::vector<PdoPlace> places;
  for (const AxisFacts& axis : axes) {
    for (const canopen::NodeConfig& node : loaded.master.nodes) {
      if (node.node_id != axis.node_id) continue;
      for (const canopen::PdoConfig& pdo : node.pdos) {
        if (pdo.direction != direction || !pdo.enabled) continue;
        unsigned bit = 0;
        for (const canopen::PdoEntry& entry : pdo.entries) {
          const bool own = sim::axisOf(entry.object, sim::kMostAxes) == axis.place.axis;
          if (own && bit % 8 == 0)
            places.push_back({pdo.cob_id, entry.object, axis.index, bit / 8});
          bit += entry.bits;
        }
      }
    }
  }
  return places;
}

const PdoPlace* statuswordOf(const AxisFacts& axis, const std::vector<PdoPlace>& tpdos) {
  const fieldbus::ObjectId object = sim::ofAxis({0x6041, 0}, axis.place.axis);
  const auto found = std::find_if(tpdos.begin(), tpdos.end(), [&](const PdoPlace& place) {
    return place.axis == axis.index && place.object == object;
  });
  return found == tpdos.end() ? nullptr : &*found;
}

/// `~` takes a key away.
void merge(YAML::Node onto, const YAML::Node& more) {
  for (const auto& pair : more) {
    const auto key = pair.first.as<std::string>();
    if (pair.second.IsNull()) {
      onto.remove(key);
    } else if (pair.second.IsMap() && onto[key] && onto[key].IsMap()) {
      merge(onto[key], pair.second);
    } else {
      onto[key] = pair.second;
    }
  }
}

/// Axes with `profile_keys` get a profile of their own: that of their drive with these keys on top,
/// in a file for as long as this lives. Axes that say the same share it, as those of one drive
/// must.
class OwnProfiles {
 public:
  OwnProfiles(YAML::Node robot, const std::string& folder) {
    for (auto pair : robot["axes"]) {
      YAML::Node axis = pair.second;
      if (!axis.IsMap() || !axis["profile_keys"]) continue;
      const auto drive = axis["drive"].as<std::string>();
      std::filesystem::path& file = files_[drive + '\n' + YAML::Dump(axis["profile_keys"])];
      if (file.empty()) {
        YAML::Node profile = YAML::LoadFile(folder + drive + ".yaml");
        merge(profile, axis["profile_keys"]);
        file = std::filesystem::temp_directory_path() /
               ("cia402_campaign_" + std::to_string(getpid()) + "_" + pair.first.as<std::string>() +
                ".yaml");
        std::ofstream(file) << profile;
      }
      axis.remove("profile_keys");
      if (!axis["simulation"]["drive"]) axis["simulation"]["drive"] = drive;
      axis["drive"] = file.string();
    }
  }
  ~OwnProfiles() {
    std::error_code ignored;
    for (const auto& own : files_) std::filesystem::remove(own.second, ignored);
  }
  OwnProfiles(const OwnProfiles&) = delete;
  OwnProfiles& operator=(const OwnProfiles&) = delete;

 private:
  std::map<std::string, std::filesystem::path> files_;  // by profile and keys
};

double asFloat(std::uint64_t number) {
  const auto bits = static_cast<std::uint32_t>(number);
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return static_cast<double>(value);
}

}  // namespace

Result<Loaded> loadRobot(const std::string& yaml, const std::string& config_folder) try {
  Loaded loaded;
  Problems problems;
  YAML::Node tree = YAML::Load(yaml);
  const OwnProfiles own(tree, config_folder + "/drives/");
  loaded.robot = config::loadRobot(tree, config::profilesIn({config_folder + "/drives"}), problems);
  if (problems.empty()) loaded.master = config::makeMasterConfig(loaded.robot, problems);
  if (problems.empty()) {
    loaded.drives =
        sim::simulatedDrives(loaded.robot, config_folder + "/simulated_drives", problems);
  }
  if (!problems.empty()) return Error{problems.text()};
  return loaded;
} catch (const YAML::Exception& exception) {
  return Error{exception.what()};
}

Duration AxisFacts::stopTime(double speed) const {
  return std::max(fromSeconds(1.2 * std::fabs(speed) / acceleration + 0.15), longest_joint_stop);
}

Stage::Stage(Loaded loaded, std::uint64_t seed)
    : loaded_(std::move(loaded)),
      world_(loaded_.robot.bus.bitrate, seed),
      host_(world_, loaded_.robot, loaded_.master) {
  sim::addTo(world_, loaded_.drives);
  for (std::size_t i = 0; i < loaded_.robot.axes.size(); ++i) {
    facts_.push_back(factsOf(loaded_, i));
    if (!watchesMaster(*loaded_.drives[facts_[i].place.drive].definition,
                       driveOf(i).dictionary())) {
      facts_[i].watches_master = false;
      facts_[i].master_timeout = kForEver;
    }
    const auto entry = [&](std::uint16_t object) {
      return driveOf(i).dictionary().find(sim::ofAxis({object, 0}, facts_[i].place.axis));
    };
    objects_.push_back({entry(0x6064), entry(0x6077)});
  }
  joints_ = jointsOf(loaded_.robot, facts_);
  drives_ = drivesOf(loaded_, facts_);
  rpdos_ = pdosOf(loaded_, facts_, canopen::PdoDirection::rpdo);
  tpdos_ = pdosOf(loaded_, facts_, canopen::PdoDirection::tpdo);
  for (const AxisFacts& axis : facts_) statuswords_.push_back(statuswordOf(axis, tpdos_));
  for (AxisFacts& axis : facts_) {
    axis.loss_coasts = coasts(axis.index, "master_lost") || coasts(axis.index, "sync_lost");
    axis.limit_coasts = coasts(axis.index, "positive_limit_switch");
  }
  const config::BusConfig& bus = loaded_.robot.bus;
  if (bus.external_sync) {
    sync_.connect(world_.addParticipant("sync", sync_));
    sync_.start({bus.sync_period, static_cast<std::uint8_t>(bus.sync_counter), {}, 0x80}, now());
  }
}

const drive::ModeSpec* Stage::modeOf(std::size_t axis, int number) const {
  const drive::ModeSpec* const shown =
      host_.running() ? driver()->axis(axis).state().mode : nullptr;
  if (shown != nullptr && shown->value == number) return shown;
  const auto& modes = facts_[axis].config->profile->modes;
  const auto found = std::find_if(modes.begin(), modes.end(), [&](const drive::ModeSpec& mode) {
    return mode.value == number;
  });
  return found == modes.end() ? nullptr : &*found;
}

const sim::FaultDefinition* Stage::fault(std::size_t axis, const std::string& name) const {
  return loaded_.drives[facts_[axis].place.drive].definition->fault(name);
}

bool Stage::coasts(std::size_t axis, const std::string& name) {
  const sim::FaultDefinition* const known = fault(axis, name);
  if (known == nullptr || known->warning) return false;
  const auto lets_go = [](sim::Ramp ramp) {
    return ramp == sim::Ramp::coast || ramp == sim::Ramp::dynamic_brake;
  };
  if (known->reaction_by) return true;
  if (known->reaction) return lets_go(*known->reaction);
  const sim::AxisPlace& place = facts_[axis].place;
  const sim::OptionTable& table = loaded_.drives[place.drive].definition->fault_reaction;
  const sim::Entry* const option =
      driveOf(axis).dictionary().find(sim::ofAxis({0x605E, 0}, place.axis));
  const auto chosen =
      table.options.find(option == nullptr ? table.fallback : sim::asSigned(*option));
  return chosen != table.options.end() && lets_go(chosen->second.ramp);
}

const AxisFacts* Stage::find(const std::string& name) const {
  for (const AxisFacts& facts : facts_) {
    if (facts.name == name) return &facts;
  }
  return nullptr;
}

const config::GroupConfig* Stage::group(const std::string& name) const {
  for (const config::GroupConfig& group : loaded_.robot.groups) {
    if (group.name == name) return &group;
  }
  return nullptr;
}

std::vector<std::size_t> Stage::named(const std::string& name) const {
  std::vector<std::size_t> indices;
  const config::GroupConfig* const of = group(name);
  for (const AxisFacts& facts : facts_) {
    const bool within =
        of != nullptr &&
        std::any_of(of->joints.begin(), of->joints.end(), [&](const std::string& joint) {
          return loaded_.robot.turns(*facts.config, joint);
        });
    if (name == "all" || facts.name == name || within) indices.push_back(facts.index);
  }
  return indices;
}

std::vector<std::size_t> Stage::namedAsOne(const std::string& name) const {
  std::vector<std::size_t> indices = named(name);
  for (std::size_t i = 0; i < indices.size(); ++i) {  // grows
    if (!facts_[indices[i]].gantry) continue;
    for (std::size_t side : facts_[indices[i]].coupled) {
      const bool known = std::find(indices.begin(), indices.end(), side) != indices.end();
      if (!known) indices.push_back(side);
    }
  }
  return indices;
}

std::vector<std::size_t> Stage::drivesNamed(const std::string& name) const {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const auto& axes = drives_[i].axes;
    const bool named = std::any_of(axes.begin(), axes.end(), [&](std::size_t axis) {
      return name == "all" || facts_[axis].name == name;
    });
    if (named) indices.push_back(i);
  }
  return indices;
}

void Stage::look(std::vector<AxisTruth>& truths) {
  truths.resize(facts_.size());
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    const sim::DriveTruth truth = driveOf(i).truth(now(), facts_[i].place.axis);
    AxisTruth& seen = truths[i];
    seen.position = truth.position_turns * facts_[i].units_per_turn;
    seen.velocity = truth.velocity_turns * facts_[i].units_per_turn;
    seen.power = truth.power_stage_on;
    seen.statusword = truth.statusword;
    seen.bad_floats = truth.bad_floats_received;
    seen.nmt = truth.nmt;
    seen.mode = truth.mode;
    seen.told =
        facts_[i].units_per_count == 0.0
            ? asFloat(objects_[i].position->number) *
                  (facts_[i].config->geometry.direction < 0 ? -1.0 : 1.0)
            : static_cast<double>(sim::asSigned(*objects_[i].position)) * facts_[i].units_per_count;
    const sim::AxisMechanics& mechanics = driveOf(i).mechanics(facts_[i].place.axis);
    seen.at_switch = truth.position_turns < mechanics.negative_limit_switch + kNearSwitch ||
                     truth.position_turns > mechanics.positive_limit_switch - kNearSwitch;
    const sim::Entry* const effort = objects_[i].effort;
    if (effort == nullptr) continue;
    seen.effort = facts_[i].effort_per_count == 0.0
                      ? asFloat(effort->number)
                      : static_cast<double>(sim::asSigned(*effort)) * facts_[i].effort_per_count;
  }
}

drive::ControlKind AxisFacts::kind(int mode) const {
  for (const drive::ModeSpec& spec : config->profile->modes) {
    if (spec.value == mode) return spec.kind;
  }
  return drive::ControlKind::homing;
}

}  // namespace cia402::campaign
