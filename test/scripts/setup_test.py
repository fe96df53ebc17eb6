#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What a user has who has run scripts/demo: the commands of ROS know the driver, other packages find it."""
import os
import pathlib
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
SETUP = REPOSITORY / "build/ros/devel/setup.bash"


def in_new_terminal(command):
    """Runs a command as a user would who has nothing but sourced the file that is told."""
    environment = {"PATH": "/usr/bin:/bin", "HOME": os.environ.get("HOME", "/root")}
    return subprocess.run(["bash", "-c", f"source '{SETUP}' && {command}"], env=environment,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=120, check=False)


class SetUp(unittest.TestCase):
    def test_rosrun_finds_the_nodes(self):
        for node in ("bus_node", "simulated_drives"):
            ended = in_new_terminal(f"rosrun cia402_driver {node} --help")
            self.assertEqual(ended.returncode, 0, ended.stdout)
            self.assertIn(f"Usage: {node}", ended.stdout)

    def test_roslaunch_finds_the_launch_files(self):
        ended = in_new_terminal("roslaunch --nodes cia402_driver demo.launch")
        self.assertEqual((ended.returncode, ended.stdout.strip()), (0, "/bus"))


# A package of somebody else, with what it is told of the driver and nothing besides.
EMBEDDER = """cmake_minimum_required(VERSION 3.16)
project(embedder CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(cia402_driver REQUIRED)
find_package(Threads REQUIRED)
add_executable(move_arm {example})
target_include_directories(move_arm PRIVATE ${{cia402_driver_INCLUDE_DIRS}})
target_link_libraries(move_arm ${{cia402_driver_LIBRARIES}} Threads::Threads)
"""


class Embedding(unittest.TestCase):
    def test_another_package_builds_the_example_and_moves_the_robot(self):
        with tempfile.TemporaryDirectory() as folder:
            example = REPOSITORY / "examples/move_arm.cpp"
            pathlib.Path(folder, "CMakeLists.txt").write_text(EMBEDDER.format(example=example),
                                                              encoding="utf-8")
            ended = in_new_terminal(
                f"cmake -S '{folder}' -B '{folder}/build' -DPYTHON_EXECUTABLE=/usr/bin/python3 && "
                f"cmake --build '{folder}/build' && '{folder}/build/move_arm' '{REPOSITORY}/config'")
            self.assertEqual(ended.returncode, 0, ended.stdout)
            self.assertIn("arm: goal reached", ended.stdout)


if __name__ == "__main__":
    unittest.main()
