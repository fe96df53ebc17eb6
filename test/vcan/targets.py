# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What the driver sends the motors of the demo robot, SYNC by SYNC, and whether it keeps to the limits
of the robot's file."""
import struct

from demo_robot import JOINTS, NODES, PERIOD, POSITION_GAIN, RAD, robot_file

LIMITS = {joint: axis["limits"] for joint, axis in robot_file()["axes"].items()}
# Behind the controlword in RPDO 1 is the target: 60C1h:01 of the shoulder, 60FFh of the tool, counts/s,
# else 607Ah.
BY_VELOCITY = "tool"
SMALLEST = {joint: abs(rad) for joint, rad in RAD.items()}  # rad, and rad/s, that a target can tell
SMALLEST["gripper"] = 2.0 ** -23  # of a float of 32 bits, below 2 rad
# The velocity of the tool is that of its path, and the gain times what the motor is off the path. A
# motor is 3 cycles behind what is computed (docs/stops.md): while that changes by dv in a cycle the
# motor is slower, or faster, by 3 dv, and comes off its path by 3 dv times the period.
LOOSER = 1.0 + POSITION_GAIN * 3.0 * PERIOD


class Targets:
    """Of each joint what was sent in each cycle."""

    def __init__(self, frames):
        """@param frames of the wire."""
        self.times = [at for at, identifier, _ in frames if identifier == 0x201]
        self._sent = {joint: [(at, struct.unpack_from("<f" if joint == "gripper" else "<i", data, 2)[0]
                               * RAD.get(joint, 1.0))
                              for at, identifier, data in frames
                              if identifier == 0x200 + NODES[joint]] for joint in JOINTS}

    def on_time(self):
        """No cycle was left out. Where one is, motion begins anew from standstill."""
        return max(b - a for a, b in zip(self.times, self.times[1:])) < 1.6 * PERIOD

    def sent(self, joint, since=0.0):
        """rad, of the tool rad/s."""
        return [value for at, value in self._sent[joint] if at >= since]

    def speeds(self, joint, since=0.0):
        """(time, rad/s) to which the targets lead the joint."""
        sent = self._sent[joint]
        if joint == BY_VELOCITY:
            return [(at, value) for at, value in sent if at >= since]
        return [(at, (value - before) / PERIOD) for (_, before), (at, value) in zip(sent, sent[1:])
                if at >= since]

    def rounding(self, joint):
        """rad/s by which rounded targets may be off."""
        return SMALLEST[joint] / (1.0 if joint == BY_VELOCITY else PERIOD)

    def worst(self, joint):
        """The largest speed, and change of speed in a cycle, as shares of the joint's limits."""
        speeds = [speed for _, speed in self.speeds(joint)]
        fastest = max(abs(speed) for speed in speeds) - self.rounding(joint)
        change = max(abs(b - a) for a, b in zip(speeds, speeds[1:])) - 2.0 * self.rounding(joint)
        permitted = LIMITS[joint]["acceleration"] * PERIOD
        if joint == BY_VELOCITY:
            permitted *= LOOSER
        return fastest / LIMITS[joint]["velocity"], change / permitted

    def assert_within_limits(self, test):
        """No step is longer, and none differs more from the one before, than the limits allow."""
        for joint in JOINTS:
            speed, change = self.worst(joint)
            print(f"{joint}: {speed:.3f} of its velocity, {change:.3f} of its acceleration")
            test.assertLessEqual(speed, 1.0 + 1e-6, f"{joint}: steps")
            test.assertLessEqual(change, 1.0 + 1e-6, f"{joint}: changes of steps")

    def assert_rest(self, test, since, joints=None):
        """Nothing leads the joints anywhere."""
        for joint in joints or JOINTS:
            sent = self.sent(joint, since)
            test.assertGreater(len(sent), 10, joint)
            if joint == BY_VELOCITY:  # which still takes what its motor is off, counts
                most = max(abs(velocity) for velocity in sent)
                print(f"{joint}: {most:.6f} rad/s at rest")
                test.assertLess(most, 0.01, joint)
            else:
                test.assertEqual(len(set(sent)), 1, f"{joint}: {sent}")
