#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The first robot of README.md: its file and its lines as they stand there, typed into a shell."""
import os
import re
import signal
import subprocess
import tempfile
import unittest

import rospy
from robot_client import DEADLINE, Robot, main, package_file, wait_until


def blocks(document, language):
    """The code blocks of a document."""
    with open(package_file(document), encoding="utf-8") as file:
        return re.findall(rf"^```{language}\n(.*?)^```", file.read(), re.MULTILINE | re.DOTALL)


def one(found, words):
    """The only one that holds these words."""
    matches = [text for text in found if words in text]
    if len(matches) != 1:
        raise AssertionError(f"{len(matches)} times instead of once: {words}")
    return matches[0].strip()


class Readme(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.folder = directory.name
        with open(os.path.join(cls.folder, "my_robot.yaml"), "w", encoding="utf-8") as file:
            file.write(one(blocks("README.md", "yaml"), "shoulder:") + "\n")
        cls.lines = one(blocks("README.md", "bash"), "/shoulder/home").splitlines()
        launch = one(blocks("README.md", "bash"), "sim:=true")
        cls.launch = subprocess.Popen(["bash", "-c", launch], cwd=cls.folder,
                                      stdin=subprocess.DEVNULL, start_new_session=True)
        cls.addClassCleanup(cls.end)
        cls.robot = Robot("bus", "arm")
        cls.addClassCleanup(cls.robot.close)

    @classmethod
    def end(cls):
        os.killpg(cls.launch.pid, signal.SIGINT)
        try:
            cls.launch.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            os.killpg(cls.launch.pid, signal.SIGKILL)
            cls.launch.wait()

    def shell(self, line):
        """@return what a line has printed; it must end well."""
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=DEADLINE, check=False)
        print(f"$ {line}\n{done.stdout}", flush=True)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}")
        return done.stdout

    def run_line(self, words):
        return self.shell(one(self.lines, words))

    def test_1_it_homes_moves_and_halts(self):
        rospy.wait_for_service("/bus/shoulder/home", DEADLINE)  # that somebody types sooner than that
        self.assertIn("success: True", self.run_line("/shoulder/home"))
        wait_until(lambda: self.robot.joint_state, "joint states")
        self.robot.wait_state("shoulder", "operation enabled")
        self.robot.wait_at("shoulder", 0.0, 0.001)
        self.run_line("/shoulder/command")
        self.robot.wait_at("shoulder", 0.5, 0.001)
        self.assertIn("shoulder", self.run_line("/joint_states"))
        self.assertIn("success: True", self.run_line("/shoulder/halt"))
        self.assertEqual(self.robot.axis("shoulder").state, "operation enabled")

    def test_2_its_objects_are_read_and_written_in_all_forms(self):
        self.assertIn("success: True", self.shell("rosservice call /bus/shoulder/read_object 6064h:0"))
        lines = [line.strip() for line in open(package_file("docs/interface.md"), encoding="utf-8")
                 if line.startswith("    rosservice call /bus/shoulder/")]
        self.assertEqual(len(lines), 6)
        for line in lines:
            answer = self.shell(line)
            if "2003h" in line:  # an object of another drive
                self.assertRegex(answer, "success: False(.|\n)*2003:02(.|\n)*0x06020000")
            elif "arm_touch_probe" in line:  # nothing comes to the probe of a simulated drive
                self.assertRegex(answer, r"success: False(.|\n)*edge(.|\n)*rising: \.?nan")
            else:
                self.assertIn("success: True", answer)

    def test_3_its_power_goes_off(self):
        self.assertIn("success: True", self.run_line("/bus/disable"))
        self.robot.wait_state("shoulder", "switch on disabled")


if __name__ == "__main__":
    main("readme")
