#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Goals of follow_joint_trajectory: how they end, and where the joints are then."""
import signal
import statistics
import time

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from control_msgs.msg import (FollowJointTrajectoryAction, FollowJointTrajectoryActionGoal,
                              FollowJointTrajectoryActionResult, FollowJointTrajectoryGoal,
                              FollowJointTrajectoryResult, JointTolerance)
from goal_client import GoalClient
from robot_client import DEADLINE, RobotTest, main, wait_until
from trajectory_msgs.msg import JointTrajectoryPoint

JOINTS = ["shoulder", "elbow", "wrist", "gripper"]
ACTION = "/robot/arm/follow_joint_trajectory"
NEAR, MIDDLE, FAR = [-2.0, 0.0, 0.2, 0.1], [-1.4, 0.3, 0.5, 0.3], [-0.8, 0.6, 0.8, 0.5]


def point_of(positions, seconds):
    return JointTrajectoryPoint(positions=positions, velocities=[0.0] * len(positions),
                                time_from_start=rospy.Duration.from_sec(seconds))


def goal_of(positions, seconds, joints=None):
    goal = FollowJointTrajectoryGoal()
    goal.trajectory.joint_names = JOINTS if joints is None else joints
    if positions:
        goal.trajectory.points.append(point_of(positions, seconds))
    return goal


class ActionTest(RobotTest):
    def make_client(self, action=ACTION):
        client = GoalClient(action, FollowJointTrajectoryAction)
        self.assertTrue(client.wait_for_server(rospy.Duration.from_sec(DEADLINE)))
        return client

    def result(self, state, words, client):
        self.assertTrue(client.wait_for_result(rospy.Duration.from_sec(DEADLINE)))
        result = client.get_result()
        self.assertEqual(GoalStatus.to_string(client.get_state()), GoalStatus.to_string(state),
                         result.error_string)
        self.assert_words(result.error_string, words)
        return result


class Action(ActionTest):
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

    def send(self, goal, client=None):
        (client or self.client).send_goal(goal, feedback_cb=self.feedback.append)

    def result(self, state, words, client=None):
        return super().result(state, words, client or self.client)

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

    def test_tells_of_the_way_at_20_hz(self):
        self.feedback.clear()
        self.finish(goal_of(FAR, 2.0))
        stamps = [feedback.header.stamp.to_sec() for feedback in self.feedback]
        self.assertGreater(len(stamps), 10)
        apart = statistics.median(b - a for a, b in zip(stamps, stamps[1:]))
        self.assertAlmostEqual(apart, 0.05, delta=0.01)

    def test_is_taken_in_any_order_of_the_joints(self):
        self.finish(goal_of(FAR[::-1], 2.0, JOINTS[::-1]))
        for joint, place in zip(JOINTS, FAR):
            self.robot.wait_at(joint, place)

    def test_is_rejected_with_a_code_and_a_reason(self):
        for goal, code, words in (
                (goal_of(FAR, 2.0, ["shoulder", "elbow", "wrist", "neck"]),
                 FollowJointTrajectoryResult.INVALID_JOINTS, "arm: trajectory refused: |neck"),
                (goal_of([], 0.0, []), FollowJointTrajectoryResult.INVALID_JOINTS,
                 "arm: the goal names no joints"),
                (goal_of([-0.8, 2.5, 0.8, 0.5], 9.0), FollowJointTrajectoryResult.INVALID_GOAL,
                 "arm: trajectory refused: elbow: |at 9 s|2.5 rad|upper limit 2 rad")):
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

    def test_is_preempted_by_a_trajectory_of_the_topic(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.robot.follow(JOINTS, [(2.0, NEAR)])
        self.result(GoalStatus.PREEMPTED, "arm: replaced by a newer trajectory")
        for joint, place in zip(JOINTS, NEAR):
            self.robot.wait_at(joint, place)

    def test_takes_over_from_a_trajectory_of_the_topic(self):
        told = []
        subscriber = rospy.Subscriber("/robot/arm/command_result", FollowJointTrajectoryResult,
                                      told.append)
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: subscriber.get_num_connections() > 0, "results are heard")
        self.robot.follow(JOINTS, [(5.0, FAR)])
        self.wait_moving()
        self.finish(goal_of(MIDDLE, 2.0))
        for joint, place in zip(JOINTS, MIDDLE):
            self.robot.wait_at(joint, place)
        self.assertEqual(told, [], "of one that was replaced nothing is told")

    def test_waits_for_a_stamp_in_the_future(self):
        goal = goal_of(FAR, 2.0)
        goal.trajectory.header.stamp = rospy.Time.now() + rospy.Duration.from_sec(2.0)
        self.send(goal)
        wait_until(lambda: self.client.get_state() == GoalStatus.ACTIVE, "it is accepted")
        while rospy.Time.now() < goal.trajectory.header.stamp - rospy.Duration.from_sec(0.5):
            self.assertAlmostEqual(self.robot.position("shoulder"), NEAR[0], delta=0.01)
            rospy.sleep(0.05)
        self.result(GoalStatus.SUCCEEDED, "goal reached")
        self.assertGreaterEqual((rospy.Time.now() - goal.trajectory.header.stamp).to_sec(), 2.0)
        for joint, place in zip(JOINTS, FAR):
            self.robot.wait_at(joint, place)

    def test_leaves_out_what_a_stamp_in_the_past_has_passed(self):
        goal = goal_of(NEAR, 4.0)
        goal.trajectory.points.append(point_of(FAR, 8.0))
        begun = rospy.Time.now()
        goal.trajectory.header.stamp = begun - rospy.Duration.from_sec(5.0)
        self.send(goal)
        self.result(GoalStatus.SUCCEEDED, "goal reached")
        took = (rospy.Time.now() - begun).to_sec()
        self.assertGreaterEqual(took, 3.0 - 0.1)
        self.assertLess(took, 7.0, "3 s are left of its 8")
        for joint, place in zip(JOINTS, FAR):
            self.robot.wait_at(joint, place)
        goal.trajectory.header.stamp = rospy.Time.now() - rospy.Duration.from_sec(9.0)
        self.send(goal)
        result = self.result(GoalStatus.REJECTED, "arm: trajectory refused: all points have passed")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.INVALID_GOAL)

    def test_is_preempted_by_a_halt(self):
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        self.succeed("halt")
        result = self.result(GoalStatus.PREEMPTED, "arm: stopped: |halt was called")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.SUCCESSFUL)
        self.assert_rests()
        self.assert_stops()

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
        result = self.result(GoalStatus.ABORTED, "arm: trajectory stopped: shoulder is |rad off "
                             "its path at | s, the tolerance is 1e-06 rad")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        self.assert_stops()

    def test_is_aborted_where_it_misses_a_goal_tolerance_of_its_own(self):
        """One turn of the joint is 13107200 counts: -0.8 rad is between two of them."""
        goal = goal_of(FAR, 2.0)
        goal.goal_tolerance = [JointTolerance(name="shoulder", position=1e-12),
                               JointTolerance(name="elbow", position=-1.0),
                               JointTolerance(name="nobody", position=1e-12)]
        goal.goal_time_tolerance = rospy.Duration.from_sec(0.3)
        self.send(goal)
        result = self.result(GoalStatus.ABORTED, "arm: goal missed: shoulder is |rad away 0.3 s "
                             "after the end, the tolerance is 1e-12 rad")
        self.assertEqual(result.error_code, FollowJointTrajectoryResult.GOAL_TOLERANCE_VIOLATED)
        self.assertAlmostEqual(self.robot.wait_rest("shoulder"), FAR[0], delta=0.001)

    def connect(self, topic, kind, queue_size=10):
        publisher = rospy.Publisher(f"{ACTION}/{topic}", kind, queue_size=queue_size)
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

    def test_of_64_that_have_not_ended_each_has_its_result_and_a_65th_is_refused(self):
        self.addCleanup(self.stop_within, 0.0)
        self.stop_within(4.0)
        results = {}
        subscriber = rospy.Subscriber(
            f"{ACTION}/result", FollowJointTrajectoryActionResult,
            lambda message: results.update({message.status.goal_id.id: message}))
        self.addCleanup(subscriber.unregister)
        send = self.connect("goal", FollowJointTrajectoryActionGoal, 100)
        self.send(goal_of(FAR, 5.0))
        self.wait_moving()
        ids = [f"stop {number}" for number in range(1, 65)]
        self.process.send(signal.SIGSTOP)
        for goal_id in ids:  # all at once for the node; the trajectory is one of its 64
            send.publish(FollowJointTrajectoryActionGoal(
                goal_id=GoalID(id=goal_id, stamp=rospy.Time.now()), goal=goal_of([], 0.0)))
        time.sleep(0.5)  # until all are on their way
        self.process.send(signal.SIGCONT)
        self.result(GoalStatus.PREEMPTED, "stopped by an empty trajectory")
        wait_until(lambda: set(ids) <= set(results),
                   lambda: f"a result of each, but of {sorted(set(ids) - set(results))}")
        refused = [results[goal_id] for goal_id in ids
                   if results[goal_id].status.status == GoalStatus.REJECTED]
        self.assertEqual(len(refused), 1)
        self.assertEqual(refused[0].status.goal_id.id, ids[-1])
        self.assertEqual(refused[0].result.error_code, FollowJointTrajectoryResult.INVALID_GOAL)
        self.assertEqual(refused[0].result.error_string,
                         "arm: 64 goals have not ended yet; wait for their results")
        for goal_id in ids[:-1]:
            self.assertEqual(results[goal_id].status.status, GoalStatus.SUCCEEDED, goal_id)
        self.finish(goal_of(NEAR, 3.0))  # there is room again

    def stop_within(self, seconds):
        rospy.set_param("/robot/groups/arm/stop_trajectory_duration", seconds)
        self.succeed("reload")

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


class TwoGroups(ActionTest):
    CONFIG = "config/robots/portal.yaml"

    def setUp(self):
        self.home_and_enable()

    def goal(self, group, joints, positions, seconds):
        client = self.make_client(f"/robot/{group}/follow_joint_trajectory")
        client.send_goal(goal_of(positions, seconds, joints))
        return client

    def test_follow_their_goals_at_once(self):
        portal = self.goal("portal", ["x", "z"], [0.3, -0.1], 4.0)
        wrist = self.goal("wrist", ["pitch", "roll"], [0.5, 1.0], 3.0)
        wait_until(lambda: abs(self.robot.position("pitch")) > 0.05, "the wrist moves")
        for client in portal, wrist:
            self.assertEqual(client.get_state(), GoalStatus.ACTIVE)
        self.result(GoalStatus.SUCCEEDED, "wrist: goal reached", wrist)
        self.result(GoalStatus.SUCCEEDED, "portal: goal reached", portal)
        for joint, place in (("x", 0.3), ("z", -0.1), ("pitch", 0.5), ("roll", 1.0)):
            self.robot.wait_at(joint, place)

    def test_stop_apart(self):
        portal = self.goal("portal", ["x", "z"], [0.0, 0.0], 4.0)
        self.result(GoalStatus.SUCCEEDED, "portal: goal reached", portal)
        portal = self.goal("portal", ["x", "z"], [0.4, -0.1], 5.0)
        wrist = self.goal("wrist", ["pitch", "roll"], [-0.5, -1.0], 5.0)
        wait_until(lambda: self.robot.position("x") > 0.05, "the portal moves")
        self.succeed("wrist/halt")
        self.result(GoalStatus.PREEMPTED, "wrist: stopped: |halt was called", wrist)
        self.result(GoalStatus.SUCCEEDED, "portal: goal reached", portal)


if __name__ == "__main__":
    main("action")
