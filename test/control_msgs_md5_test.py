#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The control_msgs that this driver speaks are those that MoveIt and rqt speak.

Client and server refuse each other when the md5 sums of their messages differ. The sums below are
those of ros-controls/control_msgs for ROS Kinetic to Noetic.
"""
import unittest

from control_msgs import msg, srv

SUMS = {
    "FollowJointTrajectoryAction": "bc4f9b743838566551c0390c65f1a248",
    "FollowJointTrajectoryGoal": "69636787b6ecbde4d61d711979bc7ecb",
    "FollowJointTrajectoryResult": "493383b18409bfb604b4e26c676401d2",
    "FollowJointTrajectoryFeedback": "10817c60c2486ef6b33e97dcd87f4474",
    "FollowJointTrajectoryActionGoal": "cff5c1d533bf2f82dd0138d57f4304bb",
    "FollowJointTrajectoryActionResult": "c4fb3b000dc9da4fd99699380efcc5d9",
    "FollowJointTrajectoryActionFeedback": "d8920dc4eae9fc107e00999cce4be641",
    "JointTolerance": "f544fe9c16cf04547e135dd6063ff5be",
    # The same text as the action's feedback, so the same sum.
    "JointTrajectoryControllerState": "10817c60c2486ef6b33e97dcd87f4474",
}
SERVICE_SUMS = {
    "QueryTrajectoryState": "ec93cdecbd8062d761aa52b7c90cd44b",
}


class ControlMsgs(unittest.TestCase):
    pass


def expect_sum(kinds, name, md5):
    def test(self):
        self.assertEqual(getattr(kinds, name)._md5sum, md5)
    return test


for _kinds, _sums in ((msg, SUMS), (srv, SERVICE_SUMS)):
    for _name, _md5 in _sums.items():
        setattr(ControlMsgs, f"test_{_name}_has_the_md5_sum_of_ros_controls",
                expect_sum(_kinds, _name, _md5))

if __name__ == "__main__":
    unittest.main()
