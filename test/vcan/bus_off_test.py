#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The controller of bus_node falls off vcan0: error frames are injected as its driver would."""
import os
import socket
import struct
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import (ERROR, OK, Process, Robot, RobotTest, main,  # noqa: E402
                          wait_until)
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/robot.yaml"
JOINTS = ["shoulder", "wrist", "gripper"]
ERROR_FLAG, BUS_OFF, RESTARTED, CONTROLLER = 0x20000000, 0x40, 0x100, 0x204


class Controller:
    """Tells what a CAN controller would. While it is off, it says so again and again: on vcan0 the
    frames of the drives still arrive, which would otherwise prove it back."""

    def __init__(self):
        self._socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.bind(("vcan0",))
        self._off = threading.Event()
        self._open = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def tell(self, error, data=bytes(8)):
        self._socket.send(struct.pack("=IB3x8s", ERROR_FLAG | error, 8, data))

    def _run(self):
        while self._open:
            if self._off.is_set():
                self.tell(BUS_OFF)
            time.sleep(0.01)

    def fall_off(self):
        self._off.set()

    def keep_quiet(self):
        """Bus-off is over, and nobody says so."""
        self._off.clear()

    def restart(self):
        self._off.clear()
        time.sleep(0.05)
        self.tell(RESTARTED)

    def close(self):
        self._open = False
        self._thread.join()
        self._socket.close()


class BusOff(RobotTest):
    AXES = sorted(JOINTS)

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        cls.process = Process("bus_node", "robot", CONFIG)
        cls.controller = Controller()

    @classmethod
    def tearDownClass(cls):
        cls.controller.close()
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    def tearDown(self):
        self.controller.keep_quiet()  # one that failed leaves a bus to the next

    def begin_motion(self):
        self.robot.wait_ready(60.0)
        wait_until(self.robot.recovered, "recovered")
        self.home_and_enable()
        start = self.robot.wait_rest("wrist")
        goal = 2.5 if start < 0.0 else -2.5
        self.robot.follow(JOINTS, [(8.0, [1.5, goal, 1.2])])
        wait_until(lambda: abs(self.robot.position("wrist") - start) > 0.1, "it moves")

    def expect_back_and_disabled(self):
        self.robot.wait_diagnostic("bus", OK, "vcan0")
        self.robot.bus_state = self.robot.axis_states = None
        self.robot.wait_ready(60.0)
        for name in JOINTS:
            self.robot.wait_axis(name, lambda axis: axis.state != "operation enabled", "disabled")
            self.robot.wait_rest(name)
        wait_until(self.robot.recovered, "recovered")
        self.home_and_enable()
        place = self.robot.wait_rest("wrist")
        self.robot.command("wrist", place + 0.1)
        self.robot.wait_at("wrist", place + 0.1)

    def test_01_in_motion_stops_says_what_to_do_and_comes_back_with_the_restart(self):
        self.begin_motion()
        began = len(self.process.output())
        quiet = time.monotonic()
        self.controller.fall_off()
        self.robot.wait_diagnostic("bus", ERROR, "vcan0 is bus-off|check wiring")
        self.wait_log("stopped: vcan0 is bus-off", began)
        self.wait_log("wrist (node 3): vcan0 is bus-off: nothing reaches the drive", began)
        # Refused, or accepted and ended: vcan0 tells nothing of a controller, so that an attempt to
        # come back succeeds until the next error frame.
        self.refuse("enable", "vcan0 is bus-off|nothing reaches the drive")
        for node in (1, 3):  # for want of the master's heartbeat
            wait_until(lambda: self.wire.first(
                quiet, lambda identifier, data: identifier == 0x80 + node
                and data[:2] == bytes([0x30, 0x81])), f"EMCY 8130 of node {node}")
        for name in JOINTS:
            self.robot.wait_rest(name)
        self.controller.restart()
        self.wait_log("vcan0 is back", began)
        self.assertGreaterEqual(self.robot.bus_state.bus_off_events, 1)
        self.expect_back_and_disabled()
        self.assertGreaterEqual(self.robot.bus_state.restarts, 1)
        answer = self.succeed("wrist/error_history", "error history (1003h): ")
        self.assertIn(0x8130, answer.codes)
        self.assertEqual(len(answer.codes), len(answer.texts))

    def test_02_ends_without_a_word_of_the_controller_once_frames_arrive(self):
        self.begin_motion()
        self.controller.fall_off()
        self.robot.wait_diagnostic("bus", ERROR, "vcan0 is bus-off")
        self.controller.keep_quiet()
        self.expect_back_and_disabled()

    def test_03_ends_on_a_silent_interface_without_a_controller(self):
        self.drives.stop()
        self.controller.fall_off()
        wait_until(lambda: self.robot.bus_state.state == "bus-off", "bus-off")
        self.controller.keep_quiet()
        wait_until(lambda: self.robot.bus_state.state == "error active", "back")
        type(self).drives = Process("simulated_drives", "simulated_drives", CONFIG)
        self.expect_back_and_disabled()

    def test_04_error_counters_and_classes_are_shown(self):
        self.controller.tell(CONTROLLER, bytes([0, 0x08, 0, 0, 0, 0, 104, 7]))
        wait_until(lambda: self.robot.bus_state.state == "error warning", "error warning")
        wait_until(lambda: self.robot.bus_state.transmit_errors == 104, "transmit errors")
        self.assertEqual(self.robot.bus_state.receive_errors, 7)
        self.controller.tell(CONTROLLER, bytes([0, 0x40, 0, 0, 0, 0, 0, 0]))
        self.robot.wait_diagnostic("bus", OK, "vcan0")
        self.controller.tell(0x002, bytes([11, 0, 0, 0, 0, 0, 0, 0]))
        wait_until(lambda: self.robot.bus_state.arbitration_lost == 1, "arbitration lost")


if __name__ == "__main__":
    main("bus_off")
