#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Tells the story of the demo robot: boot, home, enable, follow a trajectory.

Usage: demo.py OUTPUT_DIR

Needs launch/demo.launch running (or about to). Says in plain words what happens, draws
OUTPUT_DIR/tracking.png, and ends with status 0 only if every axis followed.
"""
import os
import re
import sys
import threading
import time

import rosgraph
import rospy
from control_msgs.msg import JointTrajectoryControllerState
from rosgraph_msgs.msg import Log
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from cia402_driver.msg import AxisStates, BusState

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from demo_plot import draw  # noqa: E402

ROBOT = "/bus"
GROUP = "arm"
# Deadlines in s; generous, for slow machines. Nothing waits longer than it must.
START_DEADLINE = 120.0
STILL_TIME = 0.5  # commanded positions that rest for so long have arrived

JOINTS = ["shoulder", "elbow", "wrist", "tool", "gripper"]
# Time in s, positions in rad. The robot comes from where homing left it.
POINTS = [
    (1.8, [-1.6, -0.40, 0.8, 0.4, 0.7]),
    (3.4, [-0.7, -1.10, -0.1, -0.5, -0.5]),
    (5.0, [0.2, 0.20, -0.8, 0.5, 0.8]),
    (6.6, [0.6, 1.00, 0.3, -0.4, -0.7]),
    (8.2, [0.0, 0.50, 0.0, 0.0, 0.0]),
]


class Failure(Exception):
    """The demo cannot go on; its text is a sentence for the person who watches."""


def say(text):
    print(text, flush=True)


class Recorder:
    """Keeps what ~arm/state says: time, commanded and measured positions of each joint."""

    def __init__(self):
        self._lock = threading.Lock()
        self._samples = []
        self._still_since = None
        rospy.Subscriber(f"{ROBOT}/{GROUP}/state", JointTrajectoryControllerState, self._take,
                         queue_size=100)

    def _take(self, message):
        sample = (message.header.stamp.to_sec(), list(message.desired.positions),
                  list(message.actual.positions))
        with self._lock:
            if self._samples and self._samples[-1][0] == sample[0]:
                return  # the same feedback a second time
            moved = not self._samples or self._samples[-1][1] != sample[1]
            self._samples.append(sample)
            if moved or self._still_since is None:
                self._still_since = sample[0]

    def samples(self):
        with self._lock:
            return list(self._samples)

    def forget(self):
        with self._lock:
            self._samples, self._still_since = [], None

    def arrived(self, goal):
        """Do the commanded positions rest at the goal?"""
        with self._lock:
            if not self._samples or self._samples[-1][0] - self._still_since < STILL_TIME:
                return False
            return all(abs(a - b) < 1e-3 for a, b in zip(self._samples[-1][1], goal))


def wait_until(condition, deadline, complaint):
    """Waits for a condition; on time-out fails with `complaint` (a text, or what makes one)."""
    end = time.monotonic() + deadline
    while not condition():
        if time.monotonic() > end:
            raise Failure(complaint if isinstance(complaint, str) else complaint())
        if rospy.core.is_initialized() and rospy.is_shutdown():
            raise Failure("interrupted")
        time.sleep(0.05)


def in_order(axes):
    """Axes in the order of JOINTS; ROS tells them by name."""
    return sorted(axes, key=lambda axis: JOINTS.index(axis.name))


def drive_of(configured, joint):
    """The drive family of a joint, and how it is led along trajectories."""
    axis = configured[joint]
    return f"{axis['drive']} by {axis.get('mode', 'cyclic_position')}"


class Errors:
    """What the node calls an error in its log."""

    def __init__(self):
        self._texts = []
        rospy.Subscriber("/rosout", Log, self._take)

    def _take(self, message):
        if message.name == ROBOT and message.level >= Log.ERROR:
            self._texts.append(message.msg)

    def forget(self):
        self._texts = []

    def check(self):
        """Fails with the first one since forget()."""
        if self._texts:
            raise Failure(f"{ROBOT} says: {self._texts[0]}")


class Latest:
    """The newest message of a topic."""

    def __init__(self, topic, kind):
        self.message = None
        rospy.Subscriber(topic, kind, self._take)

    def _take(self, message):
        self.message = message


def wait_for_drives():
    bus, axes = Latest(f"{ROBOT}/bus_state", BusState), Latest(f"{ROBOT}/axis_states", AxisStates)

    def ready():
        return bus.message and axes.message and all(node.ready for node in bus.message.nodes)

    def complaint():
        if bus.message is None:
            return f"The node {ROBOT} says nothing."
        waiting = [f"{', '.join(node.axes)} (node {node.node_id}): {node.step}"
                   for node in bus.message.nodes if not node.ready]
        return "Not all drives are there: " + "; ".join(waiting)

    wait_until(ready, START_DEADLINE, complaint)
    say("All drives are identified and configured, and left without power:")
    configured = rospy.get_param(f"{ROBOT}/axes")
    nodes = {name: node.node_id for node in bus.message.nodes for name in node.axes}
    for axis in in_order(axes.message.axes):
        say(f"  {axis.name:9} node {nodes[axis.name]}, {drive_of(configured, axis.name)}, "
            f"{axis.state}")


def ask(name):
    """Calls a Trigger service of the robot and says what it answers."""
    service = f"{ROBOT}/{name}"
    try:
        rospy.wait_for_service(service, START_DEADLINE)
    except rospy.ROSException as error:
        raise Failure(f"There is no service {service}.") from error
    began = time.monotonic()
    answer = rospy.ServiceProxy(service, Trigger)()
    took = time.monotonic() - began
    if not answer.success:
        raise Failure(f"{service} failed: {answer.message}")
    whole, *axes = re.split("; (?=[a-z]+: )", answer.message)  # a line for each axis
    say(f"  {whole}, in {took:.1f} s")
    for axis in axes:
        say(f"    {axis}")


def trajectory(start):
    """The points with the velocities of a smooth way through them, so that splines are cubic."""
    times = [0.0] + [point[0] for point in POINTS]
    places = [start] + [point[1] for point in POINTS]
    message = JointTrajectory(joint_names=JOINTS)
    for i in range(1, len(times)):
        if i + 1 < len(times):
            span = times[i + 1] - times[i - 1]
            velocities = [(b - a) / span for a, b in zip(places[i - 1], places[i + 1])]
        else:
            velocities = [0.0] * len(JOINTS)
        message.points.append(JointTrajectoryPoint(
            positions=places[i], velocities=velocities,
            time_from_start=rospy.Duration.from_sec(times[i])))
    return message


def follow(recorder, errors):
    """Sends the trajectory and waits for its end. @return the samples."""
    publisher = rospy.Publisher(f"{ROBOT}/{GROUP}/command", JointTrajectory, queue_size=1)
    wait_until(lambda: publisher.get_num_connections() > 0 and recorder.samples(),
               START_DEADLINE, f"The node does not listen to {ROBOT}/{GROUP}/command.")
    goal = POINTS[-1][1]
    recorder.forget()
    wait_until(recorder.samples, START_DEADLINE, "The group publishes no state.")
    errors.forget()
    publisher.publish(trajectory(recorder.samples()[-1][2]))

    def arrived():
        errors.check()
        return recorder.arrived(goal)
    wait_until(arrived, POINTS[-1][0] + 60.0,
               "The trajectory did not come to its end; the log of the node says why.")
    return recorder.samples()


def judge(samples):
    """Says how each axis followed. @return largest errors, and sentences about those that did not.
    """
    constraints = rospy.get_param(f"{ROBOT}/groups/{GROUP}/constraints")
    worst, complaints = [], []
    for i, joint in enumerate(JOINTS):
        path = max(abs(desired[i] - actual[i]) for _, desired, actual in samples)
        goal = abs(samples[-1][2][i] - POINTS[-1][1][i])
        low = min(actual[i] for _, _, actual in samples)
        high = max(actual[i] for _, _, actual in samples)
        allowed = constraints[joint]
        worst.append(path)
        say(f"  {joint:9} moved between {low:+.3f} and {high:+.3f} rad, off its path by at most "
            f"{1e3 * path:.1f} mrad ({1e3 * allowed['trajectory']:.0f} allowed), off its goal by "
            f"{1e3 * goal:.1f} mrad ({1e3 * allowed['goal']:.0f} allowed)")
        # Written so that a NaN is a complaint.
        if not path <= allowed["trajectory"]:
            complaints.append(f"{joint} left its path by {path:.4f} rad")
        if not goal <= allowed["goal"]:
            complaints.append(f"{joint} ended {goal:.4f} rad off its goal")
        if not high - low > 0.5:
            complaints.append(f"{joint} hardly moved")
    return worst, complaints


def tell(output):
    say("Waiting for the robot to start ...")
    wait_until(rosgraph.is_master_online, START_DEADLINE, "There is no ROS master.")
    rospy.init_node("demo", disable_signals=True)
    recorder, errors = Recorder(), Errors()
    wait_for_drives()
    say("Homing, in the order of the configuration:")
    ask("home")
    say("Enabling:")
    ask("enable")
    say(f"Following a trajectory of {POINTS[-1][0]} s through {len(POINTS)} points:")
    samples = follow(recorder, errors)
    worst, complaints = judge(samples)
    picture = os.path.join(output, "tracking.png")
    configured = rospy.get_param(f"{ROBOT}/axes")
    draw(picture, [(joint, drive_of(configured, joint)) for joint in JOINTS], samples, worst)
    say(f"Drew {picture}")
    say("Disabling:")
    ask("disable")
    if complaints:
        raise Failure("Not every axis followed: " + "; ".join(complaints) + ".")
    say("Every axis followed.")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        os.makedirs(sys.argv[1], exist_ok=True)
        tell(sys.argv[1])
    except (Failure, rospy.ServiceException) as failure:
        say(f"The demo failed: {failure}")
        sys.exit(1)


if __name__ == "__main__":
    main()
