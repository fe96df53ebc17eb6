# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What the tests of the ROS nodes share: starting them, talking to them, waiting for conditions."""
import math
import os
import re
import signal
import subprocess
import threading
import time
import unittest

import rosparam
import rospkg
import rospy
from cia402_driver.msg import AxisStates, BusState, Emergency
from cia402_driver.srv import (ArmTouchProbe, ErrorHistory, FactoryReset, InjectFault, LoadDcf,
                               LssAssign, LssScan, LssSetBitTiming, Nmt, ReadObject, SaveDcf,
                               SetBusParameters, SetDigitalOutputs, SetMode, SetPosition,
                               WriteObject)
from control_msgs.msg import JointTrajectoryControllerState
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

PACKAGE = "cia402_driver"
DEADLINE = 100.0  # s; for what takes well below a second on a quiet machine
REST = 15  # feedbacks without motion: 0.3 s at 50 Hz, however slow the machine is
ERROR, WARN, OK = DiagnosticStatus.ERROR, DiagnosticStatus.WARN, DiagnosticStatus.OK

SERVICES = {
    "error_history": ErrorHistory, "inject_fault": InjectFault, "nmt": Nmt,
    "read_object": ReadObject, "write_object": WriteObject, "set_mode": SetMode,
    "set_position": SetPosition, "lss_scan": LssScan, "lss_assign": LssAssign,
    "lss_set_bit_timing": LssSetBitTiming, "save_dcf": SaveDcf,
    "set_digital_outputs": SetDigitalOutputs, "arm_touch_probe": ArmTouchProbe,
    "set_bus_parameters": SetBusParameters, "load_dcf": LoadDcf, "factory_reset": FactoryReset,
}


def package_file(path):
    return os.path.join(rospkg.RosPack().get_path(PACKAGE), path)


def executable(name, package=PACKAGE):
    """Path of a node, as rosrun finds it; of another build of this package in CIA402_NODES."""
    import roslib.packages
    other = os.path.join(os.environ.get("CIA402_NODES", ""), name)
    if package == PACKAGE and other != name:
        return other
    return roslib.packages.find_node(package, name)[0]


def wait_until(condition, what, deadline=DEADLINE):
    """Waits for a condition. @return its true value. @param what text, or function that makes one:
    what was waited for in vain."""
    end = time.monotonic() + deadline
    while True:
        value = condition()
        if value:
            return value
        if time.monotonic() > end:
            raise AssertionError(f"in {deadline} s not: {what() if callable(what) else what}")
        time.sleep(0.01)


def thread_states(pid):
    """What the threads of a process do: state and processor ticks, twice, and what they wait for.
    Those that starve count on, those that wait for each other do not."""
    def look():
        found = {}
        for task in os.listdir(f"/proc/{pid}/task"):
            with open(f"/proc/{pid}/task/{task}/stat", encoding="ascii", errors="replace") as file:
                fields = file.read().rpartition(")")[2].split()
            with open(f"/proc/{pid}/task/{task}/wchan", encoding="ascii") as file:
                found[task] = f"{fields[0]} {int(fields[11]) + int(fields[12])} {file.read()}"
        return found
    try:
        first = look()
        time.sleep(1.0)
        second = look()
        return "; ".join(f"{task}: {state} -> {second.get(task, 'ended')}"
                         for task, state in first.items())
    except OSError as error:
        return f"not known: {error}"


class Process:
    """A node as a child of the test, with its output."""

    def __init__(self, node, name, config, remap=(), **parameters):
        """@param config path below the package, loaded into the node's private namespace.
        @param remap as `from:=to`."""
        for tree, _ in rosparam.load_file(package_file(config)):
            rospy.set_param("/" + name, tree)
        for key, value in parameters.items():
            rospy.set_param(f"/{name}/{key}", value)
        self.name = name
        self._lines = []
        self._process = subprocess.Popen(
            ["stdbuf", "-oL", executable(node), f"__name:={name}", *remap], stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True, errors="replace")
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self._process.stdout:
            self._lines.append(line)
            print(f"[{self.name}] {line}", end="", flush=True)

    def output(self):
        return re.sub("\x1b\\[[0-9;]*m", "", "".join(self._lines))

    def running(self):
        return self._process.poll() is None

    def pid(self):
        return self._process.pid

    def send(self, number):
        self._process.send_signal(number)

    def wait(self, deadline=DEADLINE):
        """@return exit status."""
        status = self._process.wait(deadline)
        self._reader.join(5.0)
        return status

    def stop(self):
        """Ends it as Ctrl-C does. @return exit status."""
        if self.running():
            self.send(signal.SIGINT)
        try:
            return self.wait()
        except subprocess.TimeoutExpired:
            threads = thread_states(self._process.pid)
            self.kill()
            raise AssertionError(f"{self.name} has not ended {DEADLINE} s after SIGINT; its threads "
                                 f"then and a second later: {threads}") from None

    def kill(self):
        if self.running():
            self.send(signal.SIGKILL)
        self.wait()


class Robot:
    """Topics and services of a bus_node, wherever it runs."""

    def __init__(self, name="robot", group="arm", joint_states="/joint_states"):
        self._prefix = "/" + name
        self._group = group
        self._publishers = {}
        self._services = {}
        self._diagnostics = {}
        self.axis_states = self.bus_state = self.group_state = self.joint_state = None
        self.emergencies = []
        self.joint_states = []  # (time of arrival, message), while record is set
        self.record = False
        self._subscribers = [
            rospy.Subscriber(f"{self._prefix}/axis_states", AxisStates, self._on_axis_states),
            rospy.Subscriber(f"{self._prefix}/bus_state", BusState, self._on_bus_state),
            rospy.Subscriber(f"{self._prefix}/emergencies", Emergency, self.emergencies.append),
            rospy.Subscriber(f"{self._prefix}/{group}/state", JointTrajectoryControllerState,
                             self._on_group_state),
            rospy.Subscriber(joint_states, JointState, self._on_joint_state, tcp_nodelay=True),
            rospy.Subscriber("/diagnostics", DiagnosticArray, self._on_diagnostics),
        ]

    def close(self):
        for end in self._subscribers + list(self._publishers.values()):
            end.unregister()

    def _on_axis_states(self, message):
        self.axis_states = message

    def _on_bus_state(self, message):
        self.bus_state = message

    def _on_group_state(self, message):
        self.group_state = message

    def _on_joint_state(self, message):
        self.joint_state = message
        if self.record:
            self.joint_states.append((rospy.get_time(), message))

    def _on_diagnostics(self, message):
        for status in message.status:
            # diagnostic_updater prefixes the node's name: "robot: shoulder"
            self._diagnostics[status.name.split(": ", 1)[-1]] = status

    # States

    def axis(self, name):
        states = self.axis_states
        return next(axis for axis in states.axes if axis.name == name) if states else None

    def node(self, name):
        """The NodeState of an axis."""
        state = self.bus_state
        return next(node for node in state.nodes if name in node.axes) if state else None

    def position(self, joint):
        return self.joint_state.position[self.joint_state.name.index(joint)]

    def diagnostic(self, name):
        return self._diagnostics.get(name)

    # Waiting

    def wait_ready(self, deadline=DEADLINE):
        """Until all drives are identified, configured and started."""
        wait_until(lambda: self.bus_state and all(node.ready for node in self.bus_state.nodes)
                   and self.axis_states and self.joint_state
                   and all(axis.state != "unknown" for axis in self.axis_states.axes),
                   lambda: f"all drives ready\n{self.bus_state}", deadline)

    def wait_axis(self, name, condition, what, deadline=DEADLINE):
        """Until condition(AxisState) is true. @return that AxisState."""
        def met():
            axis = self.axis(name)
            return axis if axis and condition(axis) else None
        return wait_until(met, lambda: f"{name}: {what}\n{self.axis(name)}", deadline)

    def wait_state(self, name, state, deadline=DEADLINE):
        return self.wait_axis(name, lambda axis: axis.state == state, state, deadline)

    def wait_diagnostic(self, name, level, words="", deadline=DEADLINE):
        """Until the status of that name has the level and all the words. @return it."""
        def met():
            status = self.diagnostic(name)
            hit = status and status.level == level and all(
                word in status.message for word in words.split("|"))
            return status if hit else None
        return wait_until(met, lambda: f"diagnostics of {name}: {level} {words}\n"
                          f"{self.diagnostic(name)}", deadline)

    def wait_at(self, joint, goal, tolerance=0.01, deadline=DEADLINE):
        wait_until(lambda: abs(self.position(joint) - goal) <= tolerance,
                   lambda: f"{joint} at {goal}, but at {self.position(joint)}\n{self.axis(joint)}",
                   deadline)

    def wait_rest(self, joint, deadline=DEADLINE):
        """Until REST feedbacks in a row showed the same position. @return it."""
        end = time.monotonic() + deadline
        place, stamps = None, set()

        def same(a, b):
            return abs(a - b) <= 1e-3 or (math.isnan(a) and math.isnan(b))
        while len(stamps) < REST:
            if time.monotonic() > end:
                raise AssertionError(f"{joint} does not come to rest")
            message = self.joint_state
            position = message.position[message.name.index(joint)]
            if place is None or not same(position, place):
                place, stamps = position, set()
            stamps.add(message.header.stamp)
            time.sleep(0.01)
        return place

    # Commands

    def call(self, name, **request):
        """Calls a service (`home`, `shoulder/read_object`). @return its answer."""
        path = f"{self._prefix}/{name}"
        rospy.wait_for_service(path, DEADLINE)
        kind = SERVICES.get(name.rsplit("/", 1)[-1], Trigger)
        answer = rospy.ServiceProxy(path, kind)(**request)
        print(f"{name} {request or ''}: {answer.success}, {answer.message}", flush=True)
        return answer

    def recovered(self):
        """Calls recover. @return whether the axes miss nothing but their zero then."""
        answer = self.call("recover")
        return answer.success or all(" is not homed: home" in part
                                     for part in answer.message.split("; ")[1:])

    def publisher(self, topic, kind):
        """A publisher that the node listens to."""
        path = f"{self._prefix}/{topic}"
        if path not in self._publishers:
            self._publishers[path] = rospy.Publisher(path, kind, queue_size=10)
        wait_until(lambda: self._publishers[path].get_num_connections() > 0,
                   f"the node listens to {path}")
        return self._publishers[path]

    def command(self, axis, value):
        """Sends a set-point of the active mode, once."""
        self.publisher(f"{axis}/command", Float64).publish(value)

    def stream(self, axis, value, condition, what, deadline=DEADLINE):
        """Sends a set-point at 50 Hz until a condition is met."""
        publisher = self.publisher(f"{axis}/command", Float64)

        def step():
            publisher.publish(value)
            time.sleep(0.02)
            return condition()
        wait_until(step, what, deadline)

    def turn(self, velocities):
        """Brings axes to turn in cyclic_velocity, which a drive goes on with where nobody ends it,
        towards their middle. @param velocities {axis: rad/s}. Returns while they turn."""
        for axis in velocities:
            assert self.call(f"{axis}/set_mode", mode="csv").success
            assert self.call(f"{axis}/enable").success
        before = {axis: self.position(axis) for axis in velocities}
        publishers = {axis: self.publisher(f"{axis}/command", Float64) for axis in velocities}

        def step():
            for axis, publisher in publishers.items():
                publisher.publish(velocities[axis] * (1.0 if before[axis] < 0.0 else -1.0))
            time.sleep(0.02)
            return all(abs(self.position(axis) - before[axis]) > 0.1 for axis in velocities)
        wait_until(step, f"they turn: {velocities}")

    def follow(self, joints, points):
        """Sends a trajectory. @param points (time, positions): at rest at the last one."""
        message = JointTrajectory(joint_names=list(joints))
        for when, positions in points:
            message.points.append(JointTrajectoryPoint(
                positions=positions, velocities=[0.0] * len(positions),
                time_from_start=rospy.Duration.from_sec(when)))
        self.publisher(f"{self._group}/command", JointTrajectory).publish(message)


class RobotTest(unittest.TestCase):
    """Tests with a bus_node on simulated drives of its own, started once for all of them."""

    CONFIG = "config/robots/arm.yaml"
    AXES = ["elbow", "gripper", "shoulder", "wrist"]  # the parameter server sorts by name

    @classmethod
    def setUpClass(cls):
        cls.process = Process("bus_node", "robot", cls.CONFIG, interface="sim")
        cls.robot = Robot()
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        cls.robot.close()
        cls.process.stop()

    def succeed(self, name, words="", **request):
        """Calls a service that must succeed with all these words in its answer."""
        answer = self.robot.call(name, **request)
        self.assertTrue(answer.success, answer.message)
        self.assert_words(answer.message, words)
        return answer

    def refuse(self, name, words, **request):
        """Calls a service that must fail with all these words in its answer."""
        answer = self.robot.call(name, **request)
        self.assertFalse(answer.success, answer.message)
        self.assert_words(answer.message, words)
        return answer

    def assert_words(self, text, words):
        """@param words separated by |."""
        for word in words.split("|"):
            self.assertIn(word, text)

    def wait_log(self, words, since=0):
        """Until a line of the node's log has all the words. @return what it has logged."""
        def met():
            return any(all(word in line for word in words.split("|"))
                       for line in self.process.output()[since:].splitlines())
        wait_until(met, lambda: f"logged: {words}\n{self.process.output()[since:]}")

    def home_and_enable(self):
        """All axes homed and enabled; quick if they are."""
        if not all(axis.homed for axis in self.robot.axis_states.axes):
            self.succeed("home")
        self.succeed("enable")


def main(name):
    """Runs all test cases of the calling program as one rostest node."""
    import rostest
    rospy.init_node(name, disable_signals=True)
    rostest.rosrun(PACKAGE, name, "__main__")
