#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Node guarding between bus_node and simulated_drives, two processes on vcan0."""
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import ERROR, OK, Process, Robot, RobotTest, main, wait_until  # noqa: E402
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/guarding.yaml"
GUARD = 0x701
PERIOD = 0.3


class Guarding(RobotTest):
    """One life of a robot, in the order of the names: starting costs seconds here."""

    AXES = ["guarded", "other"]

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.start_drives()
        cls.process = Process("bus_node", "robot", CONFIG)

    @classmethod
    def start_drives(cls):
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    def requests(self, since):
        return [at for at, identifier in self.wire.remote_since(since) if identifier == GUARD]

    def test_01_boots_and_is_asked_by_remote_frames_with_alternating_answers(self):
        self.robot.wait_ready(60.0)
        began = time.monotonic()
        wait_until(lambda: len(self.requests(began)) >= 10, "ten requests")  # machines may be late
        requests = self.requests(began)
        self.assertLess(len(requests), 2 + 1.5 * (time.monotonic() - began) / PERIOD)

        def guard_answers():
            return [data[0] for _, identifier, data in self.wire.since(began) if identifier == GUARD]
        wait_until(lambda: len(guard_answers()) >= 8, "eight answers")
        answers = guard_answers()
        self.assertEqual(set(answers), {0x05, 0x85})
        self.assertTrue(all(one != two for one, two in zip(answers, answers[1:])), answers)
        self.assertFalse(any(identifier == 0x702 for _, identifier in self.wire.remote_since(0.0)))
        self.robot.wait_diagnostic("node 1", OK, "operational")

    def test_02_drive_killed_is_noticed_in_words_and_taken_in_again(self):
        self.robot.wait_ready()
        self.drives.kill()
        self.robot.wait_diagnostic("node 1", ERROR, "guarded|no answer to node guarding")
        self.start_drives()
        self.robot.bus_state = None
        self.robot.wait_ready(60.0)

    def test_03_node_killed_makes_the_guarded_drive_stop(self):
        wait_until(self.robot.recovered, "recovered")
        self.robot.turn({"guarded": 0.3})
        began = time.monotonic()
        self.process.kill()
        self.assertGreater(self.wire.travel(1), 1000, "it turns on at first")
        wait_until(lambda: self.wire.first(
            began, lambda identifier, data: identifier == 0x81
            and data[:2] == bytes([0x30, 0x81])), "EMCY 8130 of the guarded drive")
        wait_until(lambda: self.wire.travel(1) == 0, "it stands", 10.0)
        self.assertFalse(self.wire.powered(1))
        self.assertEqual(self.wire.travel(1, 1.0), 0, "it stays there")


if __name__ == "__main__":
    main("guarding")
