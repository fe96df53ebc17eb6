#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/with_vcan hands a command over as it was called, to a place where vcan0 works."""
import os
import pathlib
import signal
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
                [WITH_VCAN, "--timeout", "600", "bash", "-c", QUESTIONS, "bash", "a b", "c'd\"", ""],
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
        run = subprocess.run([WITH_VCAN, "--timeout", "6", "bash", "-c", "while :; do :; done"],
                             check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.assertEqual(run.returncode, 124)
        self.assertLess(time.monotonic() - start, 300)


# Reads the clock until told to stop; prints the longest time between two readings.
WATCH_THE_CLOCK = """
import os, time
last, longest = time.monotonic(), 0.0
open("started", "w").close()
enough = False
while not enough:
    enough = os.path.exists("enough")
    now = time.monotonic()
    longest, last = max(longest, now - last), now
print(longest)
"""


def user_mode_linux(ancestor):
    """The process that is the kernel, started by with_vcan."""
    for entry in pathlib.Path("/proc").iterdir():
        try:
            command = (entry / "comm").read_text().strip()
            parent = (entry / "stat").read_text().rsplit(")", 1)[1].split()[1]
            grandparent = pathlib.Path("/proc", parent, "stat").read_text()
        except (OSError, IndexError):
            continue  # no process, or ended meanwhile
        if command == "linux.uml" and int(grandparent.rsplit(")", 1)[1].split()[1]) == ancestor:
            return int(entry.name)
    raise AssertionError(f"no user-mode Linux below process {ancestor}")


class TimeInUserModeLinux(unittest.TestCase):
    """It does not depend on how much of the processors the machine gets."""

    def test_nobody_waits_for_idle_time(self):
        run = subprocess.run([WITH_VCAN, "--uml", "--timeout", "600", "bash", "-c",
                              "date +%s; sleep 86400; date +%s"],
                             stdout=subprocess.PIPE, text=True, check=True)
        before, after = map(int, run.stdout.split())
        self.assertIn(after - before, range(86400, 86410))

    def test_what_gets_no_processor_for_a_while_does_not_notice(self):
        with tempfile.TemporaryDirectory() as directory:
            run = subprocess.Popen(
                [WITH_VCAN, "--uml", "--timeout", "600", "/usr/bin/python3", "-c", WATCH_THE_CLOCK],
                cwd=directory, stdout=subprocess.PIPE, text=True)
            while not os.path.exists(os.path.join(directory, "started")):
                self.assertIsNone(run.poll(), "it ended before it began")
                time.sleep(0.01)
            kernel = user_mode_linux(run.pid)
            os.kill(kernel, signal.SIGSTOP)
            time.sleep(2.0)  # what is tested is that these do not count
            os.kill(kernel, signal.SIGCONT)
            pathlib.Path(directory, "enough").touch()
            output, _ = run.communicate()
        self.assertEqual(run.returncode, 0)
        self.assertLess(float(output), 0.2)


if __name__ == "__main__":
    unittest.main()
