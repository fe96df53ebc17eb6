#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The demo robot on vcan0: five drive families in a process of their own, bus_node in another. Where a
motor stands is read from its drive's own TPDO."""
import time

from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import JointTrajectoryControllerState
from demo_robot import (ERROR, JOINTS, OK, DemoRobotTest, main, point_goal, rospy,  # noqa: E402
                        wait_until)

PLACES = [{"shoulder": -1.6, "elbow": -0.4, "wrist": 0.8, "tool": 0.5, "gripper": 0.6},
          {"shoulder": -0.9, "elbow": 0.5, "wrist": -0.4, "tool": -0.3, "gripper": -0.5}]


class DemoRobot(DemoRobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    def travel_to(self, places):
        """A trajectory of all joints, until the motors have turned by what they had to. It is sent
        anew where a late cycle of this machine has ended it."""
        expected = {joint: self.told(joint)[1] + places[joint] - self.robot.position(joint)
                    for joint in JOINTS}

        def there():
            return all(abs(self.robot.position(joint) - places[joint]) < 0.01 for joint in JOINTS)

        def moves():
            return any(abs(self.robot.axis(joint).velocity) > 0.05 for joint in JOINTS)
        for _ in range(5):
            self.succeed("enable")
            self.robot.follow(JOINTS, [(4.0, [places[joint] for joint in JOINTS])])
            wait_until(lambda: moves() or there(), "it moves")
            for joint in JOINTS:
                self.robot.wait_rest(joint)
            if there():
                break
        for joint in JOINTS:
            self.assertAlmostEqual(self.told(joint)[1], expected[joint], delta=0.01, msg=joint)
            self.assertAlmostEqual(self.robot.position(joint), places[joint], delta=0.01, msg=joint)

    def test_1_all_families_boot_and_are_left_without_power(self):
        self.robot.wait_ready(120.0)
        self.assertEqual(self.robot.bus_state.interface, "vcan0")
        for joint in JOINTS:
            self.assertEqual(self.robot.axis(joint).state, "switch on disabled")
            self.assertFalse(self.powered(joint), joint)

    def test_2_each_finds_its_home(self):
        self.robot.wait_ready()
        self.succeed("home", "home done on 5 of 5 axes")
        for joint in JOINTS:
            self.robot.wait_axis(joint, lambda axis: axis.homed, "homed")

    def test_3_all_motors_go_where_one_trajectory_leads_them(self):
        self.travel_to(PLACES[0])
        for joint in JOINTS:
            self.assertTrue(self.powered(joint), joint)

    def test_4_a_fault_is_told_in_words_and_ends_by_clear_faults(self):
        self.succeed("enable")
        self.inject("elbow", "overvoltage")
        self.robot.wait_diagnostic("elbow", ERROR, "elbow (node 2)|0xFF02|over-voltage|clear_faults")
        for joint in JOINTS:
            self.robot.wait_rest(joint)
            self.assertEqual(self.powered(joint), joint != "elbow", joint)
        self.inject("elbow", "clear")
        wait_until(lambda: self.robot.call("elbow/clear_faults").success, "cleared")
        self.assertFalse(self.powered("elbow"))
        self.succeed("elbow/enable")
        self.robot.wait_diagnostic("elbow", OK)
        self.travel_to(PLACES[1])

    def test_5_an_action_is_followed_by_all_families(self):
        worst = {}

        def note(state):
            for joint, error in zip(state.joint_names, state.error.positions):
                worst[joint] = max(worst.get(joint, 0.0), abs(error))
        self.succeed("enable")
        client = self.client()
        start = {joint: self.robot.position(joint) for joint in JOINTS}
        subscriber = rospy.Subscriber("/robot/arm/state", JointTrajectoryControllerState, note)
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: len(worst) == len(JOINTS), "states of the group")
        expected = {joint: self.told(joint)[1] + PLACES[0][joint] - self.robot.position(joint)
                    for joint in JOINTS}
        for _ in range(5):  # a late cycle of this machine ends it
            self.succeed("enable")
            worst.clear()
            client.send_goal(point_goal(PLACES[0], 5.0))
            self.assertTrue(client.wait_for_result(rospy.Duration(100.0)), "a result")
            if client.get_state() == GoalStatus.SUCCEEDED:
                break
        self.assertEqual(client.get_state(), GoalStatus.SUCCEEDED, client.get_result())
        for joint in JOINTS:
            # Its largest velocity, in the middle, and by how much motor and feedback are late: three
            # cycles of 20 ms, and a lag of the motor; twice that on a machine whose timers are late.
            fastest = 1.5 * abs(PLACES[0][joint] - start[joint]) / 5.0
            print(f"{joint}: {worst[joint]:.4f} rad off its path at most, at {fastest:.3f} rad/s")
            self.assertLess(worst[joint], fastest * 0.12 + 0.003, joint)
            self.assertAlmostEqual(self.told(joint)[1], expected[joint], delta=0.01, msg=joint)

    def test_6_a_cancel_brings_all_motors_to_rest(self):
        client = self.client()
        for _ in range(5):  # a late cycle of this machine ends it before
            self.succeed("enable")
            before = self.told("shoulder")[1]
            client.send_goal(point_goal(PLACES[1], 5.0))
            wait_until(lambda: abs(self.told("shoulder")[1] - before) > 0.1, "it moves")
            client.cancel_goal()
            self.assertTrue(client.wait_for_result(rospy.Duration(100.0)), "a result")
            if client.get_state() == GoalStatus.PREEMPTED:
                break
        self.assertEqual(client.get_state(), GoalStatus.PREEMPTED, client.get_result())
        stood = {joint: self.told(joint)[1] for joint in JOINTS}
        time.sleep(0.5)
        for joint in JOINTS:
            self.assertAlmostEqual(self.told(joint)[1], stood[joint], delta=0.002, msg=joint)
            self.assertTrue(self.powered(joint), joint)
        self.assertGreater(abs(self.robot.position("shoulder") - PLACES[1]["shoulder"]), 0.1)


if __name__ == "__main__":
    main("demo")
