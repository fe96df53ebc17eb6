#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Goals of the action ~home: what they tell, how they end, and where the axes are then."""
import math
import signal
import time

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus
from cia402_driver.msg import HomeAction, HomeActionGoal, HomeActionResult, HomeGoal
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryGoal,
                              FollowJointTrajectoryResult)
from goal_client import GoalClient
from robot_client import DEADLINE, RobotTest, main, wait_until
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

JOINTS = ["shoulder", "elbow", "wrist", "gripper"]
START = [0.0, 0.4, 0.1, 0.1]  # the shoulder searches for more than 3 s from there
NOT_HOMED = "not homed; home it before position motion"


def trajectory(positions):
    return JointTrajectory(joint_names=JOINTS, points=[JointTrajectoryPoint(
        positions=positions, velocities=[0.0] * 4, time_from_start=rospy.Duration(3))])


class HomeTest(RobotTest):
    def setUp(self):
        self.feedback = []
        self.client = self.make_client()

    def make_client(self, name="home", kind=HomeAction):
        client = GoalClient(f"/robot/{name}", kind)
        self.assertTrue(client.wait_for_server(rospy.Duration.from_sec(DEADLINE)))
        return client

    def send(self, axes=(), order=(), client=None):
        (client or self.client).send_goal(HomeGoal(axes=list(axes), order=list(order)),
                                          feedback_cb=self.feedback.append)

    def result(self, state, words, client=None):
        client = client or self.client
        self.assertTrue(client.wait_for_result(rospy.Duration.from_sec(DEADLINE)))
        result = client.get_result()
        self.assertEqual(GoalStatus.to_string(client.get_state()), GoalStatus.to_string(state),
                         result.message)
        self.assertEqual(result.success, state == GoalStatus.SUCCEEDED)
        self.assert_words(result.message, words)
        return result

    def steps(self, axis):
        """What the feedback has told of an axis, one after another."""
        told = []
        for feedback in self.feedback:
            if axis in feedback.axes:
                step = feedback.steps[feedback.axes.index(axis)]
                if not told or told[-1] != step:
                    told.append(step)
        return told

    def wait_step(self, axis, words):
        wait_until(lambda: self.steps(axis) and words in self.steps(axis)[-1],
                   lambda: f"{axis}: {words}, but {self.steps(axis)}")

    def wait_searching(self):
        """Until the shoulder is on its way."""
        before = self.robot.position("shoulder")
        self.wait_step("shoulder", "searching home")
        wait_until(lambda: abs(self.robot.position("shoulder") - before) > 0.2, "it moves")

    def assert_rests(self):
        """Where they are now they stay."""
        places = {joint: self.robot.position(joint) for joint in JOINTS}
        for joint, place in places.items():
            self.assertAlmostEqual(self.robot.wait_rest(joint), place, delta=0.01, msg=joint)


class NotHomed(HomeTest):
    """A fresh robot."""

    def test_1_motion_is_refused_with_the_remedy_whoever_asks(self):
        self.succeed("enable")
        places = {joint: self.robot.wait_rest(joint) for joint in JOINTS}
        client = self.make_client("arm/follow_joint_trajectory", FollowJointTrajectoryAction)
        client.send_goal(FollowJointTrajectoryGoal(trajectory=trajectory(START)))
        self.assertTrue(client.wait_for_result(rospy.Duration.from_sec(DEADLINE)))
        self.assertEqual(client.get_state(), GoalStatus.REJECTED)
        self.assertIn(NOT_HOMED, client.get_result().error_string)
        results = []
        subscriber = rospy.Subscriber("/robot/arm/command_result", FollowJointTrajectoryResult,
                                      results.append)
        wait_until(lambda: subscriber.get_num_connections() > 0, "a publisher of results")
        self.robot.publisher("arm/command", JointTrajectory).publish(trajectory(START))
        wait_until(lambda: results, "the topic's trajectory is answered")
        self.assertIn(NOT_HOMED, results[0].error_string)
        subscriber.unregister()
        seen = len(self.process.output())
        self.robot.command("shoulder", places["shoulder"] + 0.3)
        self.wait_log("shoulder|" + NOT_HOMED, seen)
        for joint, place in places.items():
            self.assertAlmostEqual(self.robot.wait_rest(joint), place, delta=1e-3, msg=joint)
        self.succeed("disable")

    def test_2_homes_all_in_their_order_and_tells_of_each(self):
        self.send()
        result = self.result(GoalStatus.SUCCEEDED, "home done on 4 of 4 axes|shoulder: homed by "
                             "method 17|gripper: homed by declaring")
        self.assertEqual(result.axes, self.AXES)  # the configuration's, as the node has it
        self.assertEqual(result.homed, [True] * 4)
        for axis, message in zip(result.axes, result.messages):
            self.assertIn(f"{axis}: homed by", message)
        shoulder = self.steps("shoulder")
        self.assertTrue(any("searching home; waits for homing attained (statusword bit 12), "
                            "method 17" in step for step in shoulder), shoulder)
        for feedback in self.feedback:
            self.assertEqual(feedback.axes, self.AXES)
            at = feedback.axes.index("shoulder")
            if "searching home" in feedback.steps[at]:
                self.assertIn("waits for its turn", feedback.steps[feedback.axes.index("elbow")])
                self.assertTrue(math.isnan(feedback.time_left[feedback.axes.index("elbow")]))
                self.assertGreater(feedback.time_left[at], 20.0)
                self.assertLess(feedback.time_left[at], 120.0)
        searched = [(feedback.time_left[2], feedback.positions[2]) for feedback in self.feedback
                    if "searching home" in feedback.steps[2]]  # the shoulder is the third
        self.assertGreater(len(searched), 5)
        self.assertGreater(searched[0][0], searched[-1][0])
        self.assertGreater(max(place for _, place in searched) -
                           min(place for _, place in searched), 0.3)
        self.robot.wait_at("shoulder", -2.6, 0.02)


class Home(HomeTest):
    """A robot that was homed once, so that it can be brought away from its switches."""

    def setUp(self):
        super().setUp()
        for axis in self.AXES:
            self.robot.call("inject_fault", axis=axis, fault="clear")
        self.robot.recovered()
        if not all(axis.homed for axis in self.robot.axis_states.axes):
            self.succeed("home")
        self.succeed("enable")  # which ends a halt, too
        self.robot.follow(JOINTS, [(4.0, START)])
        for joint, place in zip(JOINTS, START):
            self.robot.wait_at(joint, place)
            self.robot.wait_rest(joint)
        self.feedback.clear()

    def test_a_cancel_stops_what_moves_and_begins_no_more(self):
        self.send()
        self.wait_searching()
        self.client.cancel_goal()
        result = self.result(GoalStatus.PREEMPTED, "homing stopped: it was cancelled|"
                             "elbow: not started, for the goal was cancelled")
        self.assertGreater(self.robot.position("shoulder"), -2.5)
        self.assert_rests()
        self.assertAlmostEqual(self.robot.position("elbow"), START[1], delta=0.01)
        self.assertIn("the axis stands at", result.messages[result.axes.index("shoulder")])
        state = self.robot.axis("shoulder")
        self.assertEqual((state.state, state.mode), ("operation enabled", "cyclic_position"))

    def test_homes_in_the_order_of_the_goal(self):
        self.send(["shoulder", "wrist"], [9, -1])
        result = self.result(GoalStatus.SUCCEEDED, "home done on 2 of 2 axes")
        self.assertEqual(result.axes, ["shoulder", "wrist"])
        first = next(feedback for feedback in self.feedback
                     if "searching home" in feedback.steps[0])
        self.assertEqual(first.steps[1], "homed")

    def test_homes_a_group_together(self):
        self.send(["arm"], [0])
        self.wait_step("shoulder", "searching home")
        self.wait_step("wrist", "homed")
        self.assertNotIn("waits for its turn", self.steps("elbow"))
        self.assertEqual(self.result(GoalStatus.SUCCEEDED, "4 of 4").axes, JOINTS)

    def test_is_rejected_with_a_reason(self):
        for axes, order, words in ((["neck"], [], 'no axis or group "neck"'),
                                   (["shoulder", "arm"], [1, 2], "shoulder is named twice"),
                                   (["shoulder"], [1, 2], "2 numbers for 1 names")):
            self.send(axes, order)
            self.assertEqual(self.result(GoalStatus.REJECTED, words).axes, [])
        self.succeed("inject_fault", axis="wrist", fault="0x8611")
        self.robot.wait_state("wrist", "fault")
        self.send()
        result = self.result(GoalStatus.REJECTED, "cannot home: wrist|0x8611|"
                             "shoulder: not started, for another axis cannot")
        self.assertEqual(result.axes, self.AXES)
        self.assertAlmostEqual(self.robot.wait_rest("shoulder"), START[0], delta=0.01)

    def test_a_second_one_for_the_same_axes_is_rejected_and_the_first_goes_on(self):
        self.send(["shoulder", "elbow"])
        self.wait_searching()
        other = self.make_client()
        self.send(["elbow"], client=other)
        self.result(GoalStatus.REJECTED, "one that was called before has not ended, and elbow is "
                    "a part of it", other)
        self.refuse("elbow/home", "one that was called before has not ended")
        self.send(["gripper"], client=other)
        self.result(GoalStatus.SUCCEEDED, "gripper: homed by declaring", other)
        self.assertEqual(self.client.get_state(), GoalStatus.ACTIVE)
        self.result(GoalStatus.SUCCEEDED, "home done on 2 of 2 axes")

    def test_each_of_a_burst_has_its_one_result(self):
        results = {}
        subscriber = rospy.Subscriber(
            "/robot/home/result", HomeActionResult,
            lambda message: results.setdefault(message.status.goal_id.id, []).append(message))
        self.addCleanup(subscriber.unregister)
        publisher = rospy.Publisher("/robot/home/goal", HomeActionGoal, queue_size=200)
        self.addCleanup(publisher.unregister)
        wait_until(lambda: publisher.get_num_connections() > 0 and
                   subscriber.get_num_connections() > 0, "the node at both")
        ids = [f"burst {number}" for number in range(100)]
        self.process.send(signal.SIGSTOP)
        for goal_id in ids:
            publisher.publish(HomeActionGoal(
                goal_id=GoalID(id=goal_id, stamp=rospy.Time.now()),
                goal=HomeGoal(axes=["gripper"])))
        time.sleep(0.5)  # until all are on their way
        self.process.send(signal.SIGCONT)
        wait_until(lambda: set(ids) <= set(results),
                   lambda: f"a result of each, but of {sorted(set(ids) - set(results))}")
        for goal_id in ids:
            self.assertEqual(len(results[goal_id]), 1, goal_id)
            status, message = results[goal_id][0].status, results[goal_id][0].result.message
            if status.status != GoalStatus.SUCCEEDED:
                self.assertEqual(status.status, GoalStatus.REJECTED, message)
                self.assert_words(message, "gripper is a part of it" if "gripper" in message else
                                  "64 goals have not ended yet; wait for their results")
        self.assertEqual(results[ids[0]][0].status.status, GoalStatus.SUCCEEDED)

    def test_is_preempted_by_a_halt(self):
        self.send()
        self.wait_searching()
        self.succeed("shoulder/halt")
        self.result(GoalStatus.PREEMPTED, "home was stopped by halt while searching home|"
                    "elbow: not started, for another axis was stopped")
        self.assertGreater(self.robot.position("shoulder"), -2.5)
        self.assert_rests()

    def test_is_aborted_by_a_fault(self):
        self.send()
        self.wait_searching()
        self.succeed("inject_fault", axis="shoulder", fault="0x7305")
        result = self.result(GoalStatus.ABORTED, "shoulder|0x7305|another axis failed")
        self.assertEqual(result.homed[result.axes.index("elbow")], True)
        self.assertGreater(self.robot.wait_rest("shoulder"), -2.5)
        self.assertAlmostEqual(self.robot.position("elbow"), START[1], delta=0.01)


if __name__ == "__main__":
    main("home")
