# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Good and bad arguments for every service and topic of a bus_node."""
import os

import rospy
from actionlib_msgs.msg import GoalID
from cia402_driver.msg import HomeActionGoal, HomeGoal, LssIdentity
from dynamic_reconfigure.msg import BoolParameter, Config, DoubleParameter, StrParameter
from control_msgs.msg import (FollowJointTrajectoryActionGoal, FollowJointTrajectoryGoal,
                              JointTolerance)
from std_msgs.msg import Float64, Float64MultiArray
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

NAN, INF = float("nan"), float("inf")
JOINTS = ["shoulder", "elbow", "wrist", "gripper"]
NUMBERS = [0.0, -0.0, 0.1, -0.3, 1.0, 1e9, -1e300, NAN, INF, -INF]
NAMES = JOINTS + ["", "nobody", "bus", "ä", "x" * 1000]
OBJECTS = ["position_actual", "6041:00", "0x6064", "following_error_window", "1008:00", "1018:01",
           "5FFF:00", "6041:", ":", "", "FFFFFFFF:FF", "ä", "x" * 1000]
# Nothing here keeps a drive from working.
WRITABLE = ["606D:00", "0x606E", "statusword", "5FFF:00", "606D:", "", "ä", "x" * 1000]
VALUES = ["0", "1", "123456", "-1", "0xFFFFFFFF", "1e400", "nan", "inf", "fast", "", "x" * 1000]
MODES = ["csp", "csv", "pp", "pv", "cyclic_position", "sideways", "", "x" * 1000]
OUTPUTS = [{"names": names, "values": values} for names, values in (
    (["do1"], [True]), (["do1", "do2"], [False, True]), (["do1", "do1"], [True, False]),
    (["do1"], []), ([], []), (["ä", "x" * 1000], [True, True]))]
NMT = ["start", "stop", "pre_operational", "reset_node", "reset_communication", "jump", ""]
FAULTS = ["encoder", "overcurrent", "power_cycle", "silent", "sdo_silent", "emergency_storm",
          "short_tpdos", "blocked_rotor", "clear", "clear", "clear", "headache", ""]


def trigger(_chance, _folder):
    return {}


def identity(chance):
    return LssIdentity(vendor_id=1234, product_code=1026, revision=65536,
                       serial=chance.choice([0, 1111, 0xFFFFFFFF]))


SERVICES = {name: trigger for name in (
    "enable", "disable", "home", "clear_faults", "recover", "quick_stop", "halt",
    "save_parameters", "restore_parameters", "dump_recording", "error_history", "reload")}


def configuration(chance, _folder):
    keys = ["joint_state_rate", "axes/elbow/command_timeout", "groups/arm/constraints/goal_time",
            "groups/arm/constraints/wrist/goal", "axes/elbow/limits/velocity", "ä", "x" * 1000]
    flags = ["groups/arm/allow_partial_joints_goal", "joint_state_rate", ""]
    return {"config": Config(
        doubles=[DoubleParameter(chance.choice(keys), chance.choice([0.1, 0.5, 20.0] + NUMBERS))
                 for _ in range(chance.choice([0, 1, 1, 1, 3]))],
        bools=[BoolParameter(chance.choice(flags), chance.choice([True, False]))
               for _ in range(chance.choice([0, 0, 1]))],
        strs=[StrParameter(chance.choice(["last_change", "joint_state_rate"]), "x" * 1000)
              for _ in range(chance.choice([0, 0, 0, 1]))])}


SERVICES.update({
    "set_parameters": configuration,
    "set_mode": lambda chance, _: {"mode": chance.choice(MODES)},
    "set_position": lambda chance, _: {"position": chance.choice(NUMBERS)},
    "read_object": lambda chance, _: {"object": chance.choice(OBJECTS)},
    "write_object": lambda chance, _: {"object": chance.choice(WRITABLE),
                                       "value": chance.choice(VALUES)},
    "set_digital_outputs": lambda chance, _: chance.choice(OUTPUTS),
    "arm_touch_probe": lambda chance, _: {"probe": chance.choice([0, 1, 2, 255]),
                                          "edge": chance.choice(["rising", "both", "up", ""]),
                                          "index_pulse": chance.choice([True, False]),
                                          "continuous": chance.choice([True, False]),
                                          "timeout": chance.choice([0.01, 0.2] + NUMBERS)},
    # Never one that a drive would take: it would be gone for good.
    "set_bus_parameters": lambda chance, _: {"node_id": chance.choice([0, 1, 127, 128, 255]),
                                             "bit_rate": chance.choice([0, 500000, 1000000, 7]),
                                             "confirm": chance.choice([True, False])},
    "nmt": lambda chance, _: {"command": chance.choice(NMT)},
    "save_dcf": lambda chance, folder: {"path": chance.choice(
        [os.path.join(folder, "a.dcf"), "/nowhere/a.dcf", "a", ""])},
    "load_dcf": lambda chance, folder: {"path": chance.choice(
        [os.path.join(folder, "a.dcf"), "/nowhere/a.dcf", "a", ""]),
                                        "confirm": chance.choice([True, False])},
    "factory_reset": lambda chance, _: {"confirm": chance.choice([True, False])},
    "inject_fault": lambda chance, _: {"axis": chance.choice(NAMES), "fault": chance.choice(
        FAULTS + ["bus_off"])},
    "query_state": lambda chance, _: {"time": any_time(chance)},
    "lss_scan": lambda chance, _: {"window": chance.choice([0.0, 0.02, -1.0, NAN, 1e9])},
    "lss_assign": lambda chance, _: {"device": identity(chance),
                                     "node_id": chance.choice([0, 1, 99, 127, 255]),
                                     "store": chance.choice([True, False])},
    # Never one that the drives would take: they would be deaf until the bus follows.
    "lss_set_bit_timing": lambda chance, _: {"axis": chance.choice(NAMES),
                                             "kbit_per_s": chance.choice([0, 1, 300, 4000000000]),
                                             "delay": chance.choice(NUMBERS)},
})


def any_time(chance):
    """Not given, present, past, to come, out of any reach."""
    return chance.choice(
        [rospy.Time(), rospy.Time.now(), rospy.Time.now() - rospy.Duration(5),
         rospy.Time.now() + rospy.Duration(1), rospy.Time(1), rospy.Time(4294967295)])


def set_point(chance):
    return Float64(chance.choice(NUMBERS))


def set_points(chance):
    """For all joints, mostly; with any layout, which nobody looks at."""
    count = chance.choice([len(JOINTS)] * 4 + [0, 1, len(JOINTS) + 1, 1000])
    message = Float64MultiArray(data=[chance.choice([0.1, -0.2] * 8 + NUMBERS)
                                      for _ in range(count)])
    message.layout.data_offset = chance.choice([0, 0, 7])
    return message


def trajectory(chance):
    message = JointTrajectory(joint_names=chance.choice(
        [JOINTS, JOINTS[::-1], JOINTS[:2], JOINTS[:3] + ["neck"], []]))
    message.header.stamp = any_time(chance)
    width = chance.choice([len(message.joint_names)] * 4 + [0, 2, 50])
    for i in range(chance.choice([0, 1, 2, 5, 200])):
        places = [chance.choice([0.1, 0.2, -0.2] * 6 + NUMBERS) for _ in range(width)]
        message.points.append(JointTrajectoryPoint(
            positions=places, velocities=chance.choice([[], [0.0] * width, [NAN] * width]),
            time_from_start=rospy.Duration(chance.choice([i + 1, i + 1, i, -1]))))
    return message


def goal_id(chance):
    """Of a goal that there may be, of all, of those before a time, of none."""
    return GoalID(id=chance.choice(["", "1", "2", "3", "nobody", "x" * 1000]),
                  stamp=chance.choice([rospy.Time(), rospy.Time(1), rospy.Time.now()]))


def tolerances(chance):
    return [JointTolerance(name=chance.choice(NAMES), position=chance.choice(NUMBERS),
                           velocity=chance.choice(NUMBERS), acceleration=chance.choice(NUMBERS))
            for _ in range(chance.choice([0, 0, 0, 1, 5]))]


def action_goal(chance):
    return FollowJointTrajectoryActionGoal(goal_id=goal_id(chance), goal=FollowJointTrajectoryGoal(
        trajectory=trajectory(chance), path_tolerance=tolerances(chance),
        goal_tolerance=tolerances(chance),
        goal_time_tolerance=rospy.Duration(chance.choice([0, 0, 1, -1]))))


def home_goal(chance):
    axes = [chance.choice(NAMES + ["arm"]) for _ in range(chance.choice([0, 1, 2, 5, 200]))]
    axes = chance.choice([axes, JOINTS, ["arm"]])
    return HomeActionGoal(goal_id=goal_id(chance), goal=HomeGoal(axes=axes, order=[
        chance.choice([0, 1, -5, 2**31 - 1, -2**31])
        for _ in range(chance.choice([0, 0, len(axes), 3]))]))


TOPICS = {Float64: set_point, Float64MultiArray: set_points, JointTrajectory: trajectory,
          FollowJointTrajectoryActionGoal: action_goal, HomeActionGoal: home_goal, GoalID: goal_id}
