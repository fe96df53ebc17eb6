#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Homing, trajectories and set-points, with the answers a person gets."""
import math

import rospy
from cia402_driver.msg import AxisStates
from control_msgs.msg import FollowJointTrajectoryResult, JointTrajectoryControllerState
from control_msgs.srv import QueryTrajectoryState
from robot_client import OK, WARN, RobotTest, main, wait_until
from tf2_msgs.msg import TFMessage

HOME = {"shoulder": -2.6, "elbow": 0.2906, "wrist": 0.0, "gripper": 0.0}


class Homing(RobotTest):
    """A fresh robot: nothing is homed."""

    def test_1_motion_is_refused_before_enabling_and_homing(self):
        seen = len(self.process.output())
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"], [(1.0, [0.0] * 4)])
        self.wait_log("enable", seen)
        self.succeed("enable")
        seen = len(self.process.output())
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"], [(1.0, [0.0] * 4)])
        self.wait_log("hom", seen)
        self.succeed("disable")

    def test_2_a_single_axis_homes(self):
        self.succeed("wrist/home", "wrist|method 37|position 0.000 rad")
        self.assertTrue(self.robot.wait_axis("wrist", lambda axis: axis.homed, "homed"))
        self.assertFalse(self.robot.axis("shoulder").homed)

    def test_3_all_axes_home_in_their_order(self):
        wait_until(lambda: not any(axis.procedure for axis in self.robot.axis_states.axes), "idle")
        running, shoulder_homed = [], []

        def watch(states):
            for axis in states.axes:
                if axis.procedure == "home" and axis.name not in running:
                    running.append(axis.name)
                    shoulder_homed.append(any(other.name == "shoulder" and other.homed
                                              for other in states.axes))
        subscriber = rospy.Subscriber("/robot/axis_states", AxisStates, watch)
        self.succeed("home", "home done on 4 of 4 axes|shoulder: homed by method 17|"
                     "elbow: homed by method 33|gripper: homed by declaring")
        subscriber.unregister()
        self.assertEqual(running[0], "shoulder")  # order 1
        self.assertIn("elbow", running)           # order 2
        self.assertTrue(shoulder_homed[running.index("elbow")])
        for joint, place in HOME.items():
            self.robot.wait_at(joint, place, 0.02)


class Motion(RobotTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.robot.call("home")

    def setUp(self):
        for axis in self.AXES:
            self.robot.wait_rest(axis)
            if self.robot.axis(axis).mode not in ("", "cyclic_position"):
                self.succeed(f"{axis}/set_mode", mode="csp")
        self.succeed("enable")

    def results(self):
        """What becomes of the group's trajectories from now on."""
        found = []
        subscriber = rospy.Subscriber("/robot/arm/command_result", FollowJointTrajectoryResult,
                                      found.append)
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: subscriber.get_num_connections() > 0, "a publisher of results")
        return found

    def test_trajectory_reaches_its_goal(self):
        goal = {"shoulder": -1.8, "elbow": -0.3, "wrist": 0.8, "gripper": 0.6}
        middle = [-2.2, 0.0, 0.4, 0.3]
        results = self.results()
        self.robot.follow(list(goal), [(0.8, middle), (1.8, list(goal.values()))])
        worst = {}

        def arrived():
            state = self.robot.group_state
            for joint, error in zip(state.joint_names, state.error.positions):
                worst[joint] = max(worst.get(joint, 0.0), abs(error))
            return all(abs(self.robot.position(joint) - place) < 0.005
                       for joint, place in goal.items())
        wait_until(lambda: self.robot.group_state, "state of the group")
        wait_until(arrived, "all joints at the goal")
        self.assertEqual(sorted(worst), self.AXES)
        self.assertTrue(all(error < 0.2 for error in worst.values()), worst)
        self.assertTrue(any(error > 1e-4 for error in worst.values()), worst)
        wait_until(lambda: results, "the result")
        self.assertEqual(results[0].error_code, FollowJointTrajectoryResult.SUCCESSFUL)
        self.assertIn("arm: goal reached", results[0].error_string)

    def test_query_state_tells_where_the_joints_will_be(self):
        states = []
        subscriber = rospy.Subscriber("/robot/arm/state", JointTrajectoryControllerState, states.append)
        self.addCleanup(subscriber.unregister)
        query = rospy.ServiceProxy("/robot/arm/query_state", QueryTrajectoryState)
        wait_until(lambda: states, "states of the group")
        results = self.results()
        start = self.robot.position("shoulder")
        goal = [start + (0.8 if start < -1.5 else -0.8), 0.0, 0.0, 0.0]
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"], [(3.0, goal)])
        wait_until(lambda: abs(self.robot.position("shoulder") - start) > 0.05, "it moves")
        then = rospy.Time.now() + rospy.Duration(0.5)
        told = query(then)
        self.assertEqual(list(told.name), list(states[-1].joint_names))
        at = told.name.index("shoulder")
        wait_until(lambda: states[-1].header.stamp > then, "the time has come")
        before = [state for state in states if state.header.stamp <= then][-1]
        after = next(state for state in states if state.header.stamp > then)
        self.assertLess((after.header.stamp - before.header.stamp).to_sec(), 0.5)
        for shown in ("desired", "actual"):  # what was commanded then, and where the motor was
            places = sorted(getattr(state, shown).positions[at] for state in (before, after))
            slack = 0.002 if shown == "desired" else 0.05
            self.assertLess(places[0] - slack, told.position[at])
            self.assertGreater(places[1] + slack, told.position[at])
        self.assertGreater(abs(told.velocity[at]), 0.1)
        wait_until(lambda: results, "the result")
        self.assertEqual(query(rospy.Time.now()).position[at], goal[0])
        with self.assertRaisesRegex(rospy.ServiceException, "arm: .*is not known any more"):
            query(rospy.Time.now() - rospy.Duration(3600.0))

    def test_trajectory_with_unknown_joints_or_beyond_limits_is_refused(self):
        results = self.results()
        seen = len(self.process.output())
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"], [(3.0, [0.0, 2.5, 0.0, 0.0])])
        self.wait_log("elbow|2.5|2", seen)
        seen = len(self.process.output())
        self.robot.follow(["shoulder", "neck", "wrist", "gripper"], [(3.0, [0.0] * 4)])
        self.wait_log("neck", seen)
        wait_until(lambda: len(results) == 2, "both results")
        self.assertEqual([result.error_code for result in results],
                         [FollowJointTrajectoryResult.INVALID_GOAL,
                          FollowJointTrajectoryResult.INVALID_JOINTS])
        self.assertIn("elbow", results[0].error_string)
        self.assertIn("neck", results[1].error_string)

    def test_set_point_in_cyclic_position_is_followed_within_limits(self):
        for axis, place in (("wrist", -0.5), ("gripper", 0.4)):
            self.robot.command(axis, place)
            self.robot.wait_at(axis, place, 0.005)

    def test_velocity_is_followed_and_stops_when_the_stream_dries_up(self):
        self.succeed("wrist/set_mode", "cyclic_velocity", mode="csv")
        self.succeed("wrist/enable")
        before = self.robot.position("wrist")
        self.robot.stream("wrist", 0.5, lambda: self.robot.position("wrist") > before + 0.2,
                          "wrist turns")
        place = self.robot.wait_rest("wrist")
        self.assertLess(place, before + 1.5)
        self.assertEqual(self.robot.axis("wrist").state, "operation enabled")
        self.robot.wait_diagnostic("wrist", WARN, "stream of velocities ended")
        self.succeed("wrist/disable")
        self.robot.wait_diagnostic("wrist", OK)

    def test_profile_position_makes_its_own_way(self):
        self.succeed("elbow/set_mode", "profile_position", mode="pp")
        self.assertEqual(self.robot.wait_axis(
            "elbow", lambda axis: axis.mode == "profile_position", "pp").mode, "profile_position")
        self.succeed("elbow/enable")
        for place in (0.6, -0.2):
            self.robot.command("elbow", place)
            self.robot.wait_at("elbow", place, 0.005)
        self.robot.wait_axis("elbow", lambda axis: axis.target_reached, "target reached")

    def test_profile_velocity_turns_and_stops(self):
        self.succeed("wrist/set_mode", "profile_velocity", mode="profile_velocity")
        self.succeed("wrist/enable")
        before = self.robot.position("wrist")
        self.robot.stream("wrist", -0.5, lambda: self.robot.position("wrist") < before - 0.2,
                          "wrist turns")
        self.robot.wait_rest("wrist")

    def test_unknown_mode_is_refused_with_the_modes_there_are(self):
        self.refuse("wrist/set_mode", "wrist|sideways|profile_position|cyclic_position",
                    mode="sideways")
        self.assertEqual(self.robot.axis("wrist").mode, "cyclic_position")

    def test_damiao_changes_its_mode_and_follows(self):
        self.succeed("gripper/disable")
        self.succeed("gripper/set_mode", "cyclic_velocity", mode="csv")
        self.succeed("gripper/enable")
        before = self.robot.position("gripper")
        self.robot.stream("gripper", 0.4,
                          lambda: abs(self.robot.position("gripper") - before) > 0.1,
                          "gripper turns")
        self.robot.wait_rest("gripper")
        self.succeed("gripper/disable")

    def test_quick_stop_stops_and_takes_the_power(self):
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"],
                          [(4.0, [-1.0, 0.0, 0.0, 0.0])])
        before = self.robot.position("shoulder")
        wait_until(lambda: abs(self.robot.position("shoulder") - before) > 0.05, "it moves")
        self.succeed("quick_stop")
        self.robot.wait_rest("shoulder")
        for axis in self.AXES:
            self.robot.wait_axis(axis, lambda state: state.state != "operation enabled", "off")

    def test_halt_stops_and_keeps_the_power(self):
        before = self.robot.position("shoulder")
        goal = -0.5 if before < -1.5 else -2.5
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"],
                          [(20.0, [goal, 0.0, 0.5, 0.0])])
        wait_until(lambda: abs(self.robot.position("shoulder") - before) > 0.05, "it moves")
        self.succeed("shoulder/halt", "shoulder: halted at ")
        place = self.robot.wait_rest("shoulder")
        self.assertGreater(abs(place - goal), 0.1, "it went on to the goal")
        self.assertEqual(self.robot.axis("shoulder").state, "operation enabled")

    def test_a_halted_axis_is_shown_as_such_until_enable_releases_it(self):
        self.succeed("wrist/halt", "wrist: halted at ")
        self.robot.wait_axis("wrist", lambda axis: axis.halted, "halted")
        self.assertFalse(self.robot.axis("elbow").halted)
        status = self.robot.wait_diagnostic("wrist", OK, "halted until `enable`")
        self.assertIn(("halted", "yes"), [(value.key, value.value) for value in status.values])
        self.succeed("wrist/enable")
        self.robot.wait_axis("wrist", lambda axis: not axis.halted, "released")

        def released():
            status = self.robot.diagnostic("wrist")
            return ("halted", "no") in [(value.key, value.value) for value in status.values]
        wait_until(released, "diagnostics of a released axis")
        self.assertNotIn("halted", self.robot.diagnostic("wrist").message)

    def test_set_position_declares_where_the_axis_stands(self):
        self.succeed("wrist/disable")
        before = self.robot.wait_rest("wrist")
        self.succeed("wrist/set_position", "wrist", position=before + 0.25)
        self.robot.wait_at("wrist", before + 0.25, 0.002)
        self.succeed("wrist/set_position", position=before)


class Turntable(RobotTest):
    """A joint that turns without end; the 32 bits of its drive wrap at 8.04 rad, within a turn."""

    CONFIG = "test/ros/turntable.yaml"
    AXES = ["table"]
    FASTEST = 1.05 * 1.5  # rad/s

    def assert_no_step(self, places, difference):
        """@param places (stamp, rad) in their order"""
        self.assertGreater(len(places), 10)
        for (before, start), (after, end) in zip(places, places[1:]):
            self.assertLessEqual(abs(difference(end, start)),
                                 self.FASTEST * (after - before).to_sec() + 1e-3,
                                 f"from {start} at {before} to {end} at {after}")

    def test_no_joint_state_and_no_transform_has_a_step_where_the_drive_wraps(self):
        turned = []

        def take(message):
            for transform in message.transforms:
                if transform.child_frame_id == "plate":
                    turn = transform.transform.rotation
                    turned.append((transform.header.stamp, 2.0 * math.atan2(turn.z, turn.w)))
        subscriber = rospy.Subscriber("/tf", TFMessage, take)
        self.succeed("enable")
        self.robot.record = True
        for place in (8.8, 7.3):
            self.robot.command("table", place)
            self.robot.wait_at("table", place)
        self.robot.record = False
        subscriber.unregister()
        places = [(message.header.stamp, message.position[0])
                  for _, message in self.robot.joint_states]
        self.assertGreater(max(place for _, place in places), 8.7)
        self.assert_no_step(places, lambda end, start: end - start)
        self.assert_no_step(turned, lambda end, start: math.remainder(end - start, 2.0 * math.pi))


if __name__ == "__main__":
    main("motion")
