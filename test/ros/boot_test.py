#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""A robot as launch/bus.launch starts it: boot, and what is published at rest."""
import math
import time

import rospy
from cia402_driver.msg import AxisStates
from robot_client import ERROR, OK, Robot, RobotTest, main, wait_until
from std_msgs.msg import Float64
from tf2_msgs.msg import TFMessage


# Where the joints stand at first: `simulation:` of config/robots/arm.yaml, in the order of AXES.
PLACES = [0.25, 0.0, -1.9, 0.0]

# What a steady speed takes at the joint, N m: Coulomb friction of the simulated motor in rated
# torques (config/simulated_drives), rated torque and gear (config/robots/arm.yaml).
FRICTION = {"elbow": 0.05 * 0.64 * 80.0, "gripper": 0.02 * 3.0, "shoulder": 0.05 * 0.64 * 100.0,
            "wrist": 0.05 * 0.32 * 50.0}


class Boot(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.robot = Robot("bus")
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        cls.robot.close()

    def record(self, seconds):
        """joint_states of so many seconds, with their times of arrival."""
        self.robot.joint_states, self.robot.record = [], True
        end = time.monotonic() + seconds
        wait_until(lambda: time.monotonic() >= end, "time passes")
        self.robot.record = False
        return self.robot.joint_states

    def test_all_drives_are_identified_configured_and_left_disabled(self):
        for name in self.AXES:
            axis, node = self.robot.axis(name), self.robot.node(name)
            self.assertEqual(axis.state, "switch on disabled")
            self.assertEqual(node.nmt_state, "operational")
            self.assertNotEqual(node.vendor_id, 0)
            self.assertFalse(axis.homed)

    def test_joint_states_keep_their_order_and_are_known(self):
        self.robot.joint_states, self.robot.record = [], True
        wait_until(lambda: len(self.robot.joint_states) >= 20, "twenty joint_states")
        self.robot.record = False
        for _, message in self.robot.joint_states:
            self.assertEqual(message.name, self.AXES)
            for values, expected in ((message.position, PLACES), (message.velocity, [0.0] * 4),
                                     (message.effort, [0.0] * 4)):
                self.assertEqual(len(values), 4)
                for value, right in zip(values, expected):
                    self.assertAlmostEqual(value, right, delta=1e-3)

    def test_values_that_are_known_tell_their_age_and_no_others(self):
        def ages(axis):
            return {"mode": (bool(axis.mode), axis.mode_age),
                    "velocity": (not math.isnan(axis.velocity), axis.velocity_age),
                    "effort": (not math.isnan(axis.effort), axis.effort_age),
                    "following error": (not math.isnan(axis.following_error),
                                        axis.following_error_age),
                    "inputs": (axis.digital_inputs_valid, axis.digital_inputs_age)}
        for name in self.AXES:
            for what, (known, age) in ages(self.robot.axis(name)).items():
                self.assertEqual(known, not math.isnan(age), f"{name} {what}")
                self.assertTrue(not known or 0.0 <= age < 2.6, f"{name} {what}: {age} s")
            status = wait_until(lambda: self.robot.diagnostic(name), f"status of {name}")
            told = {value.key: value.value for value in status.values}
            self.assertRegex(told["velocity age"], r"^[0-9.e-]+ s$", told)

    def test_joint_states_say_what_the_drives_count(self):
        """Counts per turn, gear and direction as config/robots/arm.yaml has them."""
        for name, counts in (("shoulder", 131072 * 100), ("elbow", -131072 * 80),
                             ("wrist", 65536 * 50)):
            raw = self.robot.call(f"{name}/read_object", object="6064:00").number
            self.assertAlmostEqual(self.robot.position(name), raw / counts * 2.0 * math.pi,
                                   delta=1e-5)

    def test_joint_states_come_at_the_configured_rate(self):
        """Never faster for long, and as fast whenever the machine has half a second to spare."""
        def rates():
            times = [arrival for arrival, _ in self.robot.joint_states]
            return [25.0 / (last - first) for first, last in zip(times, times[25:])]
        self.record(2.0)
        whole = self.robot.joint_states
        self.assertLess((len(whole) - 1) / (whole[-1][0] - whole[0][0]), 57.0)
        self.robot.record = True
        wait_until(lambda: any(43.0 < rate < 57.0 for rate in rates()), rates)
        self.robot.record = False

    def test_stamps_rise_and_lie_shortly_before_publication(self):
        messages = self.record(3.0)
        stamps = [message.header.stamp.to_sec() for _, message in messages]
        ages = sorted(arrival - message.header.stamp.to_sec() for arrival, message in messages)
        self.assertEqual(stamps, sorted(stamps))
        self.assertGreater(len(set(stamps)), 0.5 * len(stamps))
        self.assertGreater(ages[0], 0.0)
        self.assertLess(ages[len(ages) // 10], 0.05)  # others may have waited for a processor

    def test_axis_states_are_latched(self):
        message = rospy.wait_for_message("/bus/axis_states", AxisStates, 10.0)
        self.assertEqual(message._connection_header["latching"], "1")
        self.assertEqual([axis.name for axis in message.axes], self.AXES)

    def test_bus_state_tells_of_a_bus_that_works(self):
        before = self.robot.bus_state
        self.assertEqual(before.interface, "sim")
        self.assertEqual(before.state, "error active")
        self.assertAlmostEqual(before.sync_period, 0.004)
        wait_until(lambda: self.robot.bus_state.cycles > before.cycles + 50
                   and self.robot.bus_state.frames_received > before.frames_received + 50
                   and 0.05 < self.robot.bus_state.load < 1.0, "the bus is busy")
        self.assertEqual(self.robot.bus_state.error_frames, 0)

    def test_diagnostics_have_a_status_for_bus_node_and_axis(self):
        self.robot.wait_diagnostic("bus", OK, "simulated bus with 4 drives")
        for name in self.AXES:
            self.robot.wait_diagnostic(name, OK, "switch on disabled")
        self.robot.wait_diagnostic("node 2", OK, "operational")

    def test_hardware_id_is_the_serial_number(self):
        for name in self.AXES:
            node = self.robot.node(name)
            expected = str(node.serial_number) if node.serial_number else f"node {node.node_id}"
            for status in (name, f"node {node.node_id}"):
                found = wait_until(lambda: self.robot.diagnostic(status), f"status of {status}")
                self.assertTrue(found.hardware_id.endswith(expected), found.hardware_id)
        self.assertEqual(self.robot.diagnostic("bus").hardware_id, "sim")

    def test_tf_holds_the_frames_of_all_joints(self):
        transforms = {}

        def take(message):
            for transform in message.transforms:
                transforms[transform.child_frame_id] = transform
        subscriber = rospy.Subscriber("/tf", TFMessage, take)
        wait_until(lambda: len(transforms) == 4, "four transforms")
        subscriber.unregister()
        parents = {child: transform.header.frame_id for child, transform in transforms.items()}
        self.assertEqual(parents, {"upper_arm": "base", "forearm": "upper_arm", "hand": "forearm",
                                   "finger": "hand"})
        forearm = transforms["forearm"].transform
        self.assertAlmostEqual(forearm.translation.x, 0.4)
        half = 0.5 * self.robot.position("elbow")
        self.assertAlmostEqual(forearm.rotation.z, math.sin(half), delta=1e-3)
        self.assertAlmostEqual(forearm.rotation.w, math.cos(half), delta=1e-3)

    def test_z_motion_is_refused_before_homing_and_enabling(self):
        self.robot.follow(self.AXES, [(1.0, [0.1] * 4)])
        before = {name: self.robot.position(name) for name in self.AXES}
        self.record(0.5)
        for name in self.AXES:
            self.assertAlmostEqual(self.robot.position(name), before[name], delta=1e-3)
        self.assertNotEqual(self.robot.diagnostic("shoulder").level, ERROR)

    def test_zz_velocity_and_effort_are_those_of_the_motor_in_either_direction(self):
        speeds = {"elbow": -0.4, "gripper": -0.6, "shoulder": 0.4, "wrist": 0.5}
        for name in self.AXES:
            self.assertTrue(self.robot.call(f"{name}/set_mode", mode="csv").success)
            self.assertTrue(self.robot.call(f"{name}/enable").success)
        for sign in (1.0, -1.0):
            steady = self.steady({name: sign * speed for name, speed in speeds.items()})
            for i, name in enumerate(self.AXES):
                for what, values, right in (
                        ("velocity", steady.velocity, sign * speeds[name]),
                        ("effort", steady.effort, math.copysign(FRICTION[name],
                                                                sign * speeds[name]))):
                    with self.subTest(axis=name, what=what, sign=sign):
                        self.assertAlmostEqual(values[i], right, delta=0.05 * abs(right))

    def steady(self, speeds):
        """Streams velocities until the positions of half a second have changed by just these.
        @return the newest of these joint_states."""
        publishers = {name: self.robot.publisher(f"{name}/command", Float64) for name in speeds}
        self.robot.joint_states, self.robot.record = [], True

        def look():
            for name, speed in speeds.items():
                publishers[name].publish(speed)
            time.sleep(0.02)
            last = [message for _, message in self.robot.joint_states[-26:]]
            seconds = (last[-1].header.stamp - last[0].header.stamp).to_sec() if last else 0.0
            return last[-1] if seconds > 0.4 and all(
                abs((last[-1].position[i] - last[0].position[i]) / seconds - speeds[name])
                < 0.02 * abs(speeds[name]) for i, name in enumerate(self.AXES)) else None
        message = wait_until(look, lambda: f"{speeds}, but {self.robot.joint_state}")
        self.robot.record = False
        return message


if __name__ == "__main__":
    main("boot")
