#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What a running node offers is what docs/interface.md lists: no more, no less, of those types.
The keys of a robot's file are compared by test/config/documented_keys_test.cpp."""
import os
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree

import rosgraph
import rosservice
from robot_client import Robot, executable, main, package_file

AXES, GROUPS = ["shoulder", "elbow", "wrist", "tool", "gripper"], ["arm"]
PLACES = {"bus": [""], "axis": AXES, "group": GROUPS}
OF_EACH_NODE = {"/rosout", "/bus/get_loggers", "/bus/set_logger_level"}
ACTION = {"goal": "ActionGoal", "cancel": None, "status": None, "feedback": "ActionFeedback",
          "result": "ActionResult"}  # None: those of actionlib_msgs
OF_ACTIONLIB = {"cancel": "actionlib_msgs/GoalID", "status": "actionlib_msgs/GoalStatusArray"}


def chapter(title):
    with open(package_file("docs/interface.md"), encoding="utf-8") as file:
        return file.read().split(f"\n## {title}\n")[1].split("\n## ")[0]


def section(title):
    """The lines of a section of bus_node's chapter."""
    return chapter("bus_node").split(f"\n### {title}\n")[1].split("\n###")[0].splitlines()


def rows(title, lines=None):
    """The cells of the rows of a section's tables, without their heads."""
    cells = [[cell.strip() for cell in line.strip("|").split(" |")]
             for line in lines or section(title) if line.startswith("| `")]
    assert cells, f"docs/interface.md has no table below {title}"
    return cells


def names_of(text):
    return re.findall(r"`([^`]+)`", text)


def expand(name):
    """A name of the document as those of the node."""
    name = re.sub("^~", "/bus/", name)
    name = name if name.startswith("/") else "/" + name
    for place, those in (("<axis>", AXES), ("<group>", GROUPS)):
        if place in name:
            return [name.replace(place, one) for one in those]
    return [name]


def documented_arguments():
    """{launch file: {argument: default, None where the document does not tell it}}"""
    files = {}
    for cells in rows("Launch files", chapter("Launch files").splitlines()):
        told = re.findall(r"`([^`]+)`(?: \(([\w.]+)(?:[:)]|$))?", cells[1].split(";")[0])
        files[names_of(cells[0])[0]] = {name: default or None for name, default in told}
    return files


def launch_arguments(name):
    """{argument: default, None where it has none} of a launch file of the package."""
    tree = xml.etree.ElementTree.parse(package_file(f"launch/{name}"))
    return {arg.get("name"): arg.get("default") for arg in tree.getroot().findall("arg")}


def documented_topics():
    """{topic: type}"""
    topics = {}
    for cells in rows("Topics"):
        for name in expand(names_of(cells[0])[0]):
            if not cells[2].startswith("action"):
                topics[name] = cells[1]
                continue
            for part, suffix in ACTION.items():
                topics[f"{name}/{part}"] = cells[1] + suffix if suffix else OF_ACTIONLIB[part]
    return topics


def documented_services():
    """{service: type}"""
    services = {}
    for cells in rows("Services"):
        names = names_of(cells[0])
        kinds = cells[2].split(", ")
        package = kinds[0].split("/")[0]
        for number, name in enumerate(names):
            kind = kinds[number].split("/")[-1] if len(kinds) == len(names) else \
                kinds[0].split("/")[-1]
            for place in cells[1].split(", "):
                for whose in PLACES[place]:
                    services[f"/bus/{whose}/{name}".replace("//", "/")] = f"{package}/{kind}"
    return services


class Interface(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot("bus", "arm")
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        cls.robot.close()

    def test_topics(self):
        master = rosgraph.Master("/interface")
        published, subscribed, _ = master.getSystemState()
        types = dict(master.getTopicTypes())
        offered = {topic: types[topic] for topic, nodes in published + subscribed
                   if "/bus" in nodes and topic not in OF_EACH_NODE}
        self.assertEqual(offered, documented_topics())

    def test_services(self):
        offered = {name: rosservice.get_service_type(name)
                   for name in rosservice.get_service_list(node="/bus") if name not in OF_EACH_NODE}
        self.assertEqual(offered, documented_services())

    def test_services_under_load_are_all_of_them(self):
        """The load test, which takes long, calls what it has arguments for."""
        sys.path.insert(0, package_file("test/load"))
        from arguments import SERVICES  # pylint: disable=import-outside-toplevel,import-error
        offered = {name.rsplit("/", 1)[-1] for name in rosservice.get_service_list(node="/bus")
                   if name not in OF_EACH_NODE}
        # A simulated bus alone offers inject_fault.
        self.assertEqual(offered | {"inject_fault"}, set(SERVICES))

    def test_parameters_of_the_node_itself(self):
        told = subprocess.run([executable("bus_node"), "--help"], stdout=subprocess.PIPE, text=True,
                              timeout=60, check=True).stdout
        offered = dict(re.findall(r"(?m)^  _(\w+):=(\S+)", told))
        documented = {names_of(cells[0])[0].lstrip("~"): cells[1] for cells in rows("Parameters")}
        self.assertEqual(set(offered), set(documented))
        for name, default in documented.items():  # in capitals: what has none
            self.assertEqual(default, "" if offered[name].isupper() else offered[name], name)

    def test_launch_files_and_their_arguments(self):
        documented = documented_arguments()
        self.assertEqual(set(documented), set(os.listdir(package_file("launch"))))
        for name, arguments in documented.items():
            offered = launch_arguments(name)
            self.assertEqual(set(arguments), set(offered), name)
            for argument, default in arguments.items():
                word = re.fullmatch(r"\w+", offered[argument] or "")  # paths are told in words
                self.assertEqual(default, offered[argument] if word else None,
                                 f"{argument} of {name}")

    def test_services_of_a_group_concern_its_axes(self):
        answer = self.robot.call("arm/enable")
        self.assertTrue(answer.success, answer.message)
        self.assertIn(f"enable done on {len(AXES)} of {len(AXES)} axes", answer.message)
        for axis in AXES:
            self.robot.wait_state(axis, "operation enabled")
        answer = self.robot.call("arm/set_mode", mode="sideways")
        self.assertFalse(answer.success)
        self.assertIn("set_mode done on 0 of 5 axes", answer.message)
        answer = self.robot.call("arm/disable")
        self.assertTrue(answer.success, answer.message)
        for axis in AXES:
            self.robot.wait_state(axis, "switch on disabled")


if __name__ == "__main__":
    main("interface")
