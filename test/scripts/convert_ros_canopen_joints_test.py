#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/convert_ros_canopen: controllers become groups and modes, limits those of the joints."""
import math
import unittest

from ros_canopen_files import BUS, DEFAULTS, NODES, SERVO, Case, eds

CONVERTED, APPROXIMATED, NONE = "converted", "approximated", "no counterpart"


class Controllers(Case):
    TRAJECTORY = """
arm_controller:
  type: position_controllers/JointTrajectoryController
  joints: [shoulder, elbow]
  constraints:
    goal_time: 0.6
    stopped_velocity_tolerance: 0.05
    shoulder: {trajectory: 0.1, goal: 0.02}
  stop_trajectory_duration: 0.5
  allow_partial_joints_goal: true
  state_publish_rate: 25
  gains: {shoulder: {p: 1}}
  required_drive_mode: %d
"""

    def setUp(self):
        super().setUp()
        objects = {**SERVO, (0x60C1, 1): (4, "rw"), (0x6502, 0): (7, "ro")}
        self.write("servo.eds", eds(objects, defaults={(0x6502, 0): "0x3ED"}))  # all but vl

    def test_a_trajectory_controller_is_a_group(self):
        converted = self.with_defaults("", more=self.TRAJECTORY % 8)
        self.assertEqual(converted.robot["groups"], {"arm_controller": {
            "joints": ["shoulder", "elbow"], "allow_partial_joints_goal": True,
                                                                        "stop_trajectory_duration": 0.5,
            "constraints": {"goal_time": 0.6, "stopped_velocity_tolerance": 0.05,
                            "shoulder": {"trajectory": 0.1, "goal": 0.02}}}})
        self.assertEqual(converted.axis()["mode"], "cyclic_position")
        self.told(converted, NONE, "arm_controller/state_publish_rate")
        self.told(converted, NONE, "arm_controller/gains", "the drive closes the loops")

    def test_interpolated_positions_are_a_stream_profile_positions_are_none(self):
        self.assertEqual(self.with_defaults("", more=self.TRAJECTORY % 7).axis()["mode"],
                         "interpolated_position")
        converted = self.with_defaults("", more=self.TRAJECTORY % 1)
        self.assertEqual((converted.axis()["mode"], converted.axis()["modes"]),
                         ("cyclic_position", ["profile_position"]))
        self.told(converted, APPROXIMATED, "arm_controller",
                  "profile_position follows no stream of positions: "
                  "shoulder gets cyclic_position")

    def test_a_drive_without_a_stream_of_positions_is_in_no_group(self):
        self.write("servo.eds", eds({**SERVO, (0x6502, 0): (7, "ro")}, defaults={(0x6502, 0): "0x25"}))
        converted = self.with_defaults("", more=self.TRAJECTORY % 1)
        self.assertNotIn("groups", converted.robot)
        self.told(converted, NONE, "arm_controller", "elbow has no mode that follows a stream")

    def test_controllers_that_forward_commands_are_topics_and_modes(self):
        more = self.TRAJECTORY % 8 + """
joint_state_controller: {type: joint_state_controller/JointStateController, publish_rate: 100}
one: {type: velocity_controllers/JointVelocityController, joint: elbow, required_drive_mode: 3}
all: {type: position_controllers/JointGroupPositionController, joints: [shoulder, elbow],
      required_drive_modes: {shoulder: 1, elbow: 8}}
"""
        converted = self.with_defaults("  dcf_overlay: {\"6098\": \"35\"}\n", more=more)
        self.assertEqual(converted.robot["joint_state_rate"], 100)
        self.assertEqual(converted.axis()["modes"], ["homing", "profile_position"])
        self.assertEqual(converted.axis("elbow")["modes"], ["homing", "profile_velocity"])
        self.assertEqual(converted.axis("elbow")["mode"], "cyclic_position")
        self.told(converted, CONVERTED, "one/type", "~elbow/command")
        self.told(converted, APPROXIMATED, "all/type", "~shoulder/command, ~elbow/command")

    def test_controllers_of_other_kinds_and_joints_are_named(self):
        more = """
ns:
  base: {type: my_robot/WheelController, wheels: [{drive: shoulder}], required_drive_mode: 3,
         radius: 0.1}
  arm: {type: position_controllers/JointTrajectoryController, joints: [hand], required_drive_mode: 8}
  odd: {type: position_controllers/JointPositionController, joint: elbow, required_drive_mode: 5}
"""
        converted = self.with_defaults("", more=more)
        self.assertEqual(converted.axis()["mode"], "profile_velocity")
        self.told(converted, NONE, "ns/base", "there is no WheelController here", "radius=0.1",
                  "~shoulder/command")
        self.told(converted, NONE, "ns/arm", "takes hand, which is none of `nodes`")
        self.told(converted, NONE, "ns/odd/required_drive_mode", "`5`", "is no mode of CiA 402")

    def test_the_group_has_another_name_than_an_axis(self):
        converted = self.with_defaults("", more=(self.TRAJECTORY % 8).replace("arm_controller",
                                                                              "elbow"))
        self.assertEqual(list(converted.robot["groups"]), ["elbow_group"])

    def test_refusals(self):
        def refused(old, new, *parts):
            self.refused(BUS + DEFAULTS + NODES + (self.TRAJECTORY % 8).replace(old, new), *parts)
        refused("goal_time: 0.6", "goal_time: soon", "constraints/goal_time", "must be a number")
        refused("goal: 0.02", "goal: -1", "shoulder/goal", "below 0")
        refused("stop_trajectory_duration: 0.5", "stop_trajectory_duration: -1", "must not be below 0")
        refused("joints: [shoulder, elbow]", "joints: {a: 1}", "arm_controller/joints",
                "must be a text")
        refused("mode: 8", "mode: csp", "required_drive_mode", "must be a number")
        self.refused(BUS + DEFAULTS + NODES + "s: {type: a/JointStateController, publish_rate: 0}\n",
                     "publish_rate",
                     "greater than 0")


class Limits(Case):
    def test_joint_limits(self):
        more = """
joint_limits:
  shoulder: {has_position_limits: true, min_position: -1.5, max_position: deg(90),
             has_velocity_limits: true, max_velocity: 2.0, has_acceleration_limits: false,
             max_acceleration: 9.0, has_jerk_limits: true, max_jerk: 80,
             has_effort_limits: true, max_effort: 0.0}
"""
        converted = self.with_defaults("", more=more)
        limits = converted.axis()["limits"]
        self.assertAlmostEqual(limits.pop("upper"), math.pi / 2, 10)
        self.assertEqual(limits, {"lower": -1.5, "velocity": 2, "jerk": 80})
        self.told(converted, CONVERTED, "max_acceleration",
                  "counts for nothing without has_acceleration_limits")
        self.told(converted, NONE, "max_effort", "no limit that a joint could move within")

    def test_a_urdf_gives_types_and_limits(self):
        self.write("robot.urdf", """<robot name="r"><joint name="shoulder" type="revolute">
  <limit lower="-1" upper="2" velocity="3" effort="4"/></joint>
  <joint name="elbow" type="continuous"><limit velocity="5" effort="0"/></joint></robot>""")
        converted = self.convert(BUS + DEFAULTS + NODES, "--urdf", "robot.urdf")
        self.assertEqual(converted.axis()["limits"],
                         {"lower": -1, "upper": 2, "velocity": 3, "effort": 4})
        self.assertEqual((converted.axis("elbow")["type"], converted.axis("elbow")["limits"]),
                         ("continuous", {"velocity": 5}))
        self.told(converted, APPROXIMATED, "joint elbow: effort", "0 is no limit")
        converted = self.convert(BUS + DEFAULTS + "nodes: {hip: {id: 1}}\n", "--urdf", "robot.urdf")
        self.told(converted, NONE, "robot.urdf: hip", "no such joint")

    def test_the_narrowest_limit_counts(self):
        converted = self.with_defaults("  dcf_overlay: {\"607Dsub1\": \"-180000\", "
                                       "\"607Dsub2\": \"45000\"}\n",
                                       more="joint_limits: {shoulder: {has_position_limits: true, "
                                       "min_position: "
                                       "-1.0, max_position: 2.0}}\n")
        limits = converted.axis()["limits"]
        self.assertEqual(limits["lower"], -1)
        self.assertAlmostEqual(limits["upper"], math.pi / 4, 10)  # 45 degrees
        self.told(converted, APPROXIMATED, "607Dsub1", "a narrower limits/lower counts")

    def test_the_speed_of_the_motor_is_left_alone_where_the_gear_is_not_known(self):
        self.write("servo.eds", eds({**SERVO, (0x6080, 0): (7, "rw")}))
        more = "joint_limits: {shoulder: {has_velocity_limits: true, max_velocity: 1}}\n"
        self.assertEqual(self.with_defaults("", more=more).axis()["lacks"], ["max_motor_speed"])
        self.assertNotIn("lacks", self.with_defaults("", "--gear", "shoulder=10", more=more).axis())

    def test_refusals(self):
        self.write("driver.yaml", BUS + DEFAULTS + NODES)
        for text, part in (("<robot", "is no XML"), ("<robot/>", "has no joint"),
                           ("<robot><joint name='shoulder' type='revolute'><limit velocity='${v}'/>"
                            "</joint></robot>",
                            "`${v}` is no number")):
            self.write("robot.urdf", text)
            converted = self.run_script("--urdf", "robot.urdf", "driver.yaml")
            self.assertEqual(converted.status, 2)
            self.assertIn(part, converted.report)
        self.assertIn("cannot be read", self.run_script("--urdf", "no.urdf", "driver.yaml").report)
        self.refused(BUS + DEFAULTS + NODES + "joint_limits: {shoulder: {has_position_limits: true, "
                     "min_position: 1, "
                     "max_position: 0}}\n", "shoulder: its lower limit 1",
                     "is not below its upper one 0")
        self.refused(BUS + DEFAULTS + NODES + "joint_limits: {shoulder: {has_velocity_limits: true, "
                     "max_velocity: x}}\n",
                     "joint_limits/shoulder/max_velocity", "`x` must be a number")


if __name__ == "__main__":
    unittest.main()
