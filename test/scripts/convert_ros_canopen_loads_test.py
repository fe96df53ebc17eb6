#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What scripts/convert_ros_canopen writes is a robot that the driver loads, homes and moves."""
import subprocess
import unittest

import yaml

from ros_canopen_files import BUS, COMPOUNDS, REPOSITORY, Case, eds

MOVE_ARM = REPOSITORY / "build/ros/move_arm"
TYPES = {"int8": 2, "int16": 3, "int32": 4, "uint8": 5, "uint16": 6, "uint32": 7}
CONTROLLERS = """
arm:
  type: position_controllers/JointTrajectoryController
  joints: [shoulder, elbow]
  constraints: {goal_time: 1.0, shoulder: {trajectory: 0.2, goal: 0.05}}
  required_drive_mode: %d
joint_state_controller: {type: joint_state_controller/JointStateController, publish_rate: 100}
elbow_velocity: {type: velocity_controllers/JointVelocityController, joint: elbow,
                 required_drive_mode: 9}
joint_limits:
  shoulder: &limits {has_position_limits: true, min_position: -3, max_position: 3,
                     has_velocity_limits: true, max_velocity: 2, has_acceleration_limits: true,
                     max_acceleration: 8}
  elbow: *limits
"""


def whole_eds():
    """The EDS of a drive that has all objects of generic_cia402."""
    file = REPOSITORY / "config/drives/generic_cia402.yaml"
    profile = yaml.safe_load(file.read_text(encoding="utf-8"))
    objects = {}
    for entry in profile["objects"].values():
        index, sub = (int(part, 16) for part in entry["object"].split(":"))
        objects[(index, sub)] = (TYPES[entry["type"]], entry.get("access", "rw"))
    assert {index for index, sub in objects if sub} <= set(COMPOUNDS)
    return eds(objects, head="VendorName=nobody")


class Loads(Case):
    def setUp(self):
        super().setUp()
        self.write("servo.eds", whole_eds())

    def robot(self, defaults, mode):
        """Converts into robot.yaml."""
        self.write("driver.yaml", BUS + f"defaults:\n  eds_file: servo.eds\n{defaults}"
                   "nodes: {shoulder: {id: 3}, elbow: {id: 4}}\n" + CONTROLLERS % mode)
        converted = self.run_script("--output", "robot.yaml", "driver.yaml")
        self.assertIn(converted.status, (0, 1), converted.report)
        return self.folder / "robot.yaml"

    def run_robot(self, file, interface):
        file.write_text(file.read_text(encoding="utf-8").replace("interface: "
                                                                 "can1", f"interface: {interface}"),
                        encoding="utf-8")
        return subprocess.run([MOVE_ARM, REPOSITORY / "config", file], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=120, check=False)

    def test_it_moves(self):
        for mode in (7, 8):
            overlay = "  dcf_overlay: {\"6098\": \"35\", \"6065\": \"90000\", \"6084\": \"720000\"}\n"
            ended = self.run_robot(self.robot(overlay, mode), "sim")
            self.assertEqual((ended.returncode, ended.stderr), (0, ""), ended.stdout)
            self.assertIn("arm: goal reached", ended.stdout)

    def test_a_profile_of_its_own_is_loaded(self):
        """An interface that is not there is waited for; what is wrong in the file is told before."""
        text = "  pos_to_device: pos*4096*50/(2*pi)\n  pos_from_device: obj6064*2*pi/4096/50\n" \
            "  vel_to_device: vel*50*60/(2*pi)\n  vel_from_device: obj606C*2*pi/60/50\n" \
            "  dcf_overlay: {\"6098\": \"-3\"}\n" \
            "  motor_layer: {switching_state: 4, state_switch_timeout: 6}\n"
        file = self.robot(text, 8)
        self.assertIn("robot_drive.yaml", file.read_text(encoding="utf-8"))
        ended = self.run_robot(file, "none0")
        self.assertEqual(ended.stderr, "")
        self.assertIn("none0 is not there yet", ended.stdout)


if __name__ == "__main__":
    unittest.main()
