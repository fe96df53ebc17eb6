// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "campaign/shrinker.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace cia402::campaign {
namespace {

/// Delta debugging, one kind of cut after the other until none helps any more.
class Shrinker {
 public:
  Shrinker(Scene scene, const Shows& shows, int tries)
      : scene_(std::move(scene)), shows_(shows), tries_(tries) {}

  Scene shrink() {
    for (bool better = true; better && tries_ > 0;) {
      better = dropActions();
      better = dropAxes() || better;
      better = dropKeys() || better;
      better = shortenWaits() || better;
      better = roundTimes() || better;
    }
    return scene_;
  }

 private:
  bool take(Scene candidate) {
    if (tries_-- <= 0 || !shows_(candidate)) return false;
    scene_ = std::move(candidate);
    return true;
  }

  /// Ever smaller runs of actions.
  bool dropActions() {
    bool better = false;
    for (std::size_t run = std::max<std::size_t>(scene_.actions.size() / 2, 1);; run /= 2) {
      for (std::size_t from = scene_.actions.size(); from > 0;) {
        from = from > run ? from - run : 0;
        if (from >= scene_.actions.size()) continue;
        Scene candidate = scene_;
        const auto first = candidate.actions.begin() + static_cast<std::ptrdiff_t>(from);
        const auto left = static_cast<std::size_t>(candidate.actions.end() - first);
        candidate.actions.erase(first, first + static_cast<std::ptrdiff_t>(std::min(run, left)));
        better = take(std::move(candidate)) || better;
      }
      if (run <= 1) return better;
    }
  }

  bool dropAxes() {
    bool better = false;
    for (const std::string& name : axisNames()) {
      Scene candidate = scene_;
      YAML::Node tree = YAML::Load(candidate.robot);
      if (tree["axes"].size() < 2) return better;
      tree["axes"].remove(name);
      dropJoint(tree, name);
      candidate.robot = YAML::Dump(tree);
      auto& actions = candidate.actions;
      actions.erase(
          std::remove_if(actions.begin(), actions.end(),
                         [&](const Action& a) { return a.words.size() > 1 && a.words[1] == name; }),
          actions.end());
      better = take(std::move(candidate)) || better;
    }
    return better;
  }
  std::vector<std::string> axisNames() const {
    std::vector<std::string> names;
    const YAML::Node tree = YAML::Load(scene_.robot);
    for (const auto& axis : tree["axes"]) names.push_back(axis.first.as<std::string>());
    return names;
  }
  static void dropJoint(YAML::Node& tree, const std::string& name) {
    std::vector<std::string> empty;
    for (auto group : tree["groups"]) {
      YAML::Node left(YAML::NodeType::Sequence);
      for (const YAML::Node& joint : group.second["joints"]) {
        if (joint.as<std::string>() != name) left.push_back(joint);
      }
      left.SetStyle(YAML::EmitterStyle::Flow);
      group.second["joints"] = left;
      if (left.size() == 0) empty.push_back(group.first.as<std::string>());
    }
    for (const std::string& group : empty) tree["groups"].remove(group);
    if (tree["groups"] && tree["groups"].size() == 0) tree.remove("groups");
  }

  /// Options of axes and bus that do not matter.
  bool dropKeys() {
    bool better = dropKeysOf({"bus"});
    better = dropKeysOf({}) || better;
    for (const std::string& name : axisNames()) {
      better = dropKeysOf({"axes", name}) || better;
      better = dropKeysOf({"axes", name, "simulation"}) || better;
      better = dropKeysOf({"axes", name, "homing"}) || better;
      better = dropKeysOf({"axes", name, "limits"}) || better;
    }
    return better;
  }
  /// Without it something else goes wrong: there is nothing to judge by, no switch to home to, a
  /// count is a leap, or a velocity is refused, be it the drive's own.
  static bool judges(const std::string& key) {
    static const std::vector<std::string> kKeys = {"limits",
                                                   "velocity",
                                                   "acceleration",
                                                   "gear_ratio",
                                                   "simulation",
                                                   "home_switch",
                                                   "lower_limit_switch",
                                                   "upper_limit_switch",
                                                   "unwatched_streams",
                                                   "search_velocity"};
    return std::find(kKeys.begin(), kKeys.end(), key) != kKeys.end();
  }
  bool dropKeysOf(const std::vector<std::string>& path) {
    bool better = false;
    for (const std::string& key : keysOf(path)) {
      if (judges(key)) continue;
      Scene candidate = scene_;
      YAML::Node tree = YAML::Load(candidate.robot);
      YAML::Node node = at(tree, path);
      node.remove(key);
      if (key == "homing" || node.size() > 0) {
        candidate.robot = YAML::Dump(tree);
        better = take(std::move(candidate)) || better;
      }
    }
    return better;
  }
  std::vector<std::string> keysOf(const std::vector<std::string>& path) const {
    std::vector<std::string> keys;
    YAML::Node tree = YAML::Load(scene_.robot);
    const YAML::Node node = at(tree, path);
    if (!node || !node.IsMap()) return keys;
    for (const auto& pair : node) keys.push_back(pair.first.as<std::string>());
    return keys;
  }
  static YAML::Node at(const YAML::Node& tree, const std::vector<std::string>& path) {
    YAML::Node node;
    node.reset(tree);
    for (const std::string& key : path) {
      if (!node.IsMap() || !node[key]) return YAML::Node(YAML::NodeType::Undefined);
      node.reset(node[key]);
    }
    return node;
  }

  /// What follows a wait comes earlier.
  bool shortenWaits() {
    bool better = false;
    for (std::size_t i = 0; i < scene_.actions.size(); ++i) {
      const Duration before =
          i == 0 ? Duration(std::chrono::milliseconds(1500)) : scene_.actions[i - 1].at;
      for (double share : {1.0, 0.7, 0.4}) {
        const Duration gap = scene_.actions[i].at - before;
        if (gap < std::chrono::milliseconds(i == 0 ? 100 : 20)) break;
        const Duration cut = fromSeconds(toSeconds(gap) * share);
        Scene candidate = scene_;
        for (std::size_t j = i; j < candidate.actions.size(); ++j) candidate.actions[j].at -= cut;
        if (take(std::move(candidate))) {
          better = true;
          break;
        }
      }
    }
    return better;
  }

  bool roundTimes() {
    bool better = false;
    for (std::int64_t grid : {100'000'000, 10'000'000, 1'000'000}) {
      Scene candidate = scene_;
      for (Action& action : candidate.actions) {
        action.at = Duration((action.at.count() + grid / 2) / grid * grid);
      }
      if (writeScene(candidate) == writeScene(scene_)) return better;
      if (take(std::move(candidate))) return true;
    }
    return better;
  }

  Scene scene_;
  const Shows& shows_;
  int tries_;
};

}  // namespace

Scene shrink(Scene scene, const Shows& shows, int tries) {
  return Shrinker(std::move(scene), shows, tries).shrink();
}

}  // namespace cia402::campaign
