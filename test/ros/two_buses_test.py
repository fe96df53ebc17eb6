#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""One robot on two buses: the joints of both nodes make one tree of frames."""
import unittest

import rospy
import tf2_ros
from robot_client import Robot, main, wait_until
from sensor_msgs.msg import JointState

JOINTS = {"lift": 0.1, "turn": 0.4, "pan": -0.6, "tilt": 0.0}  # where to
HEAD = (0.3, 0.0, 0.68)  # in the base, with all joints at 0


class TwoBuses(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.places = {}
        cls.states = rospy.Subscriber(
            "/joint_states", JointState,
            lambda message: cls.places.update(zip(message.name, message.position)))
        cls.column, cls.head = Robot("column", "column"), Robot("head", "head")
        cls.frames = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.frames)

    @classmethod
    def tearDownClass(cls):
        cls.listener.unregister()
        cls.states.unregister()
        cls.column.close()
        cls.head.close()

    def test_all_joints_of_both_buses_come_out_in_one_tree(self):
        for node in (self.column, self.head):
            wait_until(lambda node=node: node.bus_state and all(n.ready for n in node.bus_state.nodes),
                       "the drives are ready")
            answer = node.call("home")
            self.assertTrue(answer.success, answer.message)
        wait_until(lambda: self.at("camera", (HEAD[0] + 0.09, HEAD[1], HEAD[2])),
                   lambda: f"the camera where all joints are at 0\n{self.told()}")
        for axis, place in JOINTS.items():
            node = self.column if axis in ("lift", "turn") else self.head
            node.command(axis, place)
        wait_until(lambda: set(JOINTS) <= set(self.places) and all(
            abs(self.places[joint] - place) < 1e-3 for joint, place in JOINTS.items()),
            lambda: f"all joints at {JOINTS}, but {self.places}")
        # 0.3 m at 0.4 rad, then 0.09 m at 0.4 - 0.6 rad
        wait_until(lambda: self.at("camera", (0.36452, 0.09895, 0.78)),
                   lambda: f"the camera where the joints of both buses bring it\n{self.told()}")

    def told(self):
        return self.frames.all_frames_as_yaml()

    def at(self, frame, place):
        """Is the newest place of a frame that one?"""
        try:
            where = self.frames.lookup_transform("base", frame, rospy.Time()).transform.translation
        except tf2_ros.TransformException:
            return False
        return all(abs(a - b) < 1e-3 for a, b in zip((where.x, where.y, where.z), place))


if __name__ == "__main__":
    main("two_buses")
