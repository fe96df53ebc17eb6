#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""LSS: drives that get their node-IDs from the configuration or by service."""
from cia402_driver.msg import LssIdentity
from robot_client import ERROR, Process, Robot, RobotTest, main, wait_until

CONFIG = "test/vcan/lss.yaml"


def identity(serial):
    return {"vendor_id": 1234, "product_code": 1026, "revision": 65536, "serial": serial}


class Lss(RobotTest):
    @classmethod
    def setUpClass(cls):
        pass

    @classmethod
    def tearDownClass(cls):
        pass

    def start(self, **parameters):
        self.robot = Robot()
        self.process = Process("bus_node", "robot", CONFIG, interface="sim", **parameters)

    def tearDown(self):
        self.robot.close()
        self.process.stop()

    def test_one_by_configuration_the_other_by_service(self):
        self.start(**{"axes/right/lss": identity(2222)})
        wait_until(lambda: self.robot.node("right") and self.robot.node("right").ready, "right up")
        scan = self.succeed("lss_scan", "1 device without a node-ID|serial 1111")
        self.assertEqual([device.serial for device in scan.devices], [1111])
        self.assertEqual(scan.axes, [""])
        for node, words in ((2, "node-ID 2 is that of a drive in operation"), (0, "not in 1..127"),
                            (127, "the master's own")):
            self.refuse("lss_assign", words, device=scan.devices[0], node_id=node)
        self.refuse("lss_assign", "serial 3333|nobody answered", node_id=1,
                    device=LssIdentity(**identity(3333)))
        self.succeed("lss_assign", "got node-ID 1", device=scan.devices[0], node_id=1, store=True)
        self.robot.wait_ready()
        self.succeed("enable")
        self.robot.follow(["left", "right"], [(2.0, [0.4, -0.6])])
        self.robot.wait_at("right", -0.6)
        # What was stored outlives the power, what was not is given again.
        self.succeed("disable")
        for axis in ("left", "right"):
            boots = self.robot.node(axis).boot_ups
            self.succeed("inject_fault", axis=axis, fault="power_cycle")
            wait_until(lambda: self.robot.node(axis).boot_ups > boots
                       and self.robot.node(axis).ready, f"{axis} power-cycled and ready")
        self.succeed("lss_scan", "0 devices without a node-ID")

    def test_a_drive_that_is_not_there_is_told(self):
        self.start(**{"axes/left/lss": identity(3333), "axes/right/lss": identity(2222)})
        wait_until(lambda: self.robot.node("right") and self.robot.node("right").ready, "right up")
        self.robot.wait_diagnostic("node 1", ERROR, "left (node 1): LSS: |serial 3333")
        self.refuse("left/recover", "left")
        self.succeed("right/enable")

    def test_bit_timing(self):
        self.start(**{f"axes/{axis}/simulation/unconfigured": False for axis in ("left", "right")})
        self.robot.wait_ready()
        self.refuse("lss_set_bit_timing", "no bit timing of 300 kbit/s", kbit_per_s=300)
        self.refuse("lss_set_bit_timing", "no axis \"nobody\"", axis="nobody", kbit_per_s=500)
        self.refuse("lss_set_bit_timing", "delay must be 0 to 60 s", kbit_per_s=500, delay=-1.0)
        self.succeed("lss_set_bit_timing", "left (node 1): set (not stored) 500 kbit/s",
                     axis="left", kbit_per_s=500)
        self.succeed("left/enable")
        self.refuse("lss_set_bit_timing", "left (node 1) is not disabled", kbit_per_s=500)
        self.succeed("left/disable")
        self.succeed("lss_set_bit_timing", "all devices switch in 200 ms|bitrate 500000",
                     kbit_per_s=500, activate=True, delay=0.2)
        wait_until(lambda: not any(node.ready for node in self.robot.bus_state.nodes),
                   "the drives are silent until the bus follows")


if __name__ == "__main__":
    main("lss")
