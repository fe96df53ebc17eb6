// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "common/text.h"
#include "config/robot_parts.h"

namespace cia402::config {
namespace {

// Axis vectors between them have a direction that is known well.
constexpr double kShortestAxis = 1e-9, kLongestAxis = 1e9;

void readVector(yaml::Section& section, const std::string& key, double (&target)[3]) {
  const auto value = section.get(key);
  const auto numbers = value ? value->numbers(3) : std::nullopt;
  for (std::size_t i = 0; numbers && i < 3; ++i) target[i] = (*numbers)[i];
}

/// A list as its file has it: "[0, 0, 1]".
std::string written(const yaml::Value& list) {
  std::vector<std::string> items;
  for (const yaml::Value& item : list.list()) items.push_back(item.node().Scalar());
  return "[" + joined(items, ", ") + "]";
}

void readJointAxis(yaml::Section& section, FrameConfig& frame) {
  readVector(section, "axis", frame.axis);
  const double length = std::hypot(frame.axis[0], frame.axis[1], frame.axis[2]);
  if (length < kShortestAxis || length > kLongestAxis) {
    const auto value = section.get("axis");
    value->problem(written(*value) + " has no direction, and joint " + frame.joint +
                   " needs one: the axis that it turns about or moves along, such as [0, 0, 1]");
  }
  for (double& component : frame.axis) component /= length;
}

/// The frame of that name, if anything gives it a parent.
const FrameConfig* findChild(const RobotConfig& robot, const std::string& name) {
  for (const auto* frames : {&robot.frames, &robot.static_frames}) {
    for (const FrameConfig& frame : *frames) {
      if (frame.child == name) return &frame;
    }
  }
  return nullptr;
}

void checkName(yaml::Section& section, const std::string& key, const std::string& name) {
  if (name.empty() || name[0] != '/') return;
  section.get(key)->problem("tf knows no names that begin with `/`, such as `" + name +
                            "`: leave it out");
}

/// A frame has one parent, and none of its children for one.
/// @return whether the frame may be added
bool fits(yaml::Section& section, const FrameConfig& frame, const RobotConfig& robot) {
  if (const FrameConfig* other = findChild(robot, frame.child)) {
    section.get("child")->problem(
        "`" + frame.child + "` has the parent `" + other->parent + "` by " +
        (other->joint.empty() ? "static_frames" : "joint " + other->joint) +
        " already, and a frame has one parent: give it another name");
    return false;
  }
  std::string way = frame.child + " in " + frame.parent;
  for (std::string name = frame.parent; name != frame.child;) {
    const FrameConfig* next = findChild(robot, name);
    if (next == nullptr) return true;
    name = next->parent;
    way += " in " + name;
  }
  section.get("parent")->problem("`" + frame.parent + "` makes a ring, where tf has a tree: " +
                                 way + "; name the frame that it is fixed to");
  return false;
}

/// Reads a frame but for its axis, checks it, and adds it to `list`, which is one of the robot's.
void addFrame(yaml::Section& section, FrameConfig frame, const RobotConfig& robot,
              std::vector<FrameConfig>& list) {
  section.read("parent", frame.parent);
  section.read("child", frame.child);
  if (const auto origin = section.get("origin")) {
    yaml::Section origin_section(*origin);
    readVector(origin_section, "xyz", frame.xyz);
    readVector(origin_section, "rpy", frame.rpy);
    origin_section.finish();
  }
  section.finish();
  checkName(section, "parent", frame.parent);
  checkName(section, "child", frame.child);
  const bool named = !frame.parent.empty() && !frame.child.empty();
  if (named && fits(section, frame, robot)) list.push_back(std::move(frame));
}

void readStaticFrames(const yaml::Value& value, RobotConfig& robot) {
  for (const yaml::Value& entry : value.list()) {
    yaml::Section section(entry);
    section.require("parent", "the tf frame that it stands in");
    section.require("child", "its own name in tf");
    if (section.has("axis") || section.has("joint")) {
      section.problem(
          "a static frame does not move: a frame that a joint moves is the `frame` of "
          "its axis");
    }
    addFrame(section, {}, robot, robot.static_frames);
  }
}

}  // namespace

void readFrame(const yaml::Value& value, const std::string& joint, RobotConfig& robot) {
  FrameConfig frame;
  frame.joint = joint;
  yaml::Section section(value);
  section.require("parent", "the tf frame that the joint is fixed to");
  section.require("child", "the tf frame that the joint moves");
  readJointAxis(section, frame);
  addFrame(section, std::move(frame), robot, robot.frames);
}

void readTf(yaml::Section& root, RobotConfig& robot) {
  if (const auto frames = root.get("static_frames")) readStaticFrames(*frames, robot);
  robot.publish_tf = !robot.frames.empty() || !robot.static_frames.empty();
  const auto wanted = root.get("publish_tf");
  const auto said = wanted ? wanted->boolean() : std::nullopt;
  if (!said) return;
  if (*said && !robot.publish_tf) {
    wanted->problem(
        "is true, but there is nothing to tell tf: give an axis its `frame`, list "
        "`static_frames`, or leave publish_tf out");
  }
  robot.publish_tf = *said;
}

}  // namespace cia402::config
