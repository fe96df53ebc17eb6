#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Two simulated drives without node-IDs on vcan0 get them by LSS, boot and move."""
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import Process, Robot, RobotTest, main, rospy, wait_until  # noqa: E402
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
        self.addCleanup(self.robot.close)
        self.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        self.addCleanup(self.drives.stop)
        rospy.wait_for_service("/simulated_drives/inject_fault", 40.0)
        self.process = Process("bus_node", "robot", CONFIG, **parameters)
        self.addCleanup(self.process.stop)

    def requests(self, command):
        return [data for _, identifier, data in self.wire.since(self.began)
                if identifier == LSS_REQUEST and data[0] == command]

    def answers(self, command):
        return [data for _, identifier, data in self.wire.since(self.began)
                if identifier == LSS_ANSWER and data[0] == command]

    def scan(self, words):
        """On a slow machine the answers are late: as the service says, with a longer window then."""
        for window in (0.05, 0.2, 0.5):
            answer = self.robot.call("lss_scan", window=window)
            if answer.success and words in answer.message:
                break
        self.assertTrue(answer.success, answer.message)
        self.assertIn(words, answer.message)
        return answer

    def boots_and_moves(self):
        self.robot.wait_ready(60.0)
        goal = {"left": 0.4, "right": -0.6}

        def moved():
            self.robot.follow(list(goal), [(3.0, list(goal.values()))])
            rospy.sleep(4.0)
            return all(abs(self.robot.position(joint) - place) < 0.01
                       for joint, place in goal.items())
        # A machine that forgets the drives for seconds lets them stop and be booted again.
        wait_until(lambda: self.robot.recovered() and moved(), "moved", 120.0)
        self.succeed("disable")

    def test_assigned_at_start_by_identity_they_boot_and_move(self):
        self.start(**{f"axes/{axis}/lss": identity(serial) for axis, serial in SERIALS.items()})
        self.boots_and_moves()
        self.assertEqual(self.requests(FASTSCAN), [])
        self.assertEqual({int.from_bytes(data[1:5], "little")
                          for data in self.requests(SELECT_SERIAL)}, set(SERIALS.values()))
        self.assertTrue(self.answers(SELECTED))
        self.assertEqual({data[1] for data in self.requests(CONFIGURE_NODE_ID)}, {1, 2})

    def test_found_by_fastscan_and_assigned_by_service_they_boot_and_move(self):
        self.start()
        scan = self.scan("2 devices without a node-ID")
        self.assertTrue(self.requests(FASTSCAN))
        self.assertTrue(self.answers(IDENTIFIED))
        self.assertEqual(sorted(device.serial for device in scan.devices), [1111, 2222])
        self.refuse("lss_assign", "nobody answered", node_id=1,
                    device=LssIdentity(**identity(3333)))
        for axis, node in (("left", 1), ("right", 2)):
            device = next(d for d in scan.devices if d.serial == SERIALS[axis])
            self.succeed("lss_assign", f"got node-ID {node}", device=device, node_id=node)
        self.boots_and_moves()
        self.scan("0 devices without a node-ID")


if __name__ == "__main__":
    main("lss_vcan")
