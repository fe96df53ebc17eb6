#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""bus_node and simulated_drives as two processes on vcan0."""
import os
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import (ERROR, OK, Process, Robot, RobotTest, main, rospy,  # noqa: E402
                          wait_until)
from wire import (NMT_PRE_OPERATIONAL, PRE_OPERATIONAL, Wire,  # noqa: E402
                  clock_distance)

CONFIG = "test/vcan/robot.yaml"
JOINTS = ["shoulder", "wrist", "gripper"]
NODES = {"shoulder": 1, "wrist": 3, "gripper": 4}
HEARTBEAT_NODES = [1, 3, 4]


def link(*arguments):
    subprocess.run(["ip", "link", *arguments], check=True)


def enabled(statusword):
    return statusword & 0x6F == 0x27


class Vcan(RobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    AXES = sorted(JOINTS)

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.start_drives()
        cls.start_node()

    @classmethod
    def start_drives(cls):
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)

    @classmethod
    def start_node(cls):
        cls.process = Process("bus_node", "robot", CONFIG)
        wait_until(lambda: "booted in" in cls.process.output() or cls.robot.bus_state, "node up")

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    def inject(self, axis, fault):
        from cia402_driver.srv import InjectFault
        rospy.wait_for_service("/simulated_drives/inject_fault", 40.0)
        answer = rospy.ServiceProxy("/simulated_drives/inject_fault", InjectFault)(axis, fault)
        self.assertTrue(answer.success, answer.message)

    def settle(self):
        """All drives there and recovered, by news from now on."""
        self.robot.bus_state = self.robot.axis_states = None
        self.robot.wait_ready(60.0)
        wait_until(self.robot.recovered, "recovered")

    def begin_motion(self, axis="wrist"):
        """All joints begin to move for 8 s and are seen to move."""
        self.settle()
        self.home_and_enable()
        start = self.robot.wait_rest(axis)
        goal = 2.5 if start < 0.0 else -2.5
        self.robot.follow(JOINTS, [(8.0, [1.5, goal, 1.2])])
        wait_until(lambda: abs(self.robot.position(axis) - start) > 0.1, "it moves")

    def test_01_drives_boot_and_are_known(self):
        self.robot.wait_ready(60.0)
        self.assertEqual(self.robot.joint_state.name, self.AXES)
        for name in self.AXES:
            self.assertEqual(self.robot.axis(name).state, "switch on disabled")
        self.assertEqual(self.robot.bus_state.interface, "vcan0")
        self.robot.wait_diagnostic("bus", OK, "vcan0")

    def test_02_stamps_are_those_of_the_frames(self):
        self.robot.wait_ready()
        self.robot.joint_states, self.robot.record = [], True
        wait_until(lambda: len(self.robot.joint_states) > 30, "joint_states")
        self.robot.record = False
        offset = clock_distance()
        feedback = [at + offset for at, identifier, _ in self.wire.since(0.0)
                    if 0x180 < identifier <= 0x184]
        stamps = [message.header.stamp.to_sec() for _, message in self.robot.joint_states]
        self.assertEqual(stamps, sorted(stamps))
        distances = sorted(min(abs(stamp - at) for at in feedback) for stamp in stamps)
        self.assertLess(distances[len(distances) // 2], 0.001)  # SYNC is every 20 ms
        ages = sorted(arrival - message.header.stamp.to_sec()
                      for arrival, message in self.robot.joint_states)
        self.assertGreater(ages[0], 0.0)

    def test_03_home_and_trajectory(self):
        self.succeed("home", "home done on 3 of 3 axes")
        self.succeed("enable")
        goal = [-0.4, 0.8, 0.5]
        self.robot.follow(JOINTS, [(2.5, goal)])
        for joint, place in zip(JOINTS, goal):
            self.robot.wait_at(joint, place, 0.01)

    def test_04_fault_shows_in_words_and_is_cleared(self):
        self.settle()
        self.home_and_enable()
        self.inject("wrist", "encoder")
        self.robot.wait_diagnostic("wrist", ERROR, "node 3|0x7305|encoder cable|clear_faults")
        self.inject("wrist", "clear")
        self.succeed("wrist/clear_faults")
        self.succeed("wrist/enable")
        self.robot.wait_diagnostic("wrist", OK, "")

    def test_05_killed_drives_are_noticed_and_recover_brings_them_back(self):
        self.settle()
        self.home_and_enable()
        self.drives.kill()
        for name in JOINTS:
            self.robot.wait_diagnostic(f"node {NODES[name]}", ERROR, name)
        wait_until(lambda: not any(node.ready for node in self.robot.bus_state.nodes), "not ready")
        self.start_drives()
        wait_until(lambda: all(node.ready for node in self.robot.bus_state.nodes), "ready again")
        for name in JOINTS:
            self.robot.wait_axis(name, lambda axis: axis.state == "switch on disabled", "disabled")
        self.settle()
        self.succeed("home")
        self.succeed("enable")
        place = self.robot.wait_rest("wrist")
        self.robot.command("wrist", place + 0.1)
        self.robot.wait_at("wrist", place + 0.1)

    def test_06_interface_down_and_up_is_survived(self):
        self.settle()
        self.home_and_enable()
        link("set", "vcan0", "down")
        self.robot.wait_diagnostic("bus", ERROR, "vcan0")
        self.assertTrue(self.process.running())
        link("set", "vcan0", "up")
        self.robot.wait_diagnostic("bus", OK, "vcan0")
        self.assertGreaterEqual(self.robot.bus_state.interface_losses, 1)
        self.settle()
        self.home_and_enable()
        place = self.robot.wait_rest("wrist")
        self.robot.command("wrist", place + 0.1)
        self.robot.wait_at("wrist", place + 0.1)

    def test_07_sigint_in_motion_leaves_drives_stopped_disabled_pre_operational(self):
        self.begin_motion()
        began = time.monotonic()
        self.process.send(signal.SIGINT)
        wait_until(lambda: self.wire.first(began, lambda identifier, data: identifier == 0
                                           and data[:1] == bytes([NMT_PRE_OPERATIONAL])),
                   "NMT pre-operational on the wire")
        commanded = self.wire.first(began, lambda identifier, data: identifier == 0
                                    and data[:1] == bytes([NMT_PRE_OPERATIONAL]))
        for node in HEARTBEAT_NODES:
            self.assertFalse(enabled(self.wire.statusword(node, began)), f"node {node}")
            wait_until(lambda: self.wire.first(
                began, lambda identifier, data: identifier == 0x700 + node
                and data == bytes([PRE_OPERATIONAL])), f"heartbeat 7F of node {node}")
        self.assertLess(commanded - began, 2.0)
        self.assertEqual(self.process.wait(), 0)
        self.start_node()
        self.robot.bus_state = None
        self.robot.wait_ready()

    def test_08_kill_9_in_motion_makes_the_drives_stop_by_themselves(self):
        self.settle()
        self.home_and_enable()
        self.robot.turn({"shoulder": 0.3, "wrist": 0.3})
        began = time.monotonic()
        self.process.kill()
        for node in (1, 3):
            self.assertGreater(self.wire.travel(node), 1000, f"node {node} turns on at first")
        for node in (1, 3):
            wait_until(lambda: self.wire.first(
                began, lambda identifier, data: identifier == 0x80 + node
                and data[:2] == bytes([0x30, 0x81])), f"EMCY 8130 of node {node}")
        for node in (1, 3):
            wait_until(lambda: self.wire.travel(node) == 0, f"node {node} stands", 10.0)
            self.assertFalse(self.wire.powered(node))
            self.assertEqual(self.wire.travel(node, 1.0), 0, f"node {node} stays there")
        self.start_node()
        self.robot.bus_state = None
        self.robot.wait_ready()
        for name in ("shoulder", "wrist"):
            self.assertNotEqual(self.robot.axis(name).state, "operation enabled")
            self.robot.wait_rest(name)

    def test_09_wrong_configuration_sends_no_frame(self):
        self.process.stop()
        self.drives.stop()
        # The second would run if nobody minded.
        for config, mistakes, told in (("test/config/ten_mistakes.yaml", {}, "10 problems"),
                                       (CONFIG, {"axes/wrist/colour": "red"}, "1 problem ")):
            quiet = time.monotonic()
            mistaken = Process("bus_node", "mistaken", config, interface="vcan0", **mistakes)
            self.addCleanup(mistaken.kill)
            wait_until(lambda: self.wire.since(quiet) or not mistaken.running(), "it ends")
            self.wire.hear_itself()
            self.assertEqual([frame[1:] for frame in self.wire.since(quiet)], [(0x7FF, b"heard")])
            self.assertNotEqual(mistaken.wait(), 0)
            self.assertIn(told, mistaken.output())

    def test_10_missing_interface_is_waited_for(self):
        late = Robot("late")
        node = Process("bus_node", "late", CONFIG, interface="vcan9")
        try:
            late.wait_diagnostic("bus", ERROR, "vcan9")
            link("add", "vcan9", "type", "vcan")
            link("set", "vcan9", "up")
            drives = Process("simulated_drives", "late_drives", CONFIG, interface="vcan9")
            try:
                late.wait_ready(60.0)
                late.wait_diagnostic("bus", OK, "vcan9")
            finally:
                drives.stop()
        finally:
            node.stop()
            late.close()


if __name__ == "__main__":
    main("vcan")
