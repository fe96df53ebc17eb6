#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Goals of follow_joint_trajectory: how they end, and where the joints are then."""
import actionlib
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryActionGoal,
                              FollowJointTrajectoryActionResult, FollowJointTrajectoryGoal,
                              FollowJointTrajectoryResult, JointTolerance)
from robot_client import DEADLINE, RobotTest, main, wait_until
from trajectory_msgs.msg import JointTrajectoryPoint

JOINTS = ["shoulder", "elbow", "wrist", "gripper"]
ACTION = "/robot/arm/follow_joint_trajectory"
NEAR, FAR = [-2.0, 0.0, 0.2, 0.1], [-0.8, 0.6, 0.8, 0.5]


def goal_of(positions, seconds, joints=None):
    goal = FollowJointTrajectoryGoal()
    goal.trajectory.joint_names = JOINTS if joints is None else joints
    if positions:
        goal.trajectory.points.append(JointTrajectoryPoint(
            positions=positions, velocities=[0.0] * len(positions),
            time_from_start=rospy.Duration.from_sec(seconds)))
    return goal


class Action(RobotTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.robot.call("home")

    def setUp(self):
        self.robot.call("recover")
        self.succeed("enable")  # which ends a halt, too
        self.feedback = []
        self.client = self.make_client()
        self.assertEqual(self.finish(goal_of(NEAR, 3.0)).error_code,
                         FollowJointTrajectoryResult.SUCCESSFUL)

    def make_client(self):
        client = actionlib.SimpleActionClient(ACTION, FollowJointTrajectoryAction)
        self.assertTrue(client.wait_for_server(rospy.Duration.from_sec(DEADLINE)))
        return client

    def send(self, goal, client=None):
        (client or self.client).send_goal(goal, feedback_cb=self.feedback.append)

    def result(self, state, words, client=None):
        client = client or self.client
        self.assertTrue(client.wait_for_result(rospy.Duration.from_sec(DEADLINE)))
        result = client.get_result()
        self.assertEqual(GoalStatus.to_string(client.get_state()), GoalStatus.to_string(state),
                         result.error_string)
        for word in words.split("|"):
            self.assertIn(word, result.error_string)
        return result

    def finish(self, goal):
        self.send(goal)
        return self.result(GoalStatus.SUCCEEDED, "arm: ")

    def wait_moving(self):
        before = self.robot.position("shoulder")
        wait_until(lambda: abs(self.robot.position("shoulder") - before) > 0.05, "it moves")

    def assert_rests(self):
        """Where they are now they stay."""
        places = {joint: self.robot.position(joint) for joint in JOINTS}
        for joint, place in places.items():
            self.assertAlmostEqual(self.robot.wait_rest(joint), place, delta=0.01, msg=joint)

    def assert_stops(self):
        """They may be on their ramps still."""
        for joint, goal in zip(JOINTS, FAR):
            if joint != "gripper":
                self.assertLess(self.robot.wait_rest(joint), goal - 0.05, msg=joint)
        self.assert_rests()

    def test_succeeds_at_its_goal_and_tells_of_the_way(self):
        self.feedback.clear()
        self.assertEqual(self.finish(goal_of(FAR, 2.0)).error_code,
                         FollowJointTrajectoryResult.SUCCESSFUL)
        for joint, place in zip(JOINTS, FAR):
            self.assertAlmostEqual(self.robot.wait_rest(joint), place, delta=0.01)
        self.assertGreater(len(self.feedback), 5)
        first, last = self.feedback[0], self.feedback[-1]
        self.assertEqual(first.joint_names, JOINTS)
        self.assertLess(first.actual.positions[0], last.actual.positions[0])
        for desired, actual, error in zip(last.desired.positions, last.actual.positions,
                                          last.error.positions):
            self.assertAlmostEqual(error, desired - actual, delta=1e-9)
            self.assertLess(abs(error), 0.2)
        fastest = max(self.feedback, key=lambda feedback: feedback.actual.velocities[0])
        self.assertGreater(fastest.desired.velocities[0], 0.5)
        for desired, actual, error in zip(fastest.desired.velocities, fastest.actual.velocities,
                                          fastest.error.velocities):
            self.assertAlmostEqual(error, desired - actual, delta=1e-9)

    def test_is_taken_in_any_order_of_the_joints(self):
        self.finish(goal_of(FAR[::-1], 2.0, JOINTS[::-1]))
        for joint, place in zip(JOINTS, FAR):
            self.robot.wait_at(joint, place)

    def test_is_rejected_with_a_code_and_a_reason(self):
        for goal, code, words in (
                (goal_of(FAR, 2.0, ["shoulder", "elbow", "wrist", "neck"]),
                 FollowJointTrajectoryResult.INVALID_JOINTS, "neck"),
                (goal_of([], 0.0, []), FollowJointTrajectoryResult.INVALID_JOINTS,
                 "arm: the goal names no joints"),
                (goal_of([-0.8, 2.5, 0.8, 0.5], 9.0), FollowJointTrajectoryResult.INVALID_GOAL,
                 "elbow|2.5")):
            self.send(goal)
            self.assertEqual(self.result(GoalStatus.REJECTED, words).error_code, code)
        self.succeed("wrist/disable")
        self.send(goal_of(FAR, 2.0))
        self.assertEqual(self.result(GoalStatus.REJECTED, "wrist|enable").error_code,
                         FollowJointTrajectoryResult.INVALID_GOAL)

    def test_is_preempted_at_rest_where_it_is_cancelled(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.client.cancel_goal()
        self.result(GoalStatus.PREEMPTED, "arm: cancelled")
        self.assertLess(self.robot.position("shoulder"), FAR[0] - 0.2)
        self.assert_rests()

    def test_is_preempted_by_a_newer_one(self):
        other = self.make_client()
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.send(goal_of(NEAR, 2.0), other)
        self.result(GoalStatus.PREEMPTED, "replaced by a newer trajectory")
        self.result(GoalStatus.SUCCEEDED, "goal reached", other)
        for joint, place in zip(JOINTS, NEAR):
            self.robot.wait_at(joint, place)

    def test_is_preempted_by_a_halt(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.succeed("halt")
        self.assertTrue(self.client.wait_for_result(rospy.Duration.from_sec(DEADLINE)))
        self.assertIn(self.client.get_state(), (GoalStatus.PREEMPTED, GoalStatus.ABORTED))
        self.assert_rests()

    def test_without_points_stops_and_succeeds_at_rest(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        other = self.make_client()
        self.send(goal_of([], 0.0), other)
        self.result(GoalStatus.SUCCEEDED, "arm: stands", other)
        self.result(GoalStatus.PREEMPTED, "stopped by an empty trajectory")
        self.assert_rests()

    def test_is_aborted_by_a_fault(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.succeed("inject_fault", axis="elbow", fault="0x8611")
        result = self.result(GoalStatus.ABORTED, "elbow")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        self.assert_stops()

    def test_is_aborted_beyond_a_tolerance_of_its_own(self):
        goal = goal_of(FAR, 2.0)
        goal.path_tolerance = [JointTolerance(name="shoulder", position=1e-6),
                               JointTolerance(name="nobody", position=1e-6)]
        self.send(goal)
        result = self.result(GoalStatus.ABORTED, "shoulder|off its path, the tolerance is 1e-06")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        self.assert_stops()

    def connect(self, topic, kind):
        publisher = rospy.Publisher(f"{ACTION}/{topic}", kind, queue_size=10)
        self.addCleanup(publisher.unregister)
        wait_until(lambda: publisher.get_num_connections() > 0, f"{topic} is heard")
        return publisher

    def test_is_recalled_if_it_was_cancelled_before_it_came(self):
        cancel = self.connect("cancel", GoalID)
        send = self.connect("goal", FollowJointTrajectoryActionGoal)
        results, known = {}, set()
        subscribers = [
            rospy.Subscriber(f"{ACTION}/result", FollowJointTrajectoryActionResult,
                             lambda message: results.update({message.status.goal_id.id:
                                                             message.status.status})),
            rospy.Subscriber(f"{ACTION}/status", GoalStatusArray,
                             lambda message: (known.clear(), known.update(
                                 status.goal_id.id for status in message.status_list)))]
        ids = []
        for seconds in (0, 1, 2**32 - 1):
            ids.append(f"at {seconds}")
            stamp = rospy.Time(seconds)
            cancel.publish(GoalID(id=ids[-1], stamp=stamp))
            # Once the status tells of it, the cancel has been heard.
            wait_until(lambda: ids[-1] in known, "the cancel is known")
            message = FollowJointTrajectoryActionGoal(goal=goal_of(FAR, 2.0))
            message.goal_id = GoalID(id=ids[-1], stamp=stamp)
            for _ in range(2):
                send.publish(message)
            wait_until(lambda: results.get(ids[-1]) == GoalStatus.RECALLED, "it is recalled")
        self.assert_rests()
        self.assertAlmostEqual(self.robot.position("shoulder"), NEAR[0], delta=0.01)
        wait_until(lambda: not known.intersection(ids), "they are forgotten")
        self.assertEqual(self.finish(goal_of(FAR, 2.0)).error_code,
                         FollowJointTrajectoryResult.SUCCESSFUL)
        for subscriber in subscribers:
            subscriber.unregister()

    def test_for_some_joints_leaves_the_others_to_theirs(self):
        other = self.make_client()
        self.send(goal_of(FAR[:2], 3.0, JOINTS[:2]))
        self.wait_moving()
        self.send(goal_of([FAR[2]], 1.0, ["wrist"]), other)
        self.result(GoalStatus.SUCCEEDED, "goal reached", other)
        self.assertEqual(self.client.get_state(), GoalStatus.ACTIVE)
        self.result(GoalStatus.SUCCEEDED, "goal reached")
        for joint, place in zip(JOINTS, FAR[:3] + NEAR[3:]):
            self.robot.wait_at(joint, place)


if __name__ == "__main__":
    main("action")
