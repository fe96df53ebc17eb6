#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/install_dependencies serves one system and says so on others."""
import os
import pathlib
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/install_dependencies"

UBUNTU = 'ID=ubuntu\nVERSION_ID="20.04"\nPRETTY_NAME="Ubuntu 20.04.6 LTS"\n'
DEBIAN_13 = 'ID=debian\nVERSION_ID="13"\nPRETTY_NAME="Debian GNU/Linux 13 (trixie)"\n'


def run_on(os_release, *arguments):
    """Runs it on a system that calls itself so."""
    with tempfile.NamedTemporaryFile("w") as file:
        file.write(os_release)
        file.flush()
        return subprocess.run([SCRIPT, *arguments], env={**os.environ, "OS_RELEASE": file.name},
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=60, check=False)


class InstallDependencies(unittest.TestCase):
    def test_another_system_is_told_its_counterparts(self):
        for os_release, name in ((UBUNTU, "Ubuntu 20.04.6 LTS"),
                                 (DEBIAN_13, "Debian GNU/Linux 13 (trixie)"), ("", "unknown")):
            ended = run_on(os_release)
            self.assertEqual((ended.returncode, ended.stdout), (1, ""))
            for words in (f"this is {name};", "only Debian 12", "Nothing was\nchanged",
                          "rosdep install", "libeigen3-dev", "ros-noetic-diagnostic-updater"):
                self.assertIn(words, ended.stderr)

    def test_the_list_is_printed_anywhere(self):
        ended = run_on(UBUNTU, "--list")
        self.assertEqual(ended.returncode, 0)
        self.assertIn("libroscpp-dev", ended.stdout.splitlines())


if __name__ == "__main__":
    unittest.main()
