#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/drive_table.py says of drive families what tests have shown, and nothing else."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

TABLE = pathlib.Path(__file__).resolve().parents[2] / "scripts/lib/drive_table.py"

PROFILE = """
name: washer
description: a drive
modes:
  homing: {value: 6, control: homing}
  profile_position: {value: 1, control: position}
  cyclic_velocity: {value: 9, control: velocity}
  velocity: {value: 2, control: velocity}
homing: {kind: drive, methods: {1: x, 17: y}}
"""
TESTS = """
all: {modes: ["Family.Moves/{family}_{mode}"]}
washer:
  methods: ["Washer.Homes/Method{method}Case*"]
  named: {"Washer.Spins": [cyclic_velocity]}
"""
DOCUMENT = """# The washer

A motor. The [checklist](#checklist) has 3 items.

| item | of | another | table |
|---|---|---|---|
| 9 | and | its | row |

## Checklist

| item | what | state | shown by, or what is missing |
|---|---|---|---|
| 1 | it moves | done | `Family.Moves/washer_*`, with water |
| 2 | it dries | open | the wind; shown: `Washer.Spins` |
| 3 | it irons | not possible | no iron |
"""
RESULTS = """passed\ttest_system: All/Family.Moves/washer_pp\tlog\t
passed\ttest_system: Washer.Spins\tlog\t
passed\ttest_system: Some/Washer.Homes/Method17Case3\tlog\t
passed\ttest_system: Some/Washer.Homes/Method17Case4\tlog\t
passed\troad.Test.test_road\tlog\t
"""
FAILED = "failed\ttest_system: All/Family.Moves/washer_csp\tlog\tstuck\n"
README = "# Families\n\nBy hand.\n\n<!-- Below this line: written by scripts/drive_table. -->\nold\n"
FAMILY = ("| [The washer](washer.md) | [washer](../../config/drives/washer.yaml) "
          "| 2 of 3 | 1 of 2 | 1 | 1 | 1 |\n")


class DriveTable(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name)
        self.write("config/drives/washer.yaml", PROFILE)
        self.write("docs/drives/tests.yaml", TESTS)
        self.write("docs/drives/washer.md", DOCUMENT)
        self.write("docs/drives/README.md", README)
        self.write("results.tsv", RESULTS)

    def write(self, name, text):
        file = self.path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def readme(self):
        return (self.path / "docs/drives/README.md").read_text(encoding="utf-8")

    def run_table(self, *options):
        """@return what it says; the exit status must be 1 if it says something, else 0."""
        ended = subprocess.run([sys.executable, TABLE, self.path, self.path / "results.tsv", *options],
                               stdout=subprocess.PIPE, text=True, timeout=60, check=False)
        self.assertEqual(ended.returncode, 1 if ended.stdout else 0)
        return ended.stdout

    def said_of(self, name, text, old, new):
        """What it says once a file has another text; README.md is not written then."""
        self.assertEqual(text.count(old), 1)
        self.write(name, text.replace(old, new))
        said = self.run_table()
        self.assertEqual(self.readme(), README)
        self.write(name, text)
        return said

    def said_of_document(self, old, new):
        return self.said_of("docs/drives/washer.md", DOCUMENT, old, new)

    def test_writes_what_follows_the_marker(self):
        self.assertEqual(self.run_table(), "")
        self.assertTrue(self.readme().startswith(README[:-len("old\n")]))
        self.assertNotIn("\nold\n", self.readme())
        for line in (FAMILY, "| `profile_position` (pp) | 1 | `Family.Moves` |\n",
                     "| `cyclic_velocity` (csv) | 9 | `Washer.Spins` |\n",
                     "| `velocity` (vl) | 2 | open |\n", "| 1 | open |\n", "| 17 | 2 |\n"):
            self.assertIn(line, self.readme())
        self.assertNotIn("homing` (hm)", self.readme())

    def test_checks_what_is_written(self):
        said = self.run_table("--check")
        self.assertIn("README.md: line 6 is\n  old\nand not\n", said)
        self.assertEqual(self.readme(), README)
        self.run_table()
        self.assertEqual(self.run_table("--check"), "")
        self.write("docs/drives/README.md", self.readme().replace("| 1 | open |", "| 1 | shown |"))
        self.assertIn("| 1 | shown |\nand not\n  | 1 | open |\n", self.run_table("--check"))

    def test_a_test_that_failed_shows_nothing(self):
        self.write("docs/drives/washer.md", DOCUMENT.replace("; shown: `Washer.Spins`", ""))
        self.write("results.tsv", RESULTS.replace("passed\ttest_system: Washer.Spins",
                                                  "failed\ttest_system: Washer.Spins"))
        self.assertEqual(self.run_table(), "")
        self.assertIn("| `cyclic_velocity` (csv) | 9 | open |\n", self.readme())

    def test_a_checklist_names_tests_that_have_passed(self):
        self.assertEqual(self.said_of_document("`Washer.Spins`", "`Washer.Flies`"),
                         "washer.md, item 2: `Washer.Flies`: no test of that name has run\n")
        for shown in ("`Family.Moves`", "`Family.*`", "`Family.Moves/washer_pp`"):
            self.write("docs/drives/washer.md", DOCUMENT.replace("`Family.Moves/washer_*`", shown))
            self.assertEqual(self.run_table(), "", shown)
        self.assertEqual(self.readme().count(FAMILY), 1)

    def test_a_failure_is_told_with_its_reason(self):
        said = self.said_of("results.tsv", RESULTS, "passed\ttest_system: Washer.Spins\tlog\t",
                            "failed\ttest_system: Washer.Spins\tlog\ttoo slow")
        self.assertEqual(said, "washer.md, item 2: `Washer.Spins`: Washer.Spins failed: too slow\n")
        said = self.said_of("results.tsv", RESULTS + FAILED, "passed\ttest_system: All",
                            "failed\ttest_system: All")
        self.assertEqual(said, "washer.md, item 1: `Family.Moves/washer_*`: Family.Moves/washer_csp "
                         "failed: stuck, as 1 more\n")

    def test_each_run_under_a_sanitizer_must_pass_too(self):
        both = RESULTS + RESULTS.replace("\ttest", "\tunder address sanitizer: test")
        for run in ("\ttest_system: Washer", "\tunder address sanitizer: test_system: Washer"):
            said = self.said_of("results.tsv", both, "passed" + run, "failed" + run)
            self.assertIn("Washer.Spins failed: failed", said)
        self.write("results.tsv", both.replace(RESULTS, ""))
        self.assertEqual(self.run_table(), "")

    def test_each_item_stands_there_once(self):
        self.assertEqual(self.said_of_document("| 2 | it", "| 3 | it"),
                         "washer.md, item 2: stands there 0 times\n"
                         "washer.md, item 3: stands there 2 times\n")
        self.assertEqual(self.said_of_document("has 3 items", "has 2 items"),
                         "washer.md, item 3: the document says 2 items\n")
        self.assertEqual(self.said_of_document("has 3 items", "is long"),
                         "washer.md: does not say `[checklist](#checklist) has N items`\n")

    def test_a_row_says_its_state_and_why(self):
        self.assertEqual(self.said_of_document("`Family.Moves/washer_*`, with", "seen in"),
                         "washer.md, item 1: is done, and names no test\n")
        self.assertEqual(self.said_of_document("the wind; shown: ", ""),
                         "washer.md, item 2: is open, and does not say why\n")
        self.assertEqual(self.said_of_document("no iron", ""),
                         "washer.md, item 3: is not possible, and does not say why\n")
        for row in ("| 2 | it dries | soon |", "| 2 | it dries, | open | or not |", "| two | it | open |"):
            self.assertIn("a row is number, what, one of done, not possible, open, why\n",
                          self.said_of_document("| 2 | it dries | open |", row))

    def test_what_shows_a_mode_is_there(self):
        for old, new, said in (
                ("Washer.Homes", "Washer.Rests",
                 "washer: `Washer.Rests/Method{method}Case*` fits no test that has run\n"),
                ("Washer.Spins", "Washer.Flies", "washer: `Washer.Flies` fits no test that has run\n"),
                ("cyclic_velocity", "cyclic_torque", "washer: the profile has no `cyclic_torque`\n")):
            self.assertIn(said, self.said_of("docs/drives/tests.yaml", TESTS, old, new))
        self.assertIn("dryer: there is no such profile\n",
                      self.said_of("docs/drives/tests.yaml", TESTS, "\nwasher:", "\ndryer:"))

    def test_a_homing_method_is_shown_from_as_many_starts_as_the_file_says(self):
        two = TESTS + "  starts: {2: [17]}\n"
        self.write("docs/drives/tests.yaml", two)
        self.assertEqual(self.run_table(), "")
        self.write("docs/drives/README.md", README)
        self.assertEqual(self.said_of("docs/drives/tests.yaml", two, "{2: [17]}", "{3: [17]}"),
                         "tests.yaml, washer: `17` is shown from 2 of 3 starts\n")
        self.assertEqual(self.said_of("docs/drives/tests.yaml", two, "{2: [17]}", "{1: [1]}"),
                         "tests.yaml, washer: `1` is shown from 0 of 1 starts\n")
        self.assertEqual(self.said_of("docs/drives/tests.yaml", two, "{2: [17]}", "{1: [18]}"),
                         "tests.yaml, washer: the profile has no `18`\n")

    def test_a_start_that_is_gone_changes_what_is_written(self):
        self.assertEqual(self.run_table(), "")
        self.write("results.tsv", "".join(line for line in RESULTS.splitlines(True) if "Case4" not in line))
        self.assertIn("| 17 | 2 |\nand not\n  | 17 | 1 |\n", self.run_table("--check"))

    def test_a_document_is_of_a_profile(self):
        self.write("docs/drives/dryer.md", DOCUMENT)
        self.assertEqual(self.run_table(), "dryer.md: there is no such profile\n")

    def test_results_and_marker_are_there(self):
        self.assertIn("results.tsv: no C++ test has run\n",
                      self.said_of("results.tsv", RESULTS, RESULTS, ""))
        self.write("docs/drives/README.md", "# Families\n")
        self.assertIn("README.md: lacks the line <!-- Below", self.run_table())


if __name__ == "__main__":
    unittest.main()
