#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/with_vcan hands a command over as it was called, to a place where vcan0 works."""
import os
import pathlib
import subprocess
import tempfile
import time
import unittest

WITH_VCAN = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "with_vcan"

# One start for all questions: each takes seconds where the kernel has no CAN.
QUESTIONS = r"""
echo "interface: $(ip -br link show vcan0)"
candump -n 1 vcan0 > frame &
sleep 0.5
cansend vcan0 123#DEADBEEF
wait
echo "frame: $(cat frame)"
ip link del vcan0
ip link show vcan0 2>/dev/null || echo "deleted: yes"
ip link add vcan0 type vcan && ip link set vcan0 up && echo "added: $(ip -br link show vcan0)"
echo "arguments:$(printf ' [%s]' "$@")"
echo "directory: $PWD"
echo "variable: $WITH_VCAN_TEST"
echo "stdin: $(cat)."
echo "said on stderr" >&2
exit 7
"""


class WithVcan(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as directory:
            cls.directory = os.path.realpath(directory)
            cls.outcome = subprocess.run(
                [WITH_VCAN, "--timeout", "120", "bash", "-c", QUESTIONS, "bash", "a b", "c'd\"", ""],
                cwd=directory, env={**os.environ, "WITH_VCAN_TEST": "two\nlines $x"},
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)

    def test_vcan0_is_up(self):
        self.assertRegex(self.outcome.stdout, r"interface: vcan0 .*<.*\bUP\b")

    def test_a_frame_sent_on_vcan0_is_received(self):
        self.assertRegex(self.outcome.stdout, r"frame: +vcan0 +123 +\[4\] +DE AD BE EF")

    def test_the_command_may_delete_and_add_the_interface(self):
        self.assertIn("deleted: yes", self.outcome.stdout)
        self.assertRegex(self.outcome.stdout, r"added: vcan0 .*<.*\bUP\b")

    def test_the_exit_status_is_handed_back(self):
        self.assertEqual(self.outcome.returncode, 7)

    def test_arguments_with_spaces_and_quotes_arrive_whole(self):
        self.assertIn("arguments: [a b] [c'd\"] []\n", self.outcome.stdout)

    def test_the_working_directory_is_kept(self):
        self.assertIn(f"directory: {self.directory}\n", self.outcome.stdout)

    def test_the_environment_is_kept(self):
        self.assertIn("variable: two\nlines $x\n", self.outcome.stdout)

    def test_stdin_is_empty(self):
        self.assertIn("stdin: .\n", self.outcome.stdout)

    def test_stdout_and_stderr_stay_apart(self):
        self.assertIn("said on stderr\n", self.outcome.stderr)
        self.assertNotIn("said on stderr", self.outcome.stdout)

    def test_a_command_that_hangs_is_killed_at_the_timeout(self):
        start = time.monotonic()
        run = subprocess.run([WITH_VCAN, "--timeout", "6", "sleep", "100"], check=False,
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 124)
        self.assertLess(time.monotonic() - start, 60)


if __name__ == "__main__":
    unittest.main()
