#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Nobody who takes joint_states and tf has anything to complain of: from before the driver starts until it
ends, also while drives are lost and come back."""
import math
import os
import tempfile
import unittest

import rosbag
import rospy
from robot_client import Process, Robot, main, package_file, wait_until
from ros_tool import LISTENER, Complaints, Tool, node_of
from sensor_msgs.msg import JointState

JOINTS = ["elbow", "gripper", "shoulder", "tool", "wrist"]
FRAMES = ["finger", "forearm", "hand", "tool", "upper_arm"]  # that these move
SOME = 20  # messages that must come after each event, so that each tool has taken some


class Takers:
    """The demo robot, whose joint_states are merged, recorded and made transforms of."""

    UNKNOWN = ""  # `unknown_joints`
    NODE_TELLS_TF = False  # else robot_state_publisher does

    def setUp(self):
        with open(package_file("config/robots/demo.urdf"), encoding="ascii") as urdf:
            rospy.set_param("robot_description", urdf.read())
        rospy.set_param("/merger/source_list", ["/measured"])
        rospy.set_param("/merger/rate", 50)
        self.folder = tempfile.TemporaryDirectory()
        self.bag = os.path.join(self.folder.name, "all.bag")
        self.complaints, self.tools = Complaints(), []
        self.states = []
        self.subscriber = rospy.Subscriber("/measured", JointState, self.states.append)
        self.start_tools()
        self.process = Process("bus_node", "robot", "config/robots/demo.yaml",
                               remap=["joint_states:=measured"], unknown_joints=self.UNKNOWN,
                               publish_tf=self.NODE_TELLS_TF)
        self.robot = Robot(joint_states="/measured")

    def start_tools(self):
        publisher = node_of("robot_state_publisher", "robot_state_publisher")
        own = () if not self.NODE_TELLS_TF else ("tf:=unused_tf", "tf_static:=unused_tf_static")
        self.start("listener", LISTENER).wait_listens("/tf", "/tf_static")
        self.start("recorder", node_of("rosbag", "record"), "-O", self.bag, "/measured",
                   "/joint_states", "/tf", "/tf_static").wait_listens("/measured", "/tf")
        self.start("publisher", publisher, "joint_states:=measured", *own).wait_listens("/measured")
        self.start("merger", node_of("joint_state_publisher", "joint_state_publisher")
                   ).wait_listens("/measured").wait_tells("/joint_states")
        self.start("publisher_of_merged", publisher, "tf:=merged_tf",
                   "tf_static:=merged_tf_static").wait_listens("/joint_states")

    def start(self, name, command, *arguments):
        self.tools.append(Tool(name, command, *arguments))
        return self.tools[-1]

    def tearDown(self):
        self.robot.close()
        self.process.stop()
        self.subscriber.unregister()
        for tool in self.tools:
            tool.stop()
        self.complaints.close()
        self.folder.cleanup()

    # Waiting

    def known(self):
        """The joints whose position the last message tells."""
        last = self.states[-1] if self.states else JointState()
        return [name for name, place in zip(last.name, last.position) if not math.isnan(place)]

    def wait_known(self, joints):
        """Until these joints are known, no others, and some messages have told so."""
        wait_until(lambda: sorted(self.known()) == sorted(joints),
                   lambda: f"{joints} are known, but {self.known()} are\n{self.robot.bus_state}")
        if joints or self.UNKNOWN == "nan":
            seen = len(self.states)
            wait_until(lambda: len(self.states) >= seen + SOME, "messages go on")

    def inject(self, axis, fault):
        answer = self.robot.call("inject_fault", axis=axis, fault=fault)
        self.assertTrue(answer.success, answer.message)

    # The story

    def lose_drives_and_get_them_back(self):
        self.robot.wait_ready()
        self.wait_known(JOINTS)
        self.inject("elbow", "silent")
        self.wait_known([joint for joint in JOINTS if joint != "elbow"])
        self.inject("elbow", "clear")
        wait_until(self.robot.recovered, "recovered")
        self.wait_known(JOINTS)
        boots = self.robot.node("wrist").boot_ups
        self.inject("wrist", "power_cycle")
        wait_until(lambda: self.robot.node("wrist").boot_ups > boots, "the boot-up is counted")
        wait_until(self.robot.recovered, "recovered")
        self.wait_known(JOINTS)
        for axis in JOINTS:
            self.inject(axis, "silent")
        wait_until(lambda: all(axis.state == "unknown" for axis in self.robot.axis_states.axes),
                   "all drives are lost")
        self.wait_all_lost()
        for axis in JOINTS:
            self.inject(axis, "clear")
        wait_until(self.robot.recovered, "recovered")
        self.wait_known(JOINTS)

    def wait_all_lost(self):
        raise NotImplementedError

    def run_and_read(self):
        """The story, told to all tools. @return {topic: messages} as they were recorded."""
        self.lose_drives_and_get_them_back()
        self.process.stop()
        recorder = next(tool for tool in self.tools if tool.name == "recorder")
        recorder.stop()
        self.assertEqual(recorder.wait_end(), 0, recorder.complaints())
        recorded = {}
        with rosbag.Bag(self.bag) as bag:
            for topic, message, _ in bag.read_messages():
                recorded.setdefault(topic, []).append(message)
        self.start("second_listener", LISTENER, "tf:=played_tf", "tf_static:=played_tf_static"
                   ).wait_listens("/played_tf")
        player = self.start("player", node_of("rosbag", "play"), "--quiet", "--rate=5", self.bag,
                            "joint_states:=played", "measured:=played_too", "tf:=played_tf",
                            "tf_static:=played_tf_static")
        self.assertEqual(player.wait_end(), 0, player.complaints())
        for tool in self.tools:
            tool.stop()
        return recorded

    @staticmethod
    def of_two_tools(line):
        """rospy: somebody has connected twice, and dropped the one. The second listener begins once
        the driver has ended, so that it was none of its connections."""
        return line.startswith(("second_listener:", "/second_listener:")) and \
            "terminated before handshake header received" in line

    def check(self, recorded):
        told = [line for tool in self.tools for line in tool.complaints()]
        told += self.complaints.of(self.tools)
        self.assertEqual([line for line in told if not self.of_two_tools(line)], [])
        self.assert_rising("measured", [m.header.stamp for m in recorded["/measured"]])
        stamps = {}
        for message in recorded["/tf"]:
            for transform in message.transforms:
                stamps.setdefault(transform.child_frame_id, []).append(transform.header.stamp)
        self.assertEqual(sorted(stamps), FRAMES)
        for frame, those in stamps.items():
            self.assert_rising(frame, those)
            self.assertGreater(len(those), 4 * SOME, frame)
        for message in recorded["/measured"]:
            for values in (message.position, message.velocity, message.effort):
                self.assertIn(len(values), (0, len(message.name)), message)
            self.assertEqual(len(message.position), len(message.name))
        return stamps

    def assert_rising(self, who, stamps):
        for before, after in zip(stamps, stamps[1:]):
            self.assertLess(before, after, who)


class WithUnknownJointsLeftOut(Takers, unittest.TestCase):
    """robot_state_publisher tells tf: it knows no NaN."""

    UNKNOWN = "omit"

    def wait_all_lost(self):
        lost = self.robot.axis_states.header.stamp
        wait_until(lambda: self.robot.axis_states.header.stamp - lost > rospy.Duration(0.5),
                   "states of the axes go on")
        self.assertLess(self.states[-1].header.stamp, lost, "nothing is told where nothing is known")

    def test_nobody_complains(self):
        recorded = self.run_and_read()
        self.check(recorded)
        sizes = {len(message.name) for message in recorded["/measured"]}
        self.assertLessEqual({len(JOINTS) - 1, len(JOINTS)}, sizes)
        self.assertNotIn(0, sizes)
        for message in recorded["/measured"]:
            self.assertFalse(any(map(math.isnan, [*message.position, *message.velocity,
                                                  *message.effort])), message)


class WithNanForUnknownJoints(Takers, unittest.TestCase):
    """The node tells tf."""

    UNKNOWN = "nan"
    NODE_TELLS_TF = True

    def wait_all_lost(self):
        self.wait_known([])

    def test_nobody_complains(self):
        recorded = self.run_and_read()
        stamps = self.check(recorded)
        told = {stamp for those in stamps.values() for stamp in those}
        known, compared = 0, 0
        for message in recorded["/measured"]:
            self.assertEqual(message.name, JOINTS)
            before, known = known, sum(not math.isnan(place) for place in message.position)
            if known >= max(before, 1) and min(told) <= message.header.stamp <= max(told):
                self.assertIn(message.header.stamp, told, "its newest feedback is in tf")
                compared += 1
        self.assertGreater(compared, 4 * SOME)
        self.assertTrue(any(all(map(math.isnan, message.position))
                            for message in recorded["/measured"]))
        (fixed,) = [transform for message in recorded["/tf_static"]
                    for transform in message.transforms]
        self.assertEqual((fixed.header.frame_id, fixed.child_frame_id), ("finger", "tip"))


if __name__ == "__main__":
    main("tools")
