#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Faults of the simulated drives: how they show and how they end."""
import math
import time

import rospy
from robot_client import ERROR, OK, WARN, RobotTest, main, wait_until


class Faults(RobotTest):
    def tearDown(self):
        for axis in self.AXES:
            self.robot.call("inject_fault", axis=axis, fault="clear")

    def value(self, status, key):
        """A value of a diagnostic status; empty if it is not there."""
        values = self.robot.diagnostic(status).values
        return next((value.value for value in values if value.key == key), "")

    def test_fault_shows_in_words_and_is_cleared(self):
        self.home_and_enable()
        self.robot.emergencies.clear()
        self.succeed("inject_fault", "elbow", axis="elbow", fault="encoder")
        self.robot.wait_diagnostic("elbow", ERROR, "elbow|node 2|0x7305|encoder cable|clear_faults")
        axis = self.robot.wait_state("elbow", "fault")
        self.assertEqual(axis.error_code, 0x7305)
        self.assertIn("incremental sensor", axis.error_text)
        message = wait_until(lambda: next((e for e in self.robot.emergencies
                                           if e.error_code == 0x7305), None), "emergency")
        self.assertEqual(message.node_id, 2)
        self.assertEqual(list(message.axes), ["elbow"])
        self.assertEqual(message.error_register & 0x81, 0x81)
        self.assertIn("incremental sensor 1 fault", message.text)
        self.assertIn("check the encoder cable", message.remedy)
        self.assertLess(abs(rospy.get_time() - message.header.stamp.to_sec()), 20.0)
        self.refuse("elbow/enable", "elbow|clear_faults")
        self.succeed("inject_fault", axis="elbow", fault="clear")
        self.succeed("elbow/clear_faults", "elbow")
        self.robot.wait_diagnostic("elbow", OK, "")
        self.succeed("elbow/enable")
        self.robot.wait_state("elbow", "operation enabled")

    def test_warning_is_shown_as_one_and_stops_nothing(self):
        self.home_and_enable()
        self.robot.wait_diagnostic("elbow", OK)
        self.succeed("inject_fault", axis="elbow", fault="overtemperature_warning")
        status = self.robot.wait_diagnostic("elbow", WARN, "elbow (node 2)|0x4210")
        self.assertNotIn("fault", status.message)
        axis = self.robot.axis("elbow")
        self.assertEqual(axis.state, "operation enabled")
        self.assertTrue(axis.warning)
        goal = self.robot.position("elbow") - 0.1
        self.robot.command("elbow", goal)
        self.robot.wait_at("elbow", goal, 0.005)
        self.succeed("inject_fault", axis="elbow", fault="clear")
        self.robot.wait_diagnostic("elbow", OK)
        self.assertEqual(self.robot.axis("elbow").state, "operation enabled")

    def test_fault_of_one_axis_stops_its_group_only_in_motion(self):
        self.home_and_enable()
        start = self.robot.position("wrist")
        goal = 1.0 if start < 0.0 else -1.0
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"],
                          [(5.0, [-2.0, 0.0, goal, 0.0])])
        wait_until(lambda: abs(self.robot.position("wrist") - start) > 0.1, "it moves")
        seen = len(self.process.output())
        self.succeed("inject_fault", axis="shoulder", fault="overcurrent")
        self.robot.wait_state("shoulder", "fault")
        place = self.robot.wait_rest("wrist")
        self.assertGreater(abs(place - goal), 0.1)
        self.assertEqual(self.robot.axis("wrist").state, "operation enabled")
        self.wait_log("shoulder|2310", seen)
        self.succeed("inject_fault", axis="shoulder", fault="clear")
        self.succeed("clear_faults")

    def test_damiao_fault_goes_the_same_way(self):
        self.succeed("gripper/home")
        self.succeed("gripper/enable")
        self.succeed("inject_fault", axis="gripper", fault="overtemperature")
        self.robot.wait_state("gripper", "fault")
        self.robot.wait_diagnostic("gripper", ERROR, "gripper (node 4): fault 0x4210|"
                                   "device temperature too high|clear_faults")
        self.assertEqual(self.robot.axis("gripper").error_code, 0x4210)
        self.succeed("inject_fault", axis="gripper", fault="clear")
        wait_until(lambda: self.robot.call("gripper/clear_faults").success, "cleared")
        self.succeed("gripper/enable")

    def test_error_history_is_read_after_a_fault_and_by_service(self):
        self.home_and_enable()
        seen = len(self.process.output())
        for fault in ("overcurrent", "encoder"):
            self.succeed("inject_fault", axis="elbow", fault=fault)
            self.robot.wait_state("elbow", "fault")
            self.succeed("inject_fault", axis="elbow", fault="clear")
            self.succeed("elbow/clear_faults")
        self.wait_log("elbow (node 2): the drive's error history (1003h), newest first: 0x", seen)
        answer = self.succeed("elbow/error_history", "elbow (node 2)|1003h|0x7305|0x2310")
        self.assertEqual(list(answer.codes[:2]), [0x7305, 0x2310])
        self.assertEqual(len(answer.infos), len(answer.codes))
        self.assertIn("incremental sensor 1 fault", answer.texts[0])
        wait_until(lambda: "0x2310" in self.value("elbow", "error history after the last fault"),
                   "the history in diagnostics")
        wait_until(lambda: self.value("node 2", "emergencies 0x7305"), "the count in diagnostics")

    def test_bus_off_stops_is_ended_by_the_driver_and_leaves_the_axes_disabled(self):
        self.home_and_enable()
        start = self.robot.position("wrist")
        goal = 1.0 if start < 0.0 else -1.0
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"],
                          [(5.0, [-2.0, 0.0, goal, 0.0])])
        wait_until(lambda: abs(self.robot.position("wrist") - start) > 0.1, "it moves")
        seen = len(self.process.output())
        before = self.robot.bus_state.restarts
        self.succeed("inject_fault", axis="bus", fault="bus_off")
        self.wait_log("stopped: sim is bus-off", seen)
        self.wait_log("sim is back", seen)
        wait_until(lambda: self.robot.bus_state.restarts == before + 1, "restarts are counted")
        self.assertGreaterEqual(self.robot.bus_state.restart_attempts, 1)
        self.robot.wait_diagnostic("bus", OK, "")
        for name in self.AXES:
            self.robot.wait_axis(name, lambda axis: axis.state != "operation enabled", "disabled")
        wait_until(lambda: all(node.ready for node in self.robot.bus_state.nodes), "ready again")
        wait_until(self.robot.recovered, "recovered")
        self.home_and_enable()
        place = self.robot.wait_rest("wrist")
        self.robot.command("wrist", place + 0.1)
        self.robot.wait_at("wrist", place + 0.1)

    def test_unknown_fault_or_axis_is_refused_with_the_names(self):
        self.refuse("inject_fault", "encoder|overcurrent|power_cycle", axis="elbow",
                    fault="headache")
        self.refuse("inject_fault", "neck", axis="neck", fault="encoder")

    def test_power_cycle_is_noticed_and_recover_brings_the_axis_back(self):
        self.home_and_enable()
        boots = self.robot.node("wrist").boot_ups
        self.succeed("inject_fault", axis="wrist", fault="power_cycle")
        wait_until(lambda: self.robot.node("wrist").boot_ups > boots, "the boot-up is counted")
        wait_until(lambda: self.robot.node("wrist").ready, "configured again")
        axis = self.robot.wait_axis("wrist", lambda state: state.state == "switch on disabled",
                                    "left disabled")
        self.assertNotEqual(axis.state, "operation enabled")
        self.refuse("wrist/recover", "wrist is not homed: home")
        if not self.robot.axis("wrist").homed:
            self.succeed("wrist/home")
        self.succeed("wrist/enable")
        place = self.robot.position("wrist")
        self.robot.command("wrist", place + 0.2)
        self.robot.wait_at("wrist", place + 0.2, 0.005)
        self.robot.wait_rest("wrist")  # the next test's trajectory is refused before

    def test_silent_drives_freeze_the_stamps(self):
        self.robot.joint_states, self.robot.record = [], True
        for axis in self.AXES:
            self.succeed("inject_fault", axis=axis, fault="silent")
        silent = rospy.get_time()
        wait_until(lambda: all(map(math.isnan, self.robot.joint_state.position)),
                   "positions unknown")
        self.robot.record = False
        self.robot.wait_diagnostic("node 3", ERROR, "wrist")
        # A place stays known until its TPDOs were missed too often, and keeps its time.
        known = [message for _, message in self.robot.joint_states
                 if not all(map(math.isnan, message.position))]
        self.assertTrue(known)
        for message in known:
            self.assertLess(message.header.stamp.to_sec(), silent)
        for axis in self.AXES:
            self.succeed("inject_fault", axis=axis, fault="clear")
        wait_until(self.robot.recovered, "recovered")
        self.robot.wait_ready()

    def test_sigint_in_motion_ends_in_time(self):
        self.home_and_enable()
        self.robot.follow(["shoulder", "elbow", "wrist", "gripper"], [(6.0, [-0.5, 0.8, 1.5, 1.0])])
        start = self.robot.position("shoulder")
        wait_until(lambda: abs(self.robot.position("shoulder") - start) > 0.1, "it moves")
        began = time.monotonic()
        self.assertEqual(self.process.stop(), 0)
        self.assertLess(time.monotonic() - began, 60.0)  # the drives themselves: see test/vcan
        self.assertIn("stopped", self.process.output())
        self.robot.close()
        self.setUpClass()


if __name__ == "__main__":
    main("faults")
