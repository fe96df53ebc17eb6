#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""/diagnostics of the demo robot as config/diagnostics.yaml has diagnostic_aggregator group it."""
import unittest

import rospy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from robot_client import ERROR, OK, WARN, Robot, main, wait_until

AXES = ["shoulder", "elbow", "wrist", "tool", "gripper"]
STALE = DiagnosticStatus.STALE
GROUPS = ["/bus", "/bus/Bus", "/bus/Nodes", "/bus/Axes"]
MEMBERS = (["/bus/Bus/bus"] + [f"/bus/Nodes/node {node}" for node in range(1, 6)] +
           [f"/bus/Axes/{axis}" for axis in AXES])


class Aggregated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.report = []  # the newest
        cls.subscriber = rospy.Subscriber("/diagnostics_agg", DiagnosticArray,
                                          lambda message: cls.report.__setitem__(
                                              slice(None), message.status))
        cls.robot = Robot("bus", "arm")
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        cls.subscriber.unregister()
        cls.robot.close()

    def tearDown(self):
        for axis in AXES:
            self.robot.call("inject_fault", axis=axis, fault="clear")
        wait_until(self.robot.recovered, "recovered")
        self.robot.call("disable")
        self.wait_levels({"/bus/Axes": OK})

    def levels(self):
        return {status.name: status.level for status in self.report}

    def wait_levels(self, wanted):
        """Until a report has these levels. @return it, {name: status}."""
        def met():
            report = {status.name: status for status in list(self.report)}
            hit = all(name in report and report[name].level == level
                      for name, level in wanted.items())
            return report if hit else None
        return wait_until(met, lambda: f"levels {wanted}\n{self.report}")

    def test_every_status_has_its_group_and_none_is_left_over(self):
        wait_until(lambda: set(MEMBERS) <= set(self.levels()), lambda: f"all\n{self.levels()}")
        self.assertEqual(set(self.levels()), set(GROUPS + MEMBERS))

    def test_a_disabled_robot_is_well(self):
        report = self.wait_levels({f"/bus/Axes/{axis}": OK for axis in AXES} | {"/bus/Axes": OK})
        self.assertEqual(report["/bus/Axes/elbow"].message, "switch on disabled")
        # The tool's drive has no 1016h, and it is a warning for as long as it is so.
        self.wait_levels({"/bus/Bus": OK, "/bus/Nodes": WARN, "/bus/Nodes/node 4": WARN, "/bus": WARN})

    def test_a_fault_shows_in_its_axis_and_above_until_it_is_cleared(self):
        fault = self.robot.call("inject_fault", axis="elbow", fault="encoder")
        self.assertTrue(fault.success, fault.message)
        report = self.wait_levels({"/bus/Axes/elbow": ERROR, "/bus/Axes": ERROR, "/bus": ERROR})
        for words in ("elbow (node 2)", "clear_faults"):
            self.assertIn(words, report["/bus/Axes/elbow"].message)
        told = report["/bus/Axes/elbow"].message
        others = {axis: report[f"/bus/Axes/{axis}"].level for axis in AXES if axis != "elbow"}
        self.assertEqual(set(others.values()), {OK}, others)
        self.assertTrue(self.robot.call("inject_fault", axis="elbow", fault="clear").success)
        answer = self.robot.call("elbow/clear_faults")
        self.assertTrue(answer.success, answer.message)
        report = self.wait_levels({"/bus/Axes/elbow": OK, "/bus/Axes": OK, "/bus": WARN})
        values = {pair.key: pair.value for pair in report["/bus/Axes/elbow"].values}
        self.assertEqual(values["last error"], told)
        self.assertGreater(float(values["last error age"].split()[0]), 0.0)
        self.assertEqual(values["limits"], "-2 to 2 rad, 1.8 rad/s, 5 rad/s^2, 100 N m")
        self.assertEqual(values["waits for"], "nothing")

    def test_a_drive_that_falls_silent_is_stale_and_its_node_an_error(self):
        silent = self.robot.call("inject_fault", axis="wrist", fault="silent")
        self.assertTrue(silent.success, silent.message)
        report = self.wait_levels({"/bus/Axes/wrist": STALE, "/bus/Nodes/node 3": ERROR,
                                   "/bus/Axes": ERROR, "/bus/Nodes": ERROR, "/bus": ERROR})
        self.assertIn("wrist (node 3)", report["/bus/Axes/wrist"].message)

    def test_lateness_of_sync_is_counted_in_bands(self):
        report = self.wait_levels({"/bus/Bus/bus": OK})
        values = {pair.key: pair.value for pair in report["/bus/Bus/bus"].values}
        bands = [int(count) for key, count in values.items()
                 if key.startswith(("SYNC lateness up to ", "SYNC lateness above "))]
        self.assertEqual(len(bands), 10)
        self.assertEqual(sum(bands), int(values["cycles"]))
        self.assertEqual(bands[0], sum(bands))  # the simulation waits for its driver


if __name__ == "__main__":
    main("diagnostics")
