#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Goals of follow_joint_trajectory for the demo robot on vcan0, judged by the targets that its five
drives are sent; beside them its frames, and what its drives measure, as others are told of them."""
import bisect
import struct
import time

from actionlib_msgs.msg import GoalStatus
from control_msgs.msg import FollowJointTrajectoryResult, JointTolerance
from demo_robot import (JOINTS, NODES, PERIOD, RESULT, DemoRobotTest, goal_of, main,  # noqa: E402
                        package_file, point_goal, rospy, wait_until)
from ros_tool import Tool, node_of
from targets import BY_VELOCITY, LIMITS, Targets
from tf_test import FRAMES, Teller, difference, turn_of

LOW = {"shoulder": -1.6, "elbow": -1.2, "wrist": -0.8, "tool": -0.8, "gripper": -1.0}
HIGH = {"shoulder": 0.6, "elbow": 1.2, "wrist": 0.9, "tool": 0.9, "gripper": 1.0}
BEGIN_S, CRUISE_S = 0.4, 1.2  # of the way up: evenly faster, at one speed; to rest as it began
SPEEDS = {joint: (HIGH[joint] - LOW[joint]) / (BEGIN_S + CRUISE_S) for joint in JOINTS}  # rad/s
# rad off the path: at its speed a motor is 6 cycles behind it, the most that docs/stops.md allows.
LOOSE = [JointTolerance(name=joint, position=0.3) for joint in JOINTS]

# What drives measure: joint, name in its profile, object, row of the simulated drive's dictionary
# (its name, type, access, PDO, raw value), and what that is by the maker's manual.
MEASURED = [
    ("shoulder", "dc_link_voltage", (0x200B, 0x1B),
     ("dc_bus_voltage", "uint16", "ro", "-", 3105), "310.5 V"),
    ("shoulder", "module_temperature", (0x200B, 0x1C),
     ("module_temperature", "int16", "ro", "-", 48), "48 degC"),
    ("shoulder", "encoder_temperature", (0x200B, 0x43),
     ("encoder_temperature", "int16", "ro", "-", -10), "-10 degC"),
    ("elbow", "bus_voltage", (0x200B, 0x0A), ("monitor_bus_voltage", "uint16", "ro", "-", 47), "47 V"),
    ("elbow", "module_temperature", (0x200B, 0x20),
     ("monitor_temperature", "int16", "ro", "-", 412), "41.2 degC"),
    ("wrist", "bus_voltage", (0x200B, 0x08), ("BusVoltage", "uint16", "ro", "t", 27), "27 V"),
    ("tool", "bus_voltage", (0x2065, 0x00), ("bus_voltage", "uint16", "ro", "-", 4710), "47.1 V"),
    ("gripper", "mosfet_temperature", (0x200A, 0x01),
     ("mosfet_temperature", "uint32", "rw", "-", "f41.5"), "41.5 degC"),
    ("gripper", "motor_temperature", (0x200A, 0x02),
     ("motor_temperature", "uint32", "rw", "-", "f36.25"), "36.25 degC"),
]


def measured_rows(joint):
    return [[*number, *row] for of, _, number, row, _ in MEASURED if of == joint]


def measured_by_drive(joint):
    """What of the simulated drive holds these values: rows of its dictionary, or monitors."""
    rows = measured_rows(joint)
    if joint != "shoulder":
        return {"dictionary": rows}
    return {"monitors": {f"{index:04X}:{sub:02X}": value for index, sub, *_, value in rows}}


def raw_bytes(row):
    """The value of a row as SDO carries it."""
    _, kind, _, _, value = row
    if kind == "uint32":
        return struct.pack("<f", float(value[1:]))
    return struct.pack("<h" if kind == "int16" else "<H", value)


def way_up():
    """The goal HIGH from LOW: by an even acceleration to SPEEDS, on at these, and to rest likewise."""
    first = {joint: LOW[joint] + SPEEDS[joint] * BEGIN_S / 2.0 for joint in JOINTS}
    second = {joint: HIGH[joint] - SPEEDS[joint] * BEGIN_S / 2.0 for joint in JOINTS}
    goal = goal_of([(BEGIN_S, first, SPEEDS), (BEGIN_S + CRUISE_S, second, SPEEDS),
                    (2.0 * BEGIN_S + CRUISE_S, HIGH, dict.fromkeys(JOINTS, 0.0))])
    goal.path_tolerance = LOOSE
    return goal


class Goals(DemoRobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    OF_NODE = {"groups/arm/allow_partial_joints_goal": True}
    OF_DRIVES = {f"axes/{joint}/simulation/with": measured_by_drive(joint) for joint in JOINTS}

    def end(self, client):
        """@return how a goal ended, and what it says."""
        self.assertTrue(client.wait_for_result(RESULT), "a result")
        return client.get_state(), client.get_result()

    def go(self, places, seconds):
        client = self.client()
        goal = point_goal(places, seconds)
        goal.path_tolerance = LOOSE
        client.send_goal(goal)
        return self.end(client)

    def wait_half_way(self, client):
        """Or until a late cycle has ended it."""
        middle = (LOW["shoulder"] + HIGH["shoulder"]) / 2.0
        wait_until(lambda: self.robot.position("shoulder") > middle or
                   client.get_state() > GoalStatus.ACTIVE, "half of the way")

    def play(self, motion):
        """From rest at LOW, anew where a cycle of this machine was late: that ends a motion.
        @return what was sent meanwhile, and what the motion returns."""
        for _ in range(5):
            self.succeed("enable")
            if self.go(LOW, 2.4)[0] != GoalStatus.SUCCEEDED:
                continue
            began = time.monotonic()
            result = motion()
            targets = Targets(self.wire.since(began))
            if targets.on_time():
                targets.assert_within_limits(self)
                return targets, result
        raise AssertionError("a cycle is late each time")

    def assert_at(self, places):
        for joint, place in places.items():
            self.assertAlmostEqual(self.robot.position(joint), place, delta=0.01, msg=joint)

    def assert_ended(self, ended, state, words, code=FollowJointTrajectoryResult.SUCCESSFUL):
        status, result = ended
        self.assertEqual(GoalStatus.to_string(status), GoalStatus.to_string(state), result)
        self.assert_words(result.error_string, words)
        self.assertEqual(result.error_code, code)

    def test_1_what_drives_measure_is_in_diagnostics_with_its_unit(self):
        self.robot.wait_ready(120.0)
        for joint, name, (index, subindex), row, text in MEASURED:
            def told(joint=joint, name=name):
                status = self.robot.diagnostic(joint)
                return {pair.key: pair.value for pair in status.values}.get(name) if status else None
            wait_until(lambda told=told: told() not in (None, "unknown"), f"{joint}: {name}")
            print(f"{joint}: {name}: {told()}")
            self.assertEqual(told().split("= ")[-1], text, f"{joint}: {name}")
            answer = struct.pack("<HB", index, subindex) + raw_bytes(row)
            self.assertTrue(any(identifier == 0x580 + NODES[joint] and data[1:].startswith(answer)
                                for _, identifier, data in self.wire.since(0.0)),
                            f"{joint}: {answer.hex()} was told on the wire")

    def test_2_frames_are_those_of_robot_state_publisher(self):
        self.robot.wait_ready(120.0)
        self.succeed("home", "home done on 5 of 5 axes")
        with open(package_file("config/robots/demo.urdf"), encoding="ascii") as urdf:
            rospy.set_param("robot_description", urdf.read())
        own, other = Teller("/tf"), Teller("/other/tf")
        publisher = Tool("publisher", node_of("robot_state_publisher", "robot_state_publisher"),
                         "tf:=other/tf", "tf_static:=other/tf_static")
        self.addCleanup(publisher.stop)
        publisher.wait_listens("/joint_states")
        self.play(lambda: self.go(HIGH, 2.5))
        own.close()
        other.close()
        for frame in FRAMES:
            self.compare(frame, *[sorted((t for t in list(teller.all) if t.child_frame_id == frame),
                                         key=lambda t: t.header.stamp) for teller in (own, other)])

    def compare(self, frame, own, other):
        """joint_states have the stamp of the newest position in them; that of the frame's own joint is
        what the frame was told with last until then, in the same cycle. Both sides compute in doubles
        from the same double: what they differ by is rounding."""
        stamps = [transform.header.stamp for transform in own]
        turns = set()
        for theirs in other:
            ours = own[bisect.bisect_right(stamps, theirs.header.stamp) - 1]
            apart = (theirs.header.stamp - ours.header.stamp).to_sec()
            if not 0.0 <= apart < PERIOD:
                continue  # it was not told, or is the last one
            self.assertLess(difference(ours, theirs), 1e-9, f"{ours}\n{theirs}")
            turns.add(tuple(round(part, 3) for part in turn_of(theirs)))
        print(f"{frame}: {len(turns)} different turns compared")
        self.assertGreater(len(turns), 30, f"{frame}: different turns that were compared")

    def test_3_a_cancel_in_motion_brings_all_to_rest_within_their_limits(self):
        def motion():
            client = self.client()
            client.send_goal(way_up())
            self.wait_half_way(client)
            cancelled = time.monotonic()
            client.cancel_goal()
            ended = self.end(client)
            stands = time.monotonic()
            time.sleep(0.5)  # that it rests is seen by what follows
            return cancelled, ended, stands
        targets, (cancelled, ended, stands) = self.play(motion)
        self.assert_ended(ended, GoalStatus.PREEMPTED, "arm: cancelled")
        for joint in JOINTS:
            before = [speed for at, speed in targets.speeds(joint) if at < cancelled][-1]
            after = targets.speeds(joint, cancelled)
            self.assertAlmostEqual(before, SPEEDS[joint], delta=0.02, msg=joint)
            most = 2.0 * targets.rounding(joint)
            self.assertLess(max(speed for _, speed in after), before + most, joint)
            if joint == BY_VELOCITY:
                continue
            self.assertGreaterEqual(min(speed for _, speed in after), -most, f"{joint} turns back")
            braked = next(at for at, speed in after if speed < before - most)
            rest = max(at for at, speed in after if speed > most)
            print(f"{joint}: brakes {braked - cancelled:.3f} s after the cancel, "
                  f"for {rest - braked:.3f} s from {before:.3f} rad/s")
            self.assertLess(braked - cancelled, 0.3, f"{joint} brakes")
            self.assertLess(rest - braked, before / LIMITS[joint]["acceleration"] + 2.0 * PERIOD, joint)
        targets.assert_rest(self, stands)
        for joint in JOINTS:
            self.assertTrue(self.powered(joint), joint)
            self.assertLess(self.robot.position(joint), HIGH[joint] - 0.1, joint)

    def test_4_a_newer_goal_takes_over_in_motion_without_a_jump_and_is_held(self):
        there = {**HIGH, "shoulder": LOW["shoulder"], "wrist": LOW["wrist"]}

        def motion():
            first, second = self.client(), self.client()
            first.send_goal(way_up())
            self.wait_half_way(first)
            taken_over = time.monotonic()
            second.send_goal(point_goal(there, 2.0))
            replaced, ended = self.end(first), self.end(second)
            arrived = time.monotonic()
            time.sleep(0.6)  # that it stays there is seen by what follows
            return taken_over, replaced, ended, arrived
        targets, (taken_over, replaced, ended, arrived) = self.play(motion)
        self.assert_ended(replaced, GoalStatus.PREEMPTED, "arm: replaced by a newer trajectory")
        self.assert_ended(ended, GoalStatus.SUCCEEDED, "arm: goal reached")
        for joint in JOINTS:
            before = [speed for at, speed in targets.speeds(joint) if at < taken_over][-1]
            self.assertAlmostEqual(before, SPEEDS[joint], delta=0.02, msg=joint)
            back = min(speed for _, speed in targets.speeds(joint, taken_over))
            self.assertEqual(back < -0.3, joint in ("shoulder", "wrist"), f"{joint}: {back} rad/s")
        targets.assert_rest(self, arrived)
        self.assert_at(there)
        for joint in JOINTS:
            self.assertTrue(self.powered(joint), joint)

    def test_5_a_path_tolerance_of_the_goal_stops_all_within_their_limits(self):
        def motion():
            client, goal = self.client(), way_up()
            goal.path_tolerance = LOOSE[1:] + [JointTolerance(name="shoulder", position=0.02)]
            client.send_goal(goal)
            ended = self.end(client)
            time.sleep(0.7)  # its joints come to rest meanwhile
            rest = time.monotonic()
            time.sleep(0.4)
            return ended, rest
        targets, (ended, rest) = self.play(motion)
        self.assert_ended(ended, GoalStatus.ABORTED, "arm: trajectory stopped: shoulder is |rad off "
                          "its path at |, the tolerance is 0.02 rad",
                          FollowJointTrajectoryResult.PATH_TOLERANCE_VIOLATED)
        targets.assert_rest(self, rest)
        for joint in JOINTS:
            self.assertLess(self.robot.position(joint), HIGH[joint] - 0.1, joint)

    def test_6_a_goal_that_is_over_moves_nothing(self):
        def motion():
            client, goal = self.client(), way_up()
            goal.trajectory.header.stamp = rospy.Time.now() - rospy.Duration.from_sec(3.0)
            began = time.monotonic()
            client.send_goal(goal)
            ended = self.end(client)
            time.sleep(0.4)  # nothing comes of it
            return ended, began
        targets, (ended, began) = self.play(motion)
        self.assert_ended(ended, GoalStatus.REJECTED,
                          "arm: trajectory refused: all points have passed",
                          FollowJointTrajectoryResult.INVALID_GOAL)
        targets.assert_rest(self, began)

    def test_7_a_goal_of_one_joint_takes_it_out_of_the_motion_of_all(self):
        others = [joint for joint in JOINTS if joint != "wrist"]

        def motion():
            of_all, of_wrist = self.client(), self.client()
            of_all.send_goal(way_up())
            self.wait_half_way(of_all)
            of_wrist.send_goal(point_goal(LOW, 2.6, ["wrist"]))
            others_rest = time.monotonic() + BEGIN_S + CRUISE_S  # more than is left of their way
            replaced = self.end(of_all)
            ended = self.end(of_wrist)
            time.sleep(0.3)
            return replaced, ended, others_rest
        targets, (replaced, ended, others_rest) = self.play(motion)
        self.assert_ended(replaced, GoalStatus.PREEMPTED, "arm: replaced by a newer trajectory")
        self.assert_ended(ended, GoalStatus.SUCCEEDED, "arm: goal reached")
        self.assert_at({**HIGH, "wrist": LOW["wrist"]})
        targets.assert_rest(self, others_rest, others)
        alone = min(speed for _, speed in targets.speeds("wrist", others_rest))
        self.assertLess(alone, -0.3, "the wrist moves alone then")


if __name__ == "__main__":
    main("goals")
