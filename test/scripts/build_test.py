#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/build.sh shows how far a build is, and what is wrong where it fails."""
import os
import pathlib
import pty
import re
import select
import subprocess
import tempfile
import unittest

LIB = pathlib.Path(__file__).resolve().parents[2] / "scripts/lib"

# Configures; then "builds" forty files and ends as it is told.
CMAKE = """#!/bin/bash
[ "$1" = --build ] || { echo "-- Configuring done"; exit; }
for file in {1..40}; do echo "${NINJA_STATUS/'%f/%t'/$file/40}Building CXX object file_$file.o"; done
[ "$STATUS" = 0 ] || echo "file_40.cpp:7: error: no such thing"
exit "$STATUS"
"""
BUILD = """set -euo pipefail
source "$LIB/common.sh"
source "$LIB/build.sh"
build "$FOLDER/build" all 2>"$FOLDER/words"
"""


class Build(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "cmake").write_text(CMAKE, encoding="ascii")
        (self.folder / "cmake").chmod(0o755)

    def build(self, status, stderr):
        """Builds with that exit status of the compiler. Words of the build go elsewhere than
        progress, as in scripts/test. @return exit status."""
        environment = {"PATH": f"{self.folder}:/usr/bin:/bin", "LIB": str(LIB),
                       "FOLDER": str(self.folder), "STATUS": str(status)}
        return subprocess.run(["bash", "-c", BUILD, "build_test"], env=environment,
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=stderr,
                              timeout=60, check=False).returncode

    def read(self, name):
        return (self.folder / name).read_text(encoding="utf-8")

    def test_tenths_are_told_where_there_is_no_terminal(self):
        with open(self.folder / "progress", "w", encoding="ascii") as progress:
            self.assertEqual(self.build(0, progress), 0)
        lines = [re.sub(r"^== +\d+:\d\d ", "", line) for line in self.read("progress").splitlines()]
        self.assertEqual(lines, [f"  {done} of 40" for done in range(4, 44, 4)])
        self.assertIn("building in", self.read("words"))
        self.assertIn("[17/40] Building CXX object file_17.o\n", self.read("build/build.log"))

    def test_a_terminal_has_one_line_of_it(self):
        terminal, end = pty.openpty()
        seen = ""
        try:
            self.assertEqual(self.build(0, end), 0)
            while not seen.endswith("\033[K") and select.select([terminal], [], [], 5.0)[0]:
                seen += os.read(terminal, 10000).decode()
        finally:
            os.close(terminal)
            os.close(end)
        self.assertEqual(seen, "".join(f"\r   {done} of 40 " for done in range(1, 41)) + "\r\033[K")

    def test_a_build_that_fails_ends_the_script_with_the_words_of_the_compiler(self):
        self.assertEqual(self.build(1, subprocess.DEVNULL), 1)
        words = self.read("words")
        self.assertIn("file_40.cpp:7: error: no such thing\n", words)
        self.assertIn("build_test: the build failed, see ", words)
        self.assertNotIn("Building", words)
        self.assertNotIn("Configuring", words)


if __name__ == "__main__":
    unittest.main()
