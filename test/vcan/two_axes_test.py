#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Two axes in one drive between bus_node and simulated_drives, two processes on vcan0. Where a motor
stands is read from the drive's own TPDOs: TPDO 1 of axis 0, and that of axis 1, whose COB-ID is the
first one that the node has by default and axis 0 does not use."""
import math
import os
import struct
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import OK, Process, Robot, RobotTest, main, rospy, wait_until  # noqa: E402
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/two_axes.yaml"
AXES = ["left", "right", "other"]
COUNTS = 65536 * 50 / (2.0 * math.pi)  # of a rad
SECOND_TPDO = 0x1840  # communication parameter of TPDO 65, the first one of axis 1


class TwoAxes(RobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    AXES = sorted(AXES)
    identifiers = {"left": 0x181, "other": 0x182}

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        cls.process = Process("bus_node", "robot", CONFIG)

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    def identifier(self, axis):
        """Of the TPDO that brings statusword and position of the axis, as the drive has it."""
        if axis not in self.identifiers:
            held = self.succeed("right/read_object", object=f"{SECOND_TPDO:X}h:1 u32").number
            self.assertEqual(int(held) & 0x80000000, 0, "it is valid")
            self.identifiers[axis] = int(held) & 0x7FF
        return self.identifiers[axis]

    def told(self, axis, since=None):
        """Statusword and place in rad that the drive sends."""
        began = time.monotonic() if since is None else since
        identifier = self.identifier(axis)
        found = wait_until(lambda: [data for _, i, data in self.wire.since(began)
                                    if i == identifier], f"the TPDO of {axis}")
        statusword, counts = struct.unpack_from("<Hi", found[-1])
        return statusword, counts / COUNTS

    def place(self, axis):
        return self.told(axis)[1]

    def enabled(self, axis):
        return self.told(axis)[0] & 0x6F == 0x27

    def wait_place(self, axis, goal, tolerance=0.005):
        wait_until(lambda: abs(self.place(axis) - goal) < tolerance,
                   lambda: f"the motor of {axis} at {goal}, but at {self.place(axis)}")

    def test_01_one_node_boots_with_both_axes(self):
        self.robot.wait_ready(120.0)
        self.assertEqual(sorted(node.node_id for node in self.robot.bus_state.nodes), [1, 2])
        self.assertEqual(self.robot.node("right").axes, ["left", "right"])
        self.robot.wait_diagnostic("node 1", OK, "operational")
        free = self.identifier("right")
        self.assertIn(free & 0x7F, (1,), hex(free))
        for axis in AXES:
            self.assertAlmostEqual(self.place(axis), 0.0, delta=0.005)

    def test_02_both_move_together(self):
        self.succeed("recover")
        self.robot.follow(AXES, [(2.5, [0.8, -0.5, 0.3])])
        self.wait_place("left", 0.8)
        self.wait_place("right", -0.5)
        self.wait_place("other", 0.3)

    def test_03_one_faults_and_the_other_goes_on(self):
        from cia402_driver.srv import InjectFault
        self.robot.follow(AXES, [(8.0, [-0.8, 0.8, -0.3])])
        wait_until(lambda: self.place("right") > -0.3, "right moves")
        rospy.wait_for_service("/simulated_drives/inject_fault", 60.0)
        inject = rospy.ServiceProxy("/simulated_drives/inject_fault", InjectFault)
        answer = inject("right", "overcurrent")
        self.assertTrue(answer.success, answer.message)
        wait_until(lambda: self.told("right")[0] & 0x4F == 0x08, "right shows its fault")
        self.wait_place("left", -0.8)
        self.wait_place("other", -0.3)
        self.assertTrue(self.enabled("left"))
        self.assertLess(self.place("right"), 0.7)
        self.robot.wait_state("right", "fault")
        self.assertIn("0x2310", self.robot.axis("right").error_text)
        self.assertEqual(self.robot.axis("left").error_text, "")

    def test_04_recover_says_what_became_of_the_neighbour(self):
        self.wait_place("left", -0.8, 1e-4)  # the end of its way
        before = self.place("left")
        self.succeed("right/recover", "in the same drive: left (operation enabled)")
        wait_until(lambda: self.enabled("right"), "right is enabled")
        self.assertTrue(self.enabled("left"))
        self.assertAlmostEqual(self.place("left"), before, delta=0.002)
        self.robot.follow(AXES, [(2.5, [0.2, 0.2, 0.2])])
        for axis in AXES:
            self.wait_place(axis, 0.2)

    def test_05_the_drive_is_left_alone_while_one_is_under_power(self):
        self.succeed("left/disable")
        self.refuse("left/nmt", "right, in the same drive, may be under power",
                    command="reset_node")
        self.refuse("left/restore_parameters", "right, in the same drive, may be under power")
        self.refuse("right/write_object", "it is of axis 0 of the drive", object="6040:00",
                    value="15")
        self.assertTrue(self.enabled("right"))
        self.assertFalse(self.enabled("left"))
        self.succeed("right/disable")
        self.succeed("left/nmt", "in the same drive: right", command="reset_node")
        self.assertFalse(self.enabled("right"))


if __name__ == "__main__":
    main("two_axes")
