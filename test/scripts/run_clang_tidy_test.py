#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/run_clang_tidy.py: every source is checked, many as one, and what fails is found."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

LIB = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib"
sys.path.insert(0, str(LIB))
import run_clang_tidy  # noqa: E402

# Stands in for clang-tidy: complains of whatever includes, or is, a source with "bad" in it, and notes
# how many sources it got.
CLANG_TIDY = """#!/bin/bash
[ "$1" != --version ] || { echo 1; exit; }
for argument; do case $argument in *.cpp) file=$argument ;; esac; done
mapfile -t sources < <(sed -n 's/#include "\\(.*\\.cpp\\)"/\\1/p' "$file")
[ ${#sources[@]} -gt 0 ] || sources=("$file")
echo "${#sources[@]}" >> "$CALLS"
if grep -q bad "${sources[@]}"; then echo "$file: error: bad"; exit 1; fi
"""


class RunClangTidy(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name).resolve()
        (self.path / "src").mkdir()
        (self.path / ".clang-tidy").write_text("")
        fake = self.path / "clang-tidy"
        fake.write_text(CLANG_TIDY)
        fake.chmod(0o755)
        self.calls = self.path / "calls"

    def write(self, name, own="", public=""):
        file = self.path / "src" / name
        file.write_text(f"namespace a {{\nnamespace {{\n{own}\n}}  // namespace\n{public}\n}}\n")
        return file

    def run_it(self):
        """@return exit status, what it told, how many sources each call of clang-tidy got."""
        commands = [{"file": str(file), "command": f"g++ -Isrc -o a/x.dir/{file.name}.o {file}"}
                    for file in sorted((self.path / "src").glob("*.cpp"))]
        (self.path / "compile_commands.json").write_text(json.dumps(commands))
        self.calls.write_text("")
        environment = {**os.environ, "PATH": f"{self.path}:{os.environ['PATH']}",
                       "CALLS": str(self.calls)}
        run = subprocess.run([sys.executable, LIB / "run_clang_tidy.py", self.path, self.path,
                              self.path / "cache"], stdout=subprocess.PIPE, text=True,
                             env=environment, check=False)
        return run.returncode, run.stdout, sorted(map(int, self.calls.read_text().split()))

    def test_checks_many_as_one_and_none_twice(self):
        for i in range(40):
            self.write(f"{i:02}.cpp", f"constexpr int kNumber{i} = 1;")
        status, _, calls = self.run_it()
        self.assertEqual((status, calls), (0, [8, 32]))
        self.assertEqual(self.run_it()[2], [])
        self.write("07.cpp", "constexpr int kOther = 1;")
        self.assertEqual(self.run_it()[2], [1])

    def test_finds_the_one_that_fails_by_halves(self):
        for i in range(8):
            self.write(f"{i}.cpp", "// bad" if i == 5 else "")
        status, told, calls = self.run_it()
        self.assertEqual((status, calls), (1, [1, 1, 2, 2, 4, 4, 8]))
        self.assertIn("src/5.cpp: error: bad", told)
        self.assertIn("1 files with findings", told)
        self.assertEqual(self.run_it()[2], [1], "the others have passed")

    def test_tells_of_a_name_that_is_not_used(self):
        self.write("unused.cpp", "using std::vector;")
        status, told, calls = self.run_it()
        self.assertEqual((status, calls), (1, []))
        self.assertIn("`vector` is declared (using std::vector;) and not used", told)

    def test_keeps_apart_what_declares_the_same_name(self):
        rows = [("constexpr int kFirst = 1, kMost = 2;", "const double kMost{3.0};"),
                ("constexpr const char* kNames[] = {\n    \"a\", \"b\"};", "constexpr int kNames = 1;"),
                ("struct Row {\n  int a;\n};", "enum class Row { a };"),
                ("using Row = int;", "class Row {\n};"),
                ("using Row = b::Line;", "using Row = c::Line;"),
                ("using Row = b::Row;", "class Row {\n};"),
                ("int turns(double a) { return 1; }", "bool turns(int a) {"),
                ("using b::Quantity;\nQuantity a;", "struct Quantity {\n};")]
        for first, second in rows:
            for one, other in ((first, second), (second, first)):
                files = [self.write("1.cpp", one), self.write("2.cpp", other)]
                batches = run_clang_tidy.batches([(file, "/x.dir/") for file in files])
                self.assertEqual([len(batch) for batch in batches], [1, 1], (one, other))

    def test_puts_together_what_may_have_the_same_name(self):
        rows = [("using b::Quantity;\nQuantity a;", "using b::Quantity;\nQuantity c;"),
                ("using Source = b::Source;\nSource a;", "using Source = b::Source;\nSource c;"),
                ("struct Row {\n  int kMost = 1;\n  int turns(int a) { return a; }\n};",
                 "constexpr int kMost = 1;\nint turns(int a) {"),
                ("// struct Row {", "struct Row {")]
        for one, other in rows:
            files = [self.write("1.cpp", one), self.write("2.cpp", other)]
            batches = run_clang_tidy.batches([(file, "/x.dir/") for file in files])
            self.assertEqual([len(batch) for batch in batches], [2], (one, other))
        files = [self.write("1.cpp", public="const char* text(int a) {"),
                 self.write("2.cpp", public="const char* text(double a) {")]
        self.assertEqual(len(run_clang_tidy.batches([(file, "/x.dir/") for file in files])), 1)


if __name__ == "__main__":
    unittest.main()
