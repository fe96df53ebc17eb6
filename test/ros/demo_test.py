#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The story that scripts/demo tells, with the robot of launch/demo.launch."""
import os
import subprocess
import sys
import tempfile
import unittest

from robot_client import DEADLINE, main, package_file

JOINTS = ["shoulder", "elbow", "wrist", "tool", "gripper"]


class Demo(unittest.TestCase):
    def test_every_axis_homes_and_follows_and_the_picture_is_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            told = subprocess.run([sys.executable, package_file("scripts/lib/demo.py"), folder],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, text=True, timeout=3 * DEADLINE,
                                  check=False)
            print(told.stdout, flush=True)
            self.assertEqual(told.returncode, 0, told.stdout)
            with open(os.path.join(folder, "tracking.png"), "rb") as picture:
                self.assertEqual(picture.read(8), b"\x89PNG\r\n\x1a\n")
        self.assertIn("Every axis followed.", told.stdout)
        for joint in JOINTS:
            self.assertRegex(told.stdout, rf"(?m)^  {joint} +moved between")


if __name__ == "__main__":
    main("demo_test")
