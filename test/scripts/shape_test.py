#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/shape --check finds what has outgrown its room, and nothing else."""
import pathlib
import subprocess
import tempfile
import unittest

SHAPE = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "shape"


def function(name, lines):
    return f"int {name}() {{\n" + "  f();\n" * (lines - 2) + "}\n"


class Shape(unittest.TestCase):
    def check(self, files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("include", "src/drive", "test", "benchmark", "fuzz"):
                (root / name).mkdir(parents=True)
            for name, text in files.items():
                (root / name).write_text(text, encoding="utf-8")
            run = subprocess.run([SHAPE, "--check", folder], stdout=subprocess.PIPE, text=True,
                                 check=False)
        return run.returncode, run.stdout

    def test_what_keeps_to_its_room_is_not_told(self):
        members = "".join(f"  int a{i};\n" for i in range(60))
        self.assertEqual(self.check({
            "src/large.h": f"struct Large {{\n{members}}};\n",
            "src/long.cpp": function("longest", 60),
            "test/file.cpp": "\n" * 400,
            "include/told.h": "/// Says what it is.\nstruct Told {};\n",
        }), (0, ""))

    def test_what_does_not_is(self):
        members = "".join(f"  int a{i};\n" for i in range(61))
        code, told = self.check({
            "src/large.h": f"struct Large {{\n{members}}};\n",
            "src/two.h": "class Two {\n  int one();\n  int other();\n};\n",
            "src/one.cpp": "int Two::one() { return 1; }\n",
            "src/other.cpp": "int Two::other() { return 2; }\n",
            "src/long.cpp": function("longest", 61),
            "test/file.cpp": "\n" * 401,
            "include/untold.h": "struct Untold {};\n",
            "src/drive/axis.cpp": '#include "canopen/node/node.h"\n',
        })
        self.assertEqual(code, 1)
        for line in ("class of 61 (over 60): Large",
                     "implemented in 2 sources: Two (src/one.cpp, src/other.cpp)",
                     "function of 61 lines: longest (src/long.cpp)",
                     "file of 401 lines: test/file.cpp",
                     "public headers: 1, of 1 public declarations in them 0 documented (0 %)",
                     "includes of drive/ that cross the port: 1"):
            self.assertIn(line, told.splitlines())
        self.assertEqual(len(told.splitlines()), 6, told)


if __name__ == "__main__":
    unittest.main()
