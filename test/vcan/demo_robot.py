# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What the tests with the demo robot on vcan0 share: five drive families in a process of their own,
bus_node in another. Where a motor stands is read from its drive's own TPDO."""
import math
import os
import struct
import sys

from control_msgs.msg import FollowJointTrajectoryAction, FollowJointTrajectoryGoal
from trajectory_msgs.msg import JointTrajectoryPoint

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from goal_client import GoalClient  # noqa: E402
from robot_client import (ERROR, OK, Process, Robot, RobotTest, main, package_file,  # noqa: E402,F401
                          rosparam, rospy, wait_until)
from wire import Wire  # noqa: E402

CONFIG = "config/robots/demo.yaml"
JOINTS = ["shoulder", "elbow", "wrist", "tool", "gripper"]
NODES = {joint: node for node, joint in enumerate(JOINTS, 1)}
TURN = 2.0 * math.pi
# rad of the joint by what its drive counts: counts of a turn, gear and direction of the file.
RAD = {"shoulder": TURN / (100000 * 100), "elbow": -TURN / (8388608 * 80),
       "wrist": TURN / (4000 * 50), "tool": TURN / (10000 * 50)}
PERIOD = 0.02  # s from SYNC to SYNC
POSITION_GAIN = 5.0  # 1/s, of the tool, which is led by velocities
RESULT = rospy.Duration(100.0)


def robot_file():
    return rosparam.load_file(package_file(CONFIG))[0][0]


def slowly():
    """The robot's file with what a machine wants whose timers are late by several ms: periods and
    time-outs that are long, a drive that minds SYNC by two periods, and a slower position loop."""
    write = robot_file()["axes"]["shoulder"]["write"]
    return {"bus/sync_period": PERIOD, "bus/heartbeat": 0.5, "axes/gripper/rpdo_timeout": 1.0,
            "axes/tool/position_loop": {"gain": POSITION_GAIN},
            "axes/shoulder/write": write + [{"object": "sync_tolerance", "raw": 4}],
            "groups/arm/constraints": {"goal_time": 3.0}}


def goal_of(points, joints=None):
    """@param points (s from the start, {joint: rad}, {joint: rad/s})"""
    joints = JOINTS if joints is None else joints
    goal = FollowJointTrajectoryGoal()
    goal.trajectory.joint_names = joints
    goal.trajectory.points = [
        JointTrajectoryPoint(positions=[places[joint] for joint in joints],
                             velocities=[velocities[joint] for joint in joints],
                             time_from_start=rospy.Duration.from_sec(seconds))
        for seconds, places, velocities in points]
    return goal


def point_goal(places, seconds, joints=None):
    """To one point, at rest there."""
    return goal_of([(seconds, places, dict.fromkeys(JOINTS, 0.0))], joints)


class DemoRobotTest(RobotTest):
    AXES = sorted(JOINTS)
    OF_NODE, OF_DRIVES = {}, {}  # what else the robot's file says, for one of the two

    @classmethod
    def setUpClass(cls):
        cls.wire = Wire()
        cls.robot = Robot()
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG, interface="vcan0",
                             **slowly(), **cls.OF_DRIVES)
        cls.process = Process("bus_node", "robot", CONFIG, interface="vcan0", **slowly(),
                              **cls.OF_NODE)

    @classmethod
    def tearDownClass(cls):
        cls.process.stop()
        cls.drives.stop()
        cls.wire.close()

    def inject(self, axis, fault):
        from cia402_driver.srv import InjectFault
        rospy.wait_for_service("/simulated_drives/inject_fault", 40.0)
        answer = rospy.ServiceProxy("/simulated_drives/inject_fault", InjectFault)(axis, fault)
        self.assertTrue(answer.success, answer.message)

    def told(self, joint):
        """Statusword and position, rad from where its drive counts, of the newest TPDO 1."""
        data = [data for _, identifier, data in self.wire.since(0.0)
                if identifier == 0x180 + NODES[joint]][-1]
        if joint in RAD:
            statusword, counts = struct.unpack_from("<Hi", data)
            return statusword, counts * RAD[joint]
        return struct.unpack_from("<Hf", data)

    def powered(self, joint):
        return self.told(joint)[0] & 0x6F == 0x27

    def client(self):
        client = GoalClient("/robot/arm/follow_joint_trajectory", FollowJointTrajectoryAction)
        self.assertTrue(client.wait_for_server(RESULT), "the action is offered")
        return client
