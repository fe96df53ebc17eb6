#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""A base on two simulated wheels: cmd_vel in, odometry and tf out, as launch/diff_drive.launch has it.

What the wheels did is taken from the drives themselves (their position objects, read by SDO, which the
simulated motors count), not from what the nodes tell each other.
"""
import math
import threading
import time
import unittest

import rospy
import tf2_ros
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from robot_client import Robot, main, wait_until
from rosgraph_msgs.msg import Log

SEPARATION, RADIUS = 0.40, 0.10  # launch/diff_drive.launch
COUNTS = 8388608 * 10.0 / (2 * math.pi)  # a rad of the wheel, config/robots/mobile_base.yaml
SIGNS = {"left_wheel": 1, "right_wheel": -1}


class DiffDrive(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.odom, cls.odoms, cls.logs = None, [], []
        cls.robot = Robot("bus", "wheels")
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        cls.commands = rospy.Publisher("/cmd_vel", Twist, queue_size=1)
        cls.subscribers = [rospy.Subscriber("/odom", Odometry, cls.on_odom),
                           rospy.Subscriber("/rosout", Log, lambda log: cls.logs.append(log.msg))]
        cls.robot.wait_ready()
        wait_until(lambda: cls.odom and cls.commands.get_num_connections(), "odometry")
        answer = cls.robot.call("enable")
        assert answer.success, answer.message

    @classmethod
    def on_odom(cls, message):
        cls.odom = message
        cls.odoms.append(message)

    def setUp(self):
        self.wanted = None
        self.stopped = threading.Event()
        self.thread = threading.Thread(target=self.publish, daemon=True)
        self.thread.start()

    def tearDown(self):
        self.stopped.set()
        self.thread.join()
        self.wait_rest()

    def publish(self):
        """Says what is wanted, 50 times a second."""
        while not self.stopped.wait(0.02):
            if self.wanted is not None:
                twist = Twist()
                twist.linear.x, twist.angular.z = self.wanted
                self.commands.publish(twist)

    def wheel(self, joint):
        """rad, as the drive counts, which its 32 bits hold all through these tests."""
        answer = self.robot.call(f"{joint}/read_object", object="position_actual")
        self.assertTrue(answer.success, answer.message)
        return SIGNS[joint] * answer.number / COUNTS

    def speed(self, joint):
        states = self.robot.joint_state
        return states.velocity[states.name.index(joint)]

    def wait_rest(self):
        wait_until(lambda: all(abs(self.speed(joint)) < 0.005 for joint in SIGNS), "rest")
        time.sleep(0.3)

    def pose(self):
        pose = self.odom.pose.pose
        return (pose.position.x, pose.position.y,
                2 * math.atan2(pose.orientation.z, pose.orientation.w))

    def said(self, words):
        return sum(words in text for text in self.logs)

    def drive(self, linear, angular, until):
        self.wanted = (linear, angular)
        wait_until(until, lambda: f"driven; {self.odom}")
        self.wanted = (0.0, 0.0)
        self.wait_rest()
        self.wanted = None

    def check_against_motors(self, before, wheels_before):
        """The way of the odometry in its own arcs is that of the motors: by length and by heading."""
        left, right = (self.wheel(joint) - wheels_before[joint] for joint in SIGNS)
        heading = (right - left) * RADIUS / SEPARATION
        self.assertLess(abs(math.remainder(self.pose()[2] - before[2] - heading, 2 * math.pi)), 2e-3)
        return (left + right) / 2 * RADIUS, heading

    def test_1_drives_straight(self):
        before, wheels = self.pose(), {joint: self.wheel(joint) for joint in SIGNS}
        self.drive(0.4, 0.0, lambda: self.pose()[0] - before[0] > 0.5)
        way, heading = self.check_against_motors(before, wheels)
        x, y, _ = self.pose()
        self.assertLess(abs(heading), 2e-3)
        self.assertLess(abs(math.hypot(x - before[0], y - before[1]) - way), 2e-3)
        print(f"straight: {way:.4f} m by the motors, {math.hypot(x - before[0], y - before[1]):.4f} m told")

    def test_2_turns_on_the_spot(self):
        before, wheels = self.pose(), {joint: self.wheel(joint) for joint in SIGNS}
        self.drive(0.0, 1.0, lambda: self.pose()[2] - before[2] > 1.5)
        way, heading = self.check_against_motors(before, wheels)
        self.assertGreater(heading, 1.5)
        self.assertLess(abs(way), 2e-3)
        self.assertLess(math.hypot(self.pose()[0] - before[0], self.pose()[1] - before[1]), 2e-3)
        print(f"turn: {heading:.4f} rad by the motors, {self.pose()[2] - before[2]:.4f} rad told")

    def test_3_drives_arcs_back_too_and_tf_is_the_same(self):
        before, wheels = self.pose(), {joint: self.wheel(joint) for joint in SIGNS}
        self.drive(-0.3, 0.6, lambda: math.hypot(self.pose()[0] - before[0],
                                                 self.pose()[1] - before[1]) > 0.3)
        way, heading = self.check_against_motors(before, wheels)
        self.assertLess(way, -0.3)
        chord = way * math.sin(heading / 2) / (heading / 2)  # the curve is kept through both ramps
        along = before[2] + heading / 2
        self.assertLess(abs(before[0] + chord * math.cos(along) - self.pose()[0]), 5e-3)
        self.assertLess(abs(before[1] + chord * math.sin(along) - self.pose()[1]), 5e-3)
        wait_until(lambda: self.buffer.can_transform("odom", "base_link", rospy.Time()), "tf")
        told = self.buffer.lookup_transform("odom", "base_link", rospy.Time()).transform
        self.assertLess(abs(told.translation.x - self.pose()[0]), 1e-3)
        self.assertLess(abs(told.translation.y - self.pose()[1]), 1e-3)
        stamps = [odom.header.stamp for odom in self.odoms]
        self.assertEqual(stamps, sorted(set(stamps)))
        self.assertEqual(self.odom.header.frame_id, "odom")
        self.assertEqual(self.odom.child_frame_id, "base_link")
        self.assertEqual(self.odom.pose.covariance[35], 0.03)

    def test_4_stops_by_its_watchdog(self):
        told = self.said("cmd_vel has not come for 0.5 s")
        self.wanted = (0.5, 0.0)
        wait_until(lambda: abs(self.speed("left_wheel") - 5.0) < 0.1, "5 rad/s")
        first = self.wheel("left_wheel")
        self.wanted = None
        self.wait_rest()
        wait_until(lambda: self.said("cmd_vel has not come for 0.5 s") == told + 1, "the warning")
        stood = self.wheel("left_wheel")
        self.assertGreater(stood - first, 1.0)
        time.sleep(0.5)
        self.assertLess(abs(self.wheel("left_wheel") - stood), 1e-4, "it stands")
        self.assertEqual(self.said("cmd_vel has not come for 0.5 s"), told + 1, "once")
        self.assertEqual(self.said("stream of velocities ended without a zero"), 0,
                         "it has not left that to the driver")

    def test_5_refuses_what_is_no_number(self):
        before = self.wheel("left_wheel")
        for wanted in ((math.nan, 0.0), (0.0, math.inf), (-math.inf, math.nan)):
            self.wanted = wanted
            time.sleep(0.3)
        wait_until(lambda: self.said("cmd_vel refused: linear.x"), "the refusal")
        self.wanted = None
        self.assertLess(abs(self.wheel("left_wheel") - before), 1e-4)

    def test_6_stops_where_a_wheel_is_lost(self):
        self.wanted = (0.4, 0.0)
        wait_until(lambda: abs(self.speed("left_wheel") - 4.0) < 0.1, "4 rad/s")
        answer = self.robot.call("inject_fault", axis="right_wheel", fault="silent")
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: self.said("the position of right_wheel is not known"), "what is lost")
        wait_until(lambda: abs(self.speed("left_wheel")) < 0.005, "the left wheel at rest")
        self.wanted = None
        self.robot.call("inject_fault", axis="right_wheel", fault="clear")
        wait_until(lambda: self.robot.call("recover").success, "both wheels back")


if __name__ == "__main__":
    main("wheels")
