#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Parameters that change while the node runs: by ~reload, and by dynamic_reconfigure's own client."""
import os
import subprocess

import rospy
from control_msgs.msg import FollowJointTrajectoryResult
from dynamic_reconfigure.client import Client, DynamicReconfigureParameterException
from robot_client import DEADLINE, RobotTest, main, wait_until

JOINTS = ["shoulder", "elbow", "wrist", "gripper"]
NEAR, FAR = [-2.0, 0.0, 0.2, 0.1], [-0.8, 0.6, 0.8, 0.5]
GOAL_TIME = "groups/arm/constraints/goal_time"
# Debian has it in a folder that rosrun does not know; it is no program of PATH anywhere.
DYNPARAM = next((path for path in ("/usr/lib/dynamic_reconfigure/dynparam",
                                   "/opt/ros/noetic/lib/dynamic_reconfigure/dynparam")
                 if os.path.exists(path)), "dynparam")
PATH = "groups/arm/constraints/shoulder/trajectory"


class Reload(RobotTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.client = Client("/robot", timeout=DEADLINE)
        cls.client.get_configuration(timeout=DEADLINE)
        cls.results = []
        cls.subscriber = rospy.Subscriber("/robot/arm/command_result", FollowJointTrajectoryResult,
                                          cls.results.append)
        wait_until(lambda: cls.subscriber.get_num_connections() > 0, "command_result is heard")

    @classmethod
    def tearDownClass(cls):
        cls.client.close()
        super().tearDownClass()

    def setUp(self):
        self.given = rospy.get_param("/robot")

    def tearDown(self):
        self.robot.call("inject_fault", axis="shoulder", fault="clear")
        self.robot.call("disable")
        for name in ("/robot", "/robot_description", "/robot_description_planning"):
            if rospy.has_param(name):
                rospy.delete_param(name)
        rospy.set_param("/robot", self.given)
        self.succeed("reload")

    def limit(self, axis, key, value):
        rospy.set_param(f"/robot/axes/{axis}/limits/{key}", value)

    def follow(self, positions, seconds):
        self.results.clear()
        self.robot.follow(JOINTS, [(seconds, positions)])

    def move(self, positions):
        self.follow(positions, 3.0)
        wait_until(lambda: self.results, "the trajectory ends")
        self.assertEqual(self.results[0].error_code, 0, self.results[0].error_string)

    def wait_moving(self):
        before = self.robot.position("shoulder")
        wait_until(lambda: abs(self.robot.position("shoulder") - before) > 0.05, "it moves")

    def test_nothing_changes_where_nothing_has(self):
        self.succeed("reload", "nothing has changed")

    def describe(self, velocity):
        """A robot_description of the shoulder alone."""
        rospy.set_param("/robot_description", f"""
            <robot name="r"><link name="a"/><link name="b"/>
              <joint name="shoulder" type="revolute"><parent link="a"/><child link="b"/>
                <limit lower="-9" upper="9" velocity="{velocity}" effort="0"/></joint></robot>""")

    def test_the_stricter_limits_of_robot_description_and_joint_limits_count(self):
        before = self.succeed("shoulder/read_object", object="profile_velocity").number
        own = self.given["axes"]["shoulder"]["limits"]["velocity"]
        self.describe(own / 2.0)
        self.succeed("reload", f"axes/shoulder/limits/velocity: {own} -> {own / 2.0:g}")
        now = self.succeed("shoulder/read_object", object="profile_velocity").number
        self.assertAlmostEqual(now, before / 2.0, delta=1.0)
        limits = "/robot_description_planning/joint_limits/shoulder"
        rospy.set_param(limits, {"has_velocity_limits": True, "max_velocity": own / 4.0})
        self.succeed("reload", f"axes/shoulder/limits/velocity: {own / 2.0:g} -> {own / 4.0:g}")
        rospy.set_param("/robot/limits_from_parameters", False)
        self.succeed("reload", f"axes/shoulder/limits/velocity: {own / 4.0:g} -> {own}")

    def test_a_robot_description_that_cannot_be_read_is_refused(self):
        rospy.set_param("/robot_description", "<robot")
        self.refuse("reload", "robot_description: is no URDF")

    def test_a_limit_changes_while_all_axes_are_disabled(self):
        before = self.succeed("shoulder/read_object", object="profile_velocity").number
        old = self.given["axes"]["shoulder"]["limits"]["velocity"]
        self.limit("shoulder", "velocity", old / 2.0)
        self.home_and_enable()
        self.refuse("reload", "only while all axes are disabled|axes/shoulder/limits/velocity: "
                    f"{old} -> {old / 2.0}|not disabled")
        self.assertEqual(self.succeed("shoulder/read_object", object="profile_velocity").number, before)
        self.succeed("disable")
        self.succeed("reload", f"changed: axes/shoulder/limits/velocity: {old} -> {old / 2.0}")
        now = self.succeed("shoulder/read_object", object="profile_velocity").number
        self.assertAlmostEqual(now, before / 2.0, delta=1.0)
        self.assertTrue(self.robot.axis("shoulder").homed, "it has lost its zero")
        self.succeed("reload", "nothing has changed")

    def test_what_takes_a_restart_says_why_and_the_rest_changes(self):
        rospy.set_param("/robot/axes/shoulder/node_id", 77)
        rospy.set_param("/robot/groups/arm/constraints/goal_time", 2.5)
        self.refuse("reload", f"changed: {GOAL_TIME}: |-> 2.5|needs a restart of the node: "
                    "axes/shoulder/node_id|-> 77, because the identifiers")
        self.assertEqual(self.client.get_configuration(timeout=DEADLINE)[GOAL_TIME], 2.5)
        self.refuse("reload", "needs a restart of the node: axes/shoulder/node_id")

    def test_a_mistake_anywhere_changes_nothing(self):
        rospy.set_param("/robot/groups/arm/constraints/goal_time", 2.5)
        self.limit("elbow", "upper", -100.0)
        rospy.set_param("/robot/axes/wrist/colour", "red")
        self.refuse("reload", "nothing was changed: 2 problems|axes/elbow/limits/upper|greater than lower|"
                    "axes/wrist/colour")
        self.assertNotEqual(self.client.get_configuration(timeout=DEADLINE)[GOAL_TIME], 2.5)

    def test_a_tolerance_acts_while_the_joints_move(self):
        self.home_and_enable()
        self.move(NEAR)
        self.follow(FAR, 20.0)
        self.wait_moving()
        self.assertEqual(self.results, [])
        answer = self.client.update_configuration({PATH: 1e-6})
        self.assertEqual(answer[PATH], 1e-6, answer["last_change"])
        wait_until(lambda: self.results, "the trajectory ends")
        self.assertEqual(self.results[0].error_code,
                         FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        self.assertIn("shoulder", self.results[0].error_string)
        self.assertIn("the tolerance is 1e-06", self.results[0].error_string)
        self.assertLess(self.robot.wait_rest("shoulder"), FAR[0] - 0.05, "it went on to its goal")
        self.assertEqual(rospy.get_param(f"/robot/{PATH}"), 1e-6)
        self.succeed("reload", "nothing has changed")

    def test_a_refused_value_is_answered_with_the_reason_and_the_old_one_stays(self):
        old = self.client.get_configuration(timeout=DEADLINE)[GOAL_TIME]
        answer = self.client.update_configuration({GOAL_TIME: -1.0})
        self.assertEqual(answer[GOAL_TIME], old)
        self.assert_words(answer["last_change"], f"nothing was changed|{GOAL_TIME}: must be at least 0")
        both = self.client.update_configuration({GOAL_TIME: 3.0, "joint_state_rate": 0.0})
        self.assertEqual(both[GOAL_TIME], old, "half of a change")
        self.assertIn("joint_state_rate", both["last_change"])
        with self.assertRaises(DynamicReconfigureParameterException):
            self.client.update_configuration({"axes/shoulder/limits/velocity": 1.0})

    def test_the_rate_of_joint_states_follows(self):
        def period():
            stamps = set()
            while len(stamps) < 12:
                stamps.add(self.robot.joint_state.header.stamp)
                rospy.sleep(0.002)
            return (max(stamps) - min(stamps)).to_sec() / (len(stamps) - 1)
        self.assertLess(period(), 0.1)
        answer = self.client.update_configuration({"joint_state_rate": 5.0})
        self.assertEqual(answer["joint_state_rate"], 5.0, answer["last_change"])
        rospy.sleep(0.4)
        self.assertGreater(period(), 0.15)

    def test_dynparam_lists_and_sets(self):
        def dynparam(*words):
            return subprocess.run([DYNPARAM, *words], stdout=subprocess.PIPE, text=True, check=True,
                                  timeout=DEADLINE).stdout
        shown = dynparam("get", "/robot")
        self.assertIn(GOAL_TIME, shown)
        self.assertIn("last_change", shown)
        dynparam("set", "/robot", GOAL_TIME, "0.75")
        self.assertEqual(rospy.get_param(f"/robot/{GOAL_TIME}"), 0.75)
        self.assertIn(f"'{GOAL_TIME}': 0.75", dynparam("get", "/robot"))


if __name__ == "__main__":
    main("reload")
