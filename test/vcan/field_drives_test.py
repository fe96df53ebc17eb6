#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Drives that have less than others, or are slower, beside each other on one vcan0: bus_node here,
the drives in a process of their own. Where a motor stands is read from the drives' own TPDOs."""
import math
import os
import struct
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import (ERROR, OK, WARN, Process, Robot, RobotTest, main, rospy,  # noqa: E402
                          wait_until)
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/field_drives.yaml"
NODES = {"minimal": 1, "slow": 2, "unwatched": 3, "mute": 4}
MOVING = ["minimal", "slow", "unwatched"]
COUNTS = 65536 * 50 / (2.0 * math.pi)  # of a rad
SLOW_SDO = 0.2


class FieldDrives(RobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    AXES = sorted(NODES)

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        cls.inject("mute", "sdo_silent")
        cls.process = Process("bus_node", "robot", CONFIG)

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    @classmethod
    def inject(cls, axis, fault):
        from cia402_driver.srv import InjectFault
        rospy.wait_for_service("/simulated_drives/inject_fault", 60.0)
        answer = rospy.ServiceProxy("/simulated_drives/inject_fault", InjectFault)(axis, fault)
        assert answer.success, answer.message

    def ready(self, axes):
        wait_until(lambda: self.robot.bus_state and all(self.robot.node(a).ready for a in axes)
                   and self.robot.axis_states
                   and all(self.robot.axis(a).state != "unknown" for a in axes),
                   lambda: f"ready: {axes}\n{self.robot.bus_state}", 120.0)

    def place(self, axis, since=None):
        """Where the motor stands, rad, as its drive says on the wire (6064h, second in TPDO 1)."""
        began = time.monotonic() if since is None else since
        found = wait_until(lambda: [data for _, identifier, data in self.wire.since(began)
                                    if identifier == 0x180 + NODES[axis]], f"TPDO 1 of {axis}")
        return struct.unpack_from("<Hi", found[-1])[1] / COUNTS

    def enable(self, axes):
        for axis in axes:
            self.succeed(f"{axis}/recover")

    def travel_to(self, goals, seconds=2.5):
        """A trajectory of the group, until each motor is where it must be."""
        self.robot.follow(MOVING, [(seconds, [goals[axis] for axis in MOVING])])
        for axis in MOVING:
            wait_until(lambda: abs(self.place(axis) - goals[axis]) < 0.005,
                       lambda: f"the motor of {axis} at {goals[axis]}, but at {self.place(axis)}")

    def test_01_the_mute_one_is_described_and_the_others_boot(self):
        self.ready(MOVING)
        status = self.robot.wait_diagnostic("node 4", ERROR,
                                            "mute (node 4)|heartbeat|its SDO server is mute")
        self.assertIn("1200h", status.message)
        self.assertIn("SDO server is mute", self.robot.axis("mute").error_text)
        began = time.monotonic()
        wait_until(lambda: self.wire.first(
            began, lambda identifier, data: identifier == 0x704), "a heartbeat of the mute drive")
        for axis in MOVING:
            self.assertNotIn("mute", self.robot.axis(axis).error_text)

    def test_02_a_trajectory_moves_the_motors_of_the_others(self):
        self.ready(MOVING)
        self.enable(MOVING)
        start = {axis: self.place(axis) for axis in MOVING}
        for axis in MOVING:
            self.assertAlmostEqual(start[axis], 0.0, delta=0.005)
        self.travel_to({"minimal": 0.8, "slow": -0.5, "unwatched": 0.4})
        self.travel_to({"minimal": 0.0, "slow": 0.0, "unwatched": 0.0})

    def test_03_the_minimal_one_is_given_no_object_that_it_lacks(self):
        """Its TPDO carries what it has; what it does not tell is unknown, not 0."""
        axis = self.robot.axis("minimal")
        self.assertTrue(math.isnan(axis.velocity) and math.isnan(axis.velocity_age), axis)
        self.assertFalse(axis.digital_inputs_valid)
        self.assertTrue(0.0 <= axis.mode_age < 1.0, axis.mode_age)
        status = self.robot.wait_diagnostic("node 1", WARN, "cannot notice a dead master")
        told = {value.key: value.value for value in status.values}
        self.assertIn("606C:00 velocity_actual", told["boot"])

    def test_04_slow_answers_hold_up_neither_the_axis_nor_the_others(self):
        self.ready(MOVING)
        self.enable(MOVING)
        began = time.monotonic()
        self.robot.follow(MOVING, [(4.0, [0.9, 0.9, 0.9])])
        read = self.succeed("slow/read_object", object="1018h:1 u32")
        self.assertEqual(read.number, 0x4D2)
        asked = self.wire.first(began, lambda identifier, data: identifier == 0x602
                                and data[:4] == bytes([0x40, 0x18, 0x10, 0x01]))
        answered = self.wire.first(began, lambda identifier, data: identifier == 0x582
                                   and data[1:4] == bytes([0x18, 0x10, 0x01]))
        self.assertGreaterEqual(answered - asked, SLOW_SDO)
        for axis in MOVING:
            wait_until(lambda: abs(self.place(axis) - 0.9) < 0.005,
                       lambda: f"the motor of {axis} at 0.9, but at {self.place(axis)}")
        told = {value.key: value.value
                for value in self.robot.wait_diagnostic("node 2", OK, "operational").values}
        self.assertRegex(told["SDO answer time"], r"^2\d\d\.\d+ ms mean")
        self.assertIn("0 time-outs", told["SDO transfers"])
        axis = self.robot.axis("slow")
        self.assertTrue(0.0 <= axis.following_error_age < 2.5, axis.following_error_age)
        self.assertLess(axis.velocity_age, 1.0)

    def test_05_no_heartbeat_is_told_and_the_loss_shows_in_its_tpdos(self):
        self.ready(MOVING)
        self.robot.wait_diagnostic("node 3", WARN, "missing TPDOs only|cannot notice a dead master")
        heartbeats = [data for _, identifier, data in self.wire.since(0.0) if identifier == 0x703]
        self.assertLessEqual(set(heartbeats), {b"\x00"}, "boot-up messages only")
        self.assertEqual([i for _, i in self.wire.remote_since(0.0) if i == 0x703], [])
        self.enable(MOVING)
        self.robot.follow(MOVING, [(8.0, [-0.9, -0.9, -0.9])])
        wait_until(lambda: self.place("unwatched") < 0.8, "it moves")
        self.inject("unwatched", "silent")
        self.robot.wait_diagnostic("unwatched", ERROR, "unwatched (node 3)|TPDO 1|does not come")
        for axis in ("minimal", "slow"):
            wait_until(lambda: abs(self.place(axis) + 0.9) < 0.005,
                       lambda: f"the motor of {axis} at -0.9, but at {self.place(axis)}")
        self.inject("unwatched", "clear")

    def test_06_the_mute_one_boots_once_it_answers(self):
        self.inject("mute", "clear")
        self.succeed("mute/recover")
        self.ready(["mute"])
        self.robot.command("mute", 0.3)
        wait_until(lambda: abs(self.place("mute") - 0.3) < 0.005,
                   lambda: f"the motor at 0.3, but at {self.place('mute')}")

    def asked_in(self, seconds):
        """How often 60F4h of the slow one is asked for; a rate is measured over a time."""
        began = time.monotonic()
        time.sleep(seconds)
        return len([data for _, identifier, data in self.wire.since(began)
                    if identifier == 0x602 and data[:3] == bytes([0x40, 0xF4, 0x60])])

    def test_07_the_following_error_is_asked_for_only_while_somebody_looks(self):
        self.ready(["slow"])
        self.robot.close()
        time.sleep(5.0)  # until the node knows that nobody listens
        self.assertEqual(self.asked_in(10.0), 0)
        listener = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda _: None)
        wait_until(lambda: listener.get_num_connections() > 0, "the node on /diagnostics")
        self.assertTrue(7 <= self.asked_in(10.0) <= 13, "once a report")
        listener.unregister()


if __name__ == "__main__":
    main("field_drives")
