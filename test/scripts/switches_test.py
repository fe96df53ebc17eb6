#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/switches.py: mistakes that are made by a switch at run time."""
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import types
import unittest

LIB = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib"
sys.path.insert(0, str(LIB))
import mutate  # noqa: E402
import mutations  # noqa: E402
import switches  # noqa: E402

HEAD = "// Copyright\n"


class Switched(unittest.TestCase):
    """Mistakes with a switch each, in a program that tells what it does."""

    BODY = HEAD + """#include <cstdio>
int sum = 0;
bool report(int more) {
  sum += more;
  return more > 2;
}
void count(int limit) {
  if (limit < 1) return;
  for (int i = 0; i < limit; ++i) {
    const bool last = i == limit - 1;
    report(last ? 10 : 1);  // of two kinds
  }
  if (sum >= 13) {
    sum += 100;
  } else if (sum == 12) {
    sum -= 1;
  }
}
"""
    MAIN = """int main() {
  count(3);
  const bool more = report(3);
  std::printf("%d %d", sum, int(more));
}
"""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name)
        (self.path / "mistake.h").write_text(switches.HEADER, encoding="utf-8")

    def run_switched(self, text, number):
        (self.path / "a.cpp").write_text(text + self.MAIN, encoding="utf-8")
        subprocess.run(["g++", "-std=c++17", "-w", "-include", "mistake.h", "a.cpp", "-o", "a"],
                       cwd=self.path, check=True)
        return subprocess.run([self.path / "a"], stdout=subprocess.PIPE, text=True, check=True,
                              env={switches.VARIABLE: str(number)}).stdout

    def test_a_switched_mistake_does_what_the_mistake_does(self):
        tried = 0
        for seed in range(6):
            text, made = switches.with_switches("a.cpp", self.BODY, 5, random.Random(seed))
            self.assertEqual(self.run_switched(text, 0), "14 1")
            self.assertEqual(min(made), 5)
            for number, mutation in made.items():
                with self.subTest(str(mutation)):
                    broken = mutations.broken(self.BODY, mutation)
                    self.assertEqual(self.run_switched(text, number), self.run_switched(broken, 0))
                tried += 1
        self.assertGreater(tried, 40)

    def test_no_line_moves_and_only_lines_with_a_switch_differ(self):
        text, made = switches.with_switches("a.cpp", self.BODY, 1, random.Random(1))
        before, after = self.BODY.split("\n"), text.split("\n")
        self.assertEqual(len(before), len(after))
        self.assertEqual({i + 1 for i in range(1, len(before)) if before[i] != after[i]},
                         {mutation.line for mutation in made.values()})

    def test_what_a_compiler_must_know_has_no_switch(self):
        text = HEAD + "constexpr int kA = 3;\nvoid f(int a) {\n  static int b = 4;\n  switch (a) {\n" \
            "    case 3:\n      break;\n  }\n  if (const int c = 5) a = c;\n}\n"
        _, made = switches.with_switches("a.cpp", text, 1, random.Random(1))
        self.assertEqual({mutation.line for mutation in made.values()}, {3, 9})

    def test_a_line_that_does_not_compile_with_its_switch_is_put_back(self):
        text = HEAD + "int f(int a) {\n  return a + 1;\n}\nvoid g(int&);\nvoid h(int& a) {\n  g(a);\n}\n"
        file = self.path / "src/drive/a.cpp"
        file.parent.mkdir(parents=True)
        file.write_text(text, encoding="utf-8")
        build = types.SimpleNamespace(tree=self.path, build=self.path)
        put = switches.Switches(self.path, build)
        put.put(["src/drive"], 1)
        wrong = file.read_text(encoding="utf-8").replace("void g", "nonsense x;  void g")
        file.write_text(wrong, encoding="utf-8")
        command = f"g++ -include {self.path}/mistake.h -o a.o -c {file}"
        (self.path / "compile_commands.json").write_text(
            json.dumps([{"file": str(file), "command": command}]), encoding="utf-8")
        self.assertIn("error", put.take_away_malformed(1), "nobody's switch is to blame")
        count = len(put.mutations)
        number, mutation = next(found for found in put.mutations.items() if found[1].line == 3)
        lines = file.read_text(encoding="utf-8").replace("nonsense x;  ", "").split("\n")
        lines[mutation.line - 1] = "  return nonsense;"
        file.write_text("\n".join(lines), encoding="utf-8")
        self.assertIsNone(put.take_away_malformed(1))
        self.assertNotIn(number, put.mutations)
        self.assertEqual(len(put.mutations), count - 1)
        self.assertEqual(file.read_text(encoding="utf-8").split("\n")[mutation.line - 1],
                         mutation.before)

    def test_the_own_test_of_the_module_judges(self):
        script = "[ \"${CIA402_MISTAKE:-0}\" = 7 ] || exit 0\necho '[  FAILED  ] Axis.IsLate'; exit 1"
        test = self.path / "test_drive"
        test.write_text("#!/bin/bash\n" + script, encoding="utf-8")
        test.chmod(0o755)
        build = types.SimpleNamespace(build=self.path)
        trial = mutate.SwitchedTrial(build, self.path / "run0")
        self.assertIsNone(trial.prepare(["test_drive"]))
        mutation = mutations.Mutation("src/drive/a.cpp", 3, "truth", "a", "b")
        self.assertEqual(trial.judge((7, mutation)), "seen by test_drive: Axis.IsLate")
        self.assertEqual(trial.judge((8, mutation)), "survived")


if __name__ == "__main__":
    unittest.main()
