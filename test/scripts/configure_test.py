#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What CMake finds out by itself, alone and in a workspace: Python, control_msgs, wanted tests."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]

# A python of the user's own, without catkin_pkg.
OTHER_PYTHON = "#!/bin/sh\nexit 1\n"
# What an installed package leaves for find_package().
CONTROL_MSGS = "set(control_msgs_FOUND TRUE)\nset(control_msgs_FOUND_CATKIN_PROJECT TRUE)\n"
# They ask what scripts/demo has built, or start user-mode Linux.
LEFT_TO_SCRIPTS = ("setup_test", "convert_ros_canopen_loads_test", "with_vcan_test")


class Configure(unittest.TestCase):
    """Three configurations of one build folder."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="configure_"))
        cls.prefix = cls.folder / "installed"
        python = cls.folder / "bin/python3"
        python.parent.mkdir()
        python.write_text(OTHER_PYTHON, encoding="ascii")
        python.chmod(0o755)
        cls.without = cls.configure()
        cls.kept = (cls.folder / "build/devel/share/control_msgs").exists()
        config = cls.prefix / "share/control_msgs/cmake/control_msgsConfig.cmake"
        config.parent.mkdir(parents=True)
        config.write_text(CONTROL_MSGS, encoding="ascii")
        cls.installed = cls.configure("-DCATKIN_ENABLE_TESTING=OFF")
        cls.targets = subprocess.run(["cmake", "--build", cls.folder / "build", "--target", "help"],
                                     stdout=subprocess.PIPE, text=True, timeout=300,
                                     check=True).stdout
        cls.removed = not (cls.folder / "build/devel/share/control_msgs").exists()
        shutil.rmtree(cls.prefix)
        cls.gone = cls.configure("-DCATKIN_ENABLE_TESTING=ON")
        cls.of_all, cls.of_run_tests = cls.commands("all"), cls.commands("run_tests")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def configure(cls, *options):
        """@return what CMake said."""
        # As after `source devel/setup.bash`: what is built here is in the path, too.
        prefixes = f"{cls.folder}/build/devel:{cls.prefix}"
        path = f"{cls.folder}/bin:/usr/bin:/bin"
        ended = subprocess.run(
            ["cmake", "-G", "Ninja", "-S", REPOSITORY, "-B", cls.folder / "build", *options],
            env={"PATH": path, "HOME": os.environ.get("HOME", "/"), "CMAKE_PREFIX_PATH": prefixes},
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            timeout=600, check=False)
        assert ended.returncode == 0, ended.stdout
        return ended.stdout

    @classmethod
    def commands(cls, target):
        """@return all commands that building a target takes."""
        return subprocess.run(["ninja", "-C", cls.folder / "build", "-t", "commands", target],
                              stdout=subprocess.PIPE, text=True, timeout=300, check=True).stdout

    def test_python_is_that_of_catkin(self):
        self.assertIn("Using PYTHON_EXECUTABLE: /usr/bin/python3", self.without)

    def test_control_msgs_is_built_only_where_none_is_installed(self):
        none = "control_msgs: none installed, that of this repository is built"
        self.assertIn(none, self.without)
        self.assertTrue(self.kept)
        self.assertIn(f"control_msgs: the one in {self.prefix}", self.installed)
        self.assertTrue(self.removed)
        self.assertIn(none, self.gone)

    def test_tests_are_built_only_where_testing_is_on(self):
        self.assertIn("bus_node:", self.targets)
        self.assertNotIn("test_can:", self.targets)

    def test_all_builds_no_test_and_none_of_what_only_tests_need(self):
        self.assertIn("/src/ros/main/bus_node.cpp", self.of_all)
        for words in ("/test/", "/fuzz/", "/src/campaign/"):
            self.assertNotIn(words, self.of_all)

    def test_run_tests_builds_all_tests_and_runs_those_that_need_no_vcan0(self):
        for source in (*REPOSITORY.glob("test/*/*_test.cpp"), *REPOSITORY.glob("fuzz/*.cpp")):
            self.assertIn(str(source), self.of_run_tests)
        programs = (self.folder / "build/tests.txt").read_text(encoding="utf-8").split()
        self.assertGreater(len(programs), 15)
        for program in map(pathlib.Path, programs):
            self.assertEqual(f"/gtest-{program.name}.xml" in self.of_run_tests,
                             not program.name.endswith("_vcan"), program)
        for file in (*REPOSITORY.glob("test/*_test.py"), *REPOSITORY.glob("test/scripts/*_test.py")):
            self.assertEqual(f"/unittest-{file.stem}.xml" in self.of_run_tests,
                             file.stem not in LEFT_TO_SCRIPTS, file)
        for file in REPOSITORY.glob("test/ros/*.test"):
            self.assertIn(str(file), self.of_run_tests)


class Workspace(unittest.TestCase):
    def test_the_line_of_the_readme_configures_where_another_python_comes_first(self):
        readme = (REPOSITORY / "README.md").read_text(encoding="utf-8")
        line = re.search(r"`(catkin_make -D[^`]*)`", readme)[1]
        with tempfile.TemporaryDirectory(prefix="workspace_") as folder:
            workspace = pathlib.Path(folder)
            (workspace / "src").mkdir()
            (workspace / "src/cia402_driver").symlink_to(REPOSITORY)
            python = workspace / "bin/python3"
            python.parent.mkdir()
            python.write_text(OTHER_PYTHON, encoding="ascii")
            python.chmod(0o755)
            ended = subprocess.run(  # with a target that needs no compiler
                [*line.split(), "clean_test_results_cia402_driver"], cwd=workspace,
                env={"PATH": f"{python.parent}:/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")},
                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                text=True, timeout=600, check=False)
        self.assertEqual(ended.returncode, 0, ended.stdout)
        self.assertIn("Using PYTHON_EXECUTABLE: /usr/bin/python3", ended.stdout)
        self.assertIn("+++ processing catkin package: 'cia402_driver'", ended.stdout)


if __name__ == "__main__":
    unittest.main()
