#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What bus_node lets the kernel hand it of a bus that it shares with devices of somebody else."""
import os
import socket
import struct
import sys
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import Process, Robot, main, wait_until  # noqa: E402
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/receive.yaml"
FIXED = "test/vcan/fixed_ids.yaml"
FOREIGN = 0x4A5     # TPDO 4 of node 37, which is not configured
FRAMES = 4000       # of 8 bytes: 111 bits each
CAN_EFF_FLAG = 0x80000000
NODES = range(1, 3)


def from_drives(identifier):
    """Frames of the two drives: EMCY, TPDOs, SDO answers, heartbeats."""
    node, service = identifier & 0x7F, identifier & ~0x7F
    return node in NODES and service in (0x080, 0x180, 0x280, 0x380, 0x480, 0x580, 0x700)


class Receive(unittest.TestCase):
    def setUp(self):
        self.wire, self.robot, self.processes = Wire(), Robot(), []

    def tearDown(self):
        for process in reversed(self.processes):
            process.stop()
        self.robot.close()
        self.wire.close()

    def start(self, config, **parameters):
        self.processes.append(Process("simulated_drives", "simulated_drives", config))
        self.processes.append(Process("bus_node", "robot", config, **parameters))
        self.robot.wait_ready(120.0)

    def state(self):
        """The next bus_state from now on."""
        self.robot.bus_state = None
        return wait_until(lambda: self.robot.bus_state, "bus_state")

    def quiet(self):
        """A bus_state of the bus at rest: a boot loads it more."""
        return wait_until(lambda: 0.001 < self.state().load < 0.06 and self.robot.bus_state,
                          lambda: f"a bus that is at rest\n{self.robot.bus_state}")

    def send_foreign(self, identifier):
        """In portions that fit a socket's buffer. @return bus_states before, the busiest one
        meanwhile and after; frames of the drives between the first and the last."""
        before, began, busiest = self.state(), time.monotonic(), None
        with socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as other:
            other.bind(("vcan0",))
            for sent in range(FRAMES):
                other.send(struct.pack("=IB3x8s", identifier, 8, bytes(8)))
                if sent % 20 == 0:
                    time.sleep(0.02)
                state = self.robot.bus_state
                if state and (busiest is None or state.load > busiest.load):
                    busiest = state
        time.sleep(2.0)  # the load of the last second comes afterwards
        after = self.state()
        busiest = max(busiest, after, key=lambda state: state.load)
        frames = sum(from_drives(i) for _, i, _ in self.wire.since(began))
        return before, busiest, after, frames

    def test_01_frames_of_others_do_not_reach_the_driver_but_count_as_load(self):
        self.start(CONFIG)
        quiet = self.quiet()
        for identifier in (FOREIGN, CAN_EFF_FLAG | 0x80181):  # its lower 11 bits are a TPDO
            before, busiest, after, frames = self.send_foreign(identifier)
            received = after.frames_received - before.frames_received
            self.assertLess(abs(received - frames), 150, f"{received} of {frames} and {FRAMES}")
            self.assertGreater(busiest.load, quiet.load + 0.02, f"from {quiet.load}")
            self.assertGreater(busiest.load_most, busiest.load)
            self.assertEqual(after.receive_overflows, 0)

    def test_02_all_of_them_do_where_the_configuration_says_so(self):
        self.start(CONFIG, **{"bus/receive": "all"})
        quiet = self.quiet()
        before, busiest, after, frames = self.send_foreign(FOREIGN)
        received = after.frames_received - before.frames_received
        self.assertLess(abs(received - frames - FRAMES), 150)
        self.assertGreater(busiest.load, quiet.load + 0.02)

    def test_03_a_drive_that_insists_on_another_cob_id_is_heard(self):
        self.start(FIXED)
        wait_until(lambda: "insists on COB-IDs of its own" in self.processes[1].output(),
                   "the log says why everything is received")
        self.assertTrue(self.robot.call("recover").success)
        began = time.monotonic()
        self.robot.command("fixed", 0.3)

        def place():
            found = [data for _, i, data in self.wire.since(began) if i == 0x1E5]
            return struct.unpack_from("<Hi", found[-1])[1] * 6.283185307 / (65536 * 50)
        wait_until(lambda: abs(place() - 0.3) < 0.005, lambda: f"the motor at 0.3, not {place()}")


if __name__ == "__main__":
    main("receive")
