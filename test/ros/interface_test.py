#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What a running node offers is what docs/interface.md lists: no more, no less, of those types."""
import re
import unittest

import rosgraph
import rosservice
from robot_client import Robot, main, package_file

AXES, GROUPS = ["shoulder", "elbow", "wrist", "tool", "gripper"], ["arm"]
PLACES = {"bus": [""], "axis": AXES, "group": GROUPS}
OF_EACH_NODE = {"/rosout", "/bus/get_loggers", "/bus/set_logger_level"}
ACTION = {"goal": "ActionGoal", "cancel": None, "status": None, "feedback": "ActionFeedback",
          "result": "ActionResult"}  # None: those of actionlib_msgs
OF_ACTIONLIB = {"cancel": "actionlib_msgs/GoalID", "status": "actionlib_msgs/GoalStatusArray"}


def section(title):
    """The lines of a section of bus_node's chapter."""
    with open(package_file("docs/interface.md"), encoding="utf-8") as file:
        chapter = file.read().split("\n## bus_node\n")[1].split("\n## ")[0]
    return chapter.split(f"\n### {title}\n")[1].split("\n###")[0].splitlines()


def rows(title):
    """The cells of the rows of a section's tables, without their heads."""
    cells = [[cell.strip() for cell in line.strip("|").split(" | ")]
             for line in section(title) if line.startswith("| `")]
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
