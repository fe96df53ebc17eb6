#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/check_text.py finds what ROS tools print as `??`, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CHECK = pathlib.Path(__file__).resolve().parents[2] / "scripts/lib/check_text.py"

ALLOWED = r"""
// 5 rad/s² "in a comment°"
/* – "and
   here" – */
const char* a = "rad/s^2";  // °
const char b = '"';  // "°"
const int c = 1'000'000;  // "°"
const char* d = "// no comment \"";  // ²
"""


class CheckText(unittest.TestCase):
    def check(self, path, text):
        """@return what is said of a repository that has this file alone."""
        with tempfile.TemporaryDirectory() as repository:
            file = pathlib.Path(repository, path)
            file.parent.mkdir(parents=True)
            file.write_text(text, encoding="utf-8")
            ended = subprocess.run([sys.executable, CHECK, repository], stdout=subprocess.PIPE,
                                   text=True, timeout=60, check=False)
        self.assertEqual(ended.returncode, 1 if ended.stdout else 0)
        return ended.stdout

    def test_comments_of_sources_may_hold_anything(self):
        self.assertEqual(self.check("src/bus/a.cpp", ALLOWED), "")

    def test_string_literals_may_not(self):
        for literal in ('"5 m/s²"', 'R"(\n–)"', "f('x', \"°\")", "1'000, \"°\", 2'000",
                        r'"a\\", "°"'):
            said = self.check("include/a/b.h", f"// first line\nauto a = g({literal});\n")
            self.assertTrue(said.startswith("include/a/b.h:2: not ASCII: "), (literal, said))

    def test_what_is_read_as_it_stands_may_not_either(self):
        for path in ("config/robots/a.yaml", "launch/a.launch", "msg/A.msg"):
            self.assertEqual(self.check(path, "a: 1\n# 30 °\n"),
                             f"{path}:2: not ASCII: # 30 °\n")


if __name__ == "__main__":
    unittest.main()
