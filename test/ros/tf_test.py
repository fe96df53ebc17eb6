#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What the node tells tf is what robot_state_publisher makes of joint_states and the description."""
import unittest

import rospy
from robot_client import Process, Robot, main, package_file, wait_until
from ros_tool import Tool, node_of
from tf2_msgs.msg import TFMessage

FRAMES = ["finger", "forearm", "hand", "tool", "upper_arm"]  # that joints move
PLACES = [  # of the joints; rad
    {"shoulder": 0.3, "elbow": -0.5, "wrist": 1.0, "tool": -0.7, "gripper": 0.4},
    {"shoulder": -1.2, "elbow": 1.1, "wrist": -1.0, "tool": 0.9, "gripper": -1.0},
    {"shoulder": 1.1, "elbow": -1.6, "wrist": 0.9, "tool": 2.2, "gripper": 1.3},
]
SAME = 1e-6  # m, and parts of a quaternion


def place_of(transform):
    place = transform.transform.translation
    return [place.x, place.y, place.z]


def turn_of(transform):
    turn = transform.transform.rotation
    return [turn.x, turn.y, turn.z, turn.w]


def farthest(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def difference(a, b):
    """The largest one of two transforms; a frame in another parent is far off."""
    if a.header.frame_id != b.header.frame_id:
        return float("inf")
    turn = turn_of(a)
    return max(farthest(place_of(a), place_of(b)),
               min(farthest(q, turn_of(b)) for q in (turn, [-part for part in turn])))  # the same


class Teller:
    """What one node tells of each frame."""

    def __init__(self, topic):
        self.all = []
        self.newest = {}
        self._subscriber = rospy.Subscriber(topic, TFMessage, self._on_message, queue_size=1000)

    def _on_message(self, message):
        for transform in message.transforms:
            self.all.append(transform)
            self.newest[transform.child_frame_id] = transform

    def close(self):
        self._subscriber.unregister()


class Transforms(unittest.TestCase):
    def setUp(self):
        with open(package_file("config/robots/demo.urdf"), encoding="ascii") as urdf:
            rospy.set_param("robot_description", urdf.read())
        self.own, self.own_static = Teller("/tf"), Teller("/tf_static")
        self.other, self.other_static = Teller("/other/tf"), Teller("/other/tf_static")
        self.publisher = Tool("publisher", node_of("robot_state_publisher", "robot_state_publisher"),
                              "tf:=other/tf", "tf_static:=other/tf_static")
        self.publisher.wait_listens("/joint_states")
        self.process = Process("bus_node", "robot", "config/robots/demo.yaml")
        self.robot = Robot()

    def tearDown(self):
        self.robot.close()
        self.process.stop()
        self.publisher.stop()
        for teller in (self.own, self.own_static, self.other, self.other_static):
            teller.close()

    def agree(self):
        return all(frame in self.own.newest and frame in self.other.newest and
                   difference(self.own.newest[frame], self.other.newest[frame]) < SAME
                   for frame in FRAMES)

    def there(self, places):
        return all(abs(self.robot.position(joint) - place) < 0.01 for joint, place in places.items())

    def test_they_are_those_of_robot_state_publisher(self):
        self.robot.wait_ready()
        for name in ("home", "enable"):
            answer = self.robot.call(name)
            self.assertTrue(answer.success, answer.message)
        for places in PLACES:
            self.robot.follow(list(places), [(4.0, list(places.values()))])
            wait_until(lambda places=places: self.there(places) and self.agree(),
                       lambda places=places: f"{places}\n{self.own.newest}\n{self.other.newest}")
        self.assertEqual(sorted(self.own.newest), FRAMES)
        self.compare_in_motion()
        self.assertEqual(list(self.own_static.newest), ["tip"])
        self.assertLess(difference(self.own_static.newest["tip"], self.other_static.newest["tip"]),
                        SAME)

    def compare_in_motion(self):
        """Of the joint that told last, joint_states and tf have the same stamp."""
        others = {(transform.child_frame_id, transform.header.stamp): transform
                  for transform in list(self.other.all)}
        pairs = [(transform, others[(transform.child_frame_id, transform.header.stamp)])
                 for transform in list(self.own.all)
                 if (transform.child_frame_id, transform.header.stamp) in others]
        for own, other in pairs:
            self.assertLess(difference(own, other), SAME, f"{own}\n{other}")
        turns = {tuple(round(part, 3) for part in turn_of(own)) for own, _ in pairs}
        self.assertGreater(len(turns), 20, "different turns that were compared")


if __name__ == "__main__":
    main("tf")
