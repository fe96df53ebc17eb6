#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Two simulated drives without node-IDs on vcan0 get them by LSS, boot and move."""
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import Process, Robot, RobotTest, main, wait_until  # noqa: E402
from cia402_driver.msg import LssIdentity  # noqa: E402
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/lss.yaml"
LSS_REQUEST, LSS_ANSWER = 0x7E5, 0x7E4
FASTSCAN, IDENTIFIED, SELECT_SERIAL, SELECTED, CONFIGURE_NODE_ID = 0x51, 0x4F, 0x43, 0x44, 0x11
SERIALS = {"left": 1111, "right": 2222}


def identity(serial):
    return {"vendor_id": 1234, "product_code": 1026, "revision": 65536, "serial": serial}


class Lss(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()

    @classmethod
    def tearDownClass(cls):
        cls.wire.close()

    def start(self, **parameters):
        """New drives, none of which has a node-ID, and a new driver."""
        self.began = time.monotonic()
        self.robot = Robot()
        self.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        wait_until(lambda: "simulat" in self.drives.output(), "drives there")
        self.process = Process("bus_node", "robot", CONFIG, **parameters)

    def tearDown(self):
        self.robot.close()
        self.process.stop()
        self.drives.stop()

    def requests(self, command):
        return [data for _, identifier, data in self.wire.since(self.began)
                if identifier == LSS_REQUEST and data[0] == command]

    def answers(self, command):
        return [data for _, identifier, data in self.wire.since(self.began)
                if identifier == LSS_ANSWER and data[0] == command]

    def boots_and_moves(self):
        self.robot.wait_ready(60.0)
        self.succeed("enable")
        self.robot.follow(["left", "right"], [(3.0, [0.4, -0.6])])
        self.robot.wait_at("left", 0.4)
        self.robot.wait_at("right", -0.6)
        self.succeed("disable")

    def test_assigned_at_start_by_identity_they_boot_and_move(self):
        self.start(**{f"axes/{axis}/lss": identity(serial) for axis, serial in SERIALS.items()})
        self.wait_log("left (node 1): LSS: the device got node-ID 1")
        self.wait_log("right (node 2): LSS: the device got node-ID 2")
        self.assertEqual(self.requests(FASTSCAN), [])
        self.assertEqual({int.from_bytes(data[1:5], "little")
                          for data in self.requests(SELECT_SERIAL)}, set(SERIALS.values()))
        self.assertTrue(self.answers(SELECTED))
        self.assertEqual({data[1] for data in self.requests(CONFIGURE_NODE_ID)}, {1, 2})
        self.boots_and_moves()

    def test_found_by_fastscan_and_assigned_by_service_they_boot_and_move(self):
        self.start()
        # The timers of user-mode Linux are late by several ms, so are the answers.
        scan = self.succeed("lss_scan", "2 devices without a node-ID", window=0.05)
        self.assertTrue(self.requests(FASTSCAN))
        self.assertTrue(self.answers(IDENTIFIED))
        self.assertEqual(sorted(device.serial for device in scan.devices), [1111, 2222])
        self.refuse("lss_assign", "nobody answered", node_id=1,
                    device=LssIdentity(**identity(3333)))
        for axis, node in (("left", 1), ("right", 2)):
            device = next(d for d in scan.devices if d.serial == SERIALS[axis])
            self.succeed("lss_assign", f"got node-ID {node}", device=device, node_id=node)
        self.boots_and_moves()
        self.succeed("lss_scan", "0 devices without a node-ID", window=0.05)


if __name__ == "__main__":
    main("lss_vcan")
