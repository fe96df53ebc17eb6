#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Starts that lead nowhere: a wrong configuration, an interface that is not there."""
import math
import os
import signal
import subprocess
import tempfile
import time
import unittest

from robot_client import DEADLINE, ERROR, Process, Robot, executable, main, wait_until

# What the node must say about test/config/ten_mistakes.yaml: path and a word.
MISTAKES = [
    ("bus/sync_period", "-0.004"),
    ("axes/base/colour", "unknown"),
    ("axes/base/gear_ratio", "fast"),
    ("node_id", "1"),
    ("axes/shoulder/drive", "generic_402"),
    ("axes/elbow/limits", "2.0"),
    ("axes/elbow/pdos/tpdo1", "64"),
    ("axes/wrist/counts_per_turn", "0"),
    ("axes/hand/mode", "cyclic_postion"),
    ("groups/arm/joints", "elbw"),
]


class WrongConfiguration(unittest.TestCase):
    def test_all_ten_mistakes_are_told_at_once(self):
        process = Process("bus_node", "mistaken", "test/config/ten_mistakes.yaml")
        self.assertNotEqual(process.wait(), 0)
        lines = process.output().splitlines()
        for path, word in MISTAKES:
            self.assertTrue(any(path in line and word in line for line in lines), (path, word))
        self.assertIn("10 problems", process.output())
        self.assertIn("nothing was sent", process.output())

    def test_simulated_drives_refuse_it_too(self):
        process = Process("simulated_drives", "mistaken_drives", "test/config/ten_mistakes.yaml")
        self.assertNotEqual(process.wait(), 0)
        self.assertIn("10 problems", process.output())

    def test_private_parameters_that_nobody_reads_are_refused(self):
        for name in ("diagnostic_period", "realtime_prioritty"):
            process = Process("bus_node", f"with_{name}", "config/robots/arm.yaml",
                              interface="sim", **{name: 1})
            self.assertEqual(process.wait(), 1)
            self.assertTrue(any(name in line and "unknown" in line
                                for line in process.output().splitlines()), process.output())

    def test_profile_path_is_searched_before_the_package(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "generic_cia402.yaml"), "w", encoding="ascii") as file:
                file.write("name: generic_cia402\ncolour: red\n")
            process = Process("bus_node", "own_profile", "config/robots/arm.yaml",
                              interface="sim", profile_path=folder)
            self.assertEqual(process.wait(), 1)
            self.assertIn("colour", process.output())


NODES = ("bus_node", "simulated_drives")


class WithoutMaster(unittest.TestCase):
    """Nobody listens on port 9: what asks a ROS master there waits for ever."""

    ENVIRONMENT = {**os.environ, "ROS_MASTER_URI": "http://localhost:9"}

    def ended_by(self, node, number):
        """Sends a signal to a node that waits for the master. @return how it ended."""
        with tempfile.TemporaryFile("w+") as output, subprocess.Popen(
                [executable(node)], env=self.ENVIRONMENT, stdin=subprocess.DEVNULL, stdout=output,
                stderr=subprocess.STDOUT) as process:
            def said():
                output.seek(0)
                return output.read()
            try:
                wait_until(lambda: "Failed to contact master" in said(), "it waits for the master")
                process.send_signal(number)
                return process.wait(DEADLINE)
            finally:
                process.kill()

    def test_a_signal_ends_the_wait(self):
        for node in NODES:
            for number in (signal.SIGINT, signal.SIGTERM):
                self.assertEqual(self.ended_by(node, number), -number, node)

    def run_with(self, node, *arguments):
        return subprocess.run([executable(node), *arguments], env=self.ENVIRONMENT,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=DEADLINE, check=False)

    def test_help_is_printed_without_a_master(self):
        for node in NODES:
            for option in ("--help", "-h"):
                ended = self.run_with(node, option)
                self.assertEqual((ended.returncode, ended.stderr), (0, ""))
                self.assertTrue(ended.stdout.startswith(f"Usage: {node} "), ended.stdout)
                for word in ("roslaunch", "_interface:=", "_realtime_priority:=", "SIGTERM"):
                    self.assertIn(word, ended.stdout)

    def test_other_arguments_are_refused(self):
        for node in NODES:
            ended = self.run_with(node, "__name:=robot", "robot.yaml")
            self.assertEqual((ended.returncode, ended.stdout), (2, ""))
            self.assertIn('unknown argument "robot.yaml", see --help', ended.stderr)


class MissingInterface(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot("waiting")
        cls.process = Process("bus_node", "waiting", "config/robots/arm.yaml",
                              interface="vcan9")

    @classmethod
    def tearDownClass(cls):
        cls.robot.close()
        cls.process.kill()

    def test_joint_states_are_nan_until_feedback_is_known(self):
        message = wait_until(lambda: self.robot.joint_state, "joint_states")
        self.assertEqual(message.name, ["elbow", "gripper", "shoulder", "wrist"])
        for values in (message.position, message.velocity, message.effort):
            self.assertEqual(len(values), 4)
            self.assertTrue(all(math.isnan(value) for value in values), values)

    def test_axis_states_claim_nothing(self):
        states = wait_until(lambda: self.robot.axis_states, "axis_states")
        for axis in states.axes:
            self.assertEqual(axis.state, "unknown")
            self.assertFalse(axis.homed)
            self.assertTrue(math.isinf(axis.feedback_age))
            for age in (axis.mode_age, axis.velocity_age, axis.effort_age,
                        axis.following_error_age, axis.digital_inputs_age):
                self.assertTrue(math.isnan(age), axis)
            self.assertTrue(axis.stamp.is_zero())

    def test_diagnostics_tell_what_is_missing(self):
        self.robot.wait_diagnostic("bus", ERROR, "vcan9 does not exist: plug")  # as README.md says
        wait_until(lambda: self.robot.bus_state, "bus_state")
        self.assertEqual(self.robot.bus_state.frames_sent, 0)

    def test_services_refuse_in_words(self):
        answer = self.robot.call("shoulder/enable")
        self.assertFalse(answer.success)
        self.assertIn("vcan9", answer.message)

    def test_zz_it_ends_at_once(self):
        wait_until(lambda: self.robot.axis_states, "the node is up")
        began = time.monotonic()
        self.assertEqual(self.process.stop(), 0)
        self.assertLess(time.monotonic() - began, 20.0)


if __name__ == "__main__":
    main("start")
