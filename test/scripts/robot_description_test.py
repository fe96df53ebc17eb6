#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The descriptions of robots (URDF) say the same as the files that drive them, and so does docs/moveit.md."""
import pathlib
import re
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
ROBOTS = REPOSITORY / "config/robots"
# A description, and the files of the buses that its joints are on.
DESCRIPTIONS = {"demo.urdf": ["demo.yaml"],
                "two_buses/robot.urdf": ["two_buses/column.yaml", "two_buses/head.yaml"]}
NUMBERS = ("lower", "upper", "velocity")


def axes_of(files):
    """{joint: axis with what it has from `defaults`} of the files of robots."""
    axes = {}
    for file in files:
        robot = yaml.safe_load((ROBOTS / file).read_text(encoding="ascii"))
        for name, axis in robot["axes"].items():
            axes[axis.get("joint", name)] = {**robot.get("defaults", {}), **axis}
    return axes


def joints_of(description):
    """{name: element} of the joints that move."""
    root = ElementTree.parse(ROBOTS / description).getroot()
    return {joint.get("name"): joint for joint in root.iter("joint") if joint.get("type") != "fixed"}


def vector(text):
    return [float(number) for number in text.split()]


def documented(word):
    """The YAML block of docs/moveit.md that has a key at its top."""
    text = (REPOSITORY / "docs/moveit.md").read_text(encoding="utf-8")
    blocks = [yaml.safe_load(block)
              for block in re.findall(r"^```yaml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)]
    found = [block for block in blocks if word in block]
    assert len(found) == 1, f"{len(found)} blocks with {word}"
    return found[0]


class Descriptions(unittest.TestCase):
    def test_they_are_trees_of_links(self):
        for description in DESCRIPTIONS:
            checked = subprocess.run(["check_urdf", ROBOTS / description], stdout=subprocess.PIPE,
                                     stderr=subprocess.STDOUT, text=True, timeout=60, check=False)
            self.assertEqual(checked.returncode, 0, checked.stdout)
            self.assertIn("Successfully Parsed", checked.stdout)

    def test_their_joints_are_those_of_the_buses(self):
        for description, files in DESCRIPTIONS.items():
            joints, axes = joints_of(description), axes_of(files)
            self.assertEqual(sorted(joints), sorted(axes), description)
            for name, axis in axes.items():
                self.assertEqual(joints[name].get("type"), axis.get("type", "revolute"), name)

    def test_their_limits_are_those_of_the_drivers(self):
        for description, files in DESCRIPTIONS.items():
            joints = joints_of(description)
            for name, axis in axes_of(files).items():
                told = {key: float(value) for key, value in joints[name].find("limit").items()}
                self.assertEqual({key: told[key] for key in NUMBERS if key in told},
                                 {key: axis["limits"][key] for key in NUMBERS if key in axis["limits"]},
                                 name)
                # A description must tell an effort. Where the driver limits none it is the rated one.
                effort = axis["limits"].get("effort") or axis["rated_torque"] * axis["gear_ratio"]
                self.assertAlmostEqual(told["effort"], effort, 6, name)

    def test_the_frames_of_the_demo_are_those_that_its_node_tells(self):
        joints = joints_of("demo.urdf")
        for name, axis in axes_of(["demo.yaml"]).items():
            joint, frame = joints[name], axis["frame"]
            origin = joint.find("origin")
            self.assertEqual(joint.find("parent").get("link"), frame["parent"])
            self.assertEqual(joint.find("child").get("link"), frame["child"])
            self.assertEqual(vector(origin.get("xyz")), frame["origin"]["xyz"])
            self.assertEqual(vector(origin.get("rpy", "0 0 0")), frame["origin"].get("rpy", [0, 0, 0]))
            self.assertEqual(vector(joint.find("axis").get("xyz")), frame["axis"])

    def test_the_frames_of_the_demo_that_stand_still_are_its_fixed_joints(self):
        robot = yaml.safe_load((ROBOTS / "demo.yaml").read_text(encoding="ascii"))
        described = [
            {"parent": joint.find("parent").get("link"), "child": joint.find("child").get("link"),
             "origin": {"xyz": vector(joint.find("origin").get("xyz"))}}
            for joint in ElementTree.parse(ROBOTS / "demo.urdf").getroot().iter("joint")
            if joint.get("type") == "fixed"]
        self.assertEqual(robot["static_frames"], described)


class MoveIt(unittest.TestCase):
    def test_its_controllers_are_the_groups_of_the_demo(self):
        robot = yaml.safe_load((ROBOTS / "demo.yaml").read_text(encoding="ascii"))
        (controller,) = documented("controller_list")["controller_list"]
        self.assertEqual((controller["name"], controller["action_ns"], controller["type"]),
                         ("bus/arm", "follow_joint_trajectory", "FollowJointTrajectory"))
        group = robot["groups"]["arm"]
        self.assertEqual(controller["joints"], group["joints"])
        self.assertGreater(controller["allowed_goal_duration_margin"], group["constraints"]["goal_time"])

    def test_its_limits_are_those_of_the_demo(self):
        limits = documented("joint_limits")["joint_limits"]
        axes = axes_of(["demo.yaml"])
        self.assertEqual(sorted(limits), sorted(axes))
        for name, axis in axes.items():
            self.assertTrue(limits[name]["has_velocity_limits"])
            self.assertTrue(limits[name]["has_acceleration_limits"])
            self.assertEqual(limits[name]["max_velocity"], axis["limits"]["velocity"])
            self.assertEqual(limits[name]["max_acceleration"], axis["limits"]["acceleration"])


if __name__ == "__main__":
    unittest.main()
