#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/run_tests.py: what has not run and passed has failed, and the reason is told."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

LIB = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib"
sys.path.insert(0, str(LIB))
import run_tests  # noqa: E402

UNITTEST = """
import unittest
class Three(unittest.TestCase):
    def test_good(self): pass
    def test_unequal(self): self.assertEqual(1, 2, "one\\n is not two")
    def test_raises(self): raise ValueError("x")
    @unittest.skip("for later")
    def test_left_out(self): pass
    def test_parts(self):
        with self.subTest("first"): self.fail("a part")
"""
# Stands in for an executable of GoogleTest: lists its cases, writes its report, ends with a status.
GTEST = """#!/bin/bash
case $1 in
  --gtest_list_tests) printf 'Suite.\\n  Good\\n  Bad  # comment\\n  DISABLED_Never\\n' ;;
  *) [ -z '{report}' ] || echo '{report}' > "${{2#--gtest_output=json:}}"; exit {status} ;;
esac
"""
REPORT = """{"testsuites": [{"name": "Suite", "testsuite": [
  {"name": "Good", "result": "COMPLETED"},
  {"name": "Bad", "result": "COMPLETED", "failures": [{"failure": "first"}, {"failure": "second"}]},
  {"name": "DISABLED_Never", "result": "SUPPRESSED"}]}]}"""
GOOD_REPORT = """{"testsuites": [{"name": "Suite", "testsuite": [
  {"name": "Good", "result": "COMPLETED"}, {"name": "Bad", "result": "COMPLETED"},
  {"name": "DISABLED_Never", "result": "COMPLETED"}]}]}"""
# Its first process runs the first of two cases; the second ends badly.
SHARED = """#!/bin/bash
[ "$1" != --gtest_list_tests ] || { printf 'Suite.\\n  First\\n  Second\\n'; exit; }
[ "$GTEST_TOTAL_SHARDS $GTEST_SHARD_INDEX" = '2 0' ] || exit 3
echo '{"testsuites": [{"name": "Suite", "testsuite": [{"name": "First", "result": "COMPLETED"}]}]}' \\
  > "${2#--gtest_output=json:}"
"""


class RunTests(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name)

    def run_on(self, kind, name, text, *options):
        """@return exit status, {test: (passed or failed, reason)}."""
        file = self.path / name
        file.write_text(text)
        file.chmod(0o755)
        logs = self.path / "logs"
        run = subprocess.run(["/usr/bin/python3", LIB / "run_tests.py", *options, kind, logs, file],
                             stdout=subprocess.DEVNULL, check=False)
        lines = (logs / "results.tsv").read_text().splitlines()
        fields = [line.split("\t") for line in lines]
        for field in fields:
            self.assertTrue(os.path.exists(field[2]), field)
        return run.returncode, {field[1]: (field[0], field[3]) for field in fields}

    def test_every_case_of_a_unittest(self):
        status, results = self.run_on("unittest", "three_test.py", UNITTEST)
        self.assertEqual(status, 1)
        self.assertEqual(results, {
            "three_test.Three.test_good": ("passed", ""),
            "three_test.Three.test_unequal": ("failed", "1 != 2 : one is not two"),
            "three_test.Three.test_raises": ("failed", "ValueError('x')"),
            "three_test.Three.test_left_out": ("failed", "did not run"),
            "three_test.Three.test_parts": ("failed", "a part"),
        })

    def test_a_unittest_that_cannot_be_loaded(self):
        status, results = self.run_on("unittest", "broken_test.py", "import no_such_module\n")
        self.assertEqual(status, 1)
        [(outcome, reason)] = results.values()
        self.assertEqual(outcome, "failed")
        self.assertIn("Failed to import test module: broken_test", reason)

    def test_every_case_of_googletest(self):
        status, results = self.run_on("gtest", "suite", GTEST.format(report=REPORT, status=1))
        self.assertEqual(status, 1)
        self.assertEqual(results, {
            "suite: Suite.Good": ("passed", ""),
            "suite: Suite.Bad": ("failed", "first second"),
            "suite: Suite.DISABLED_Never": ("failed", "did not run (status 1)"),
        })

    def test_googletest_that_crashes_before_its_report(self):
        _, results = self.run_on("gtest", "suite", GTEST.format(report="", status=139))
        self.assertEqual(set(results.values()), {("failed", "did not run (status 139)")})

    def test_googletest_that_passes_and_then_ends_badly(self):
        status, results = self.run_on("gtest", "suite", GTEST.format(report=GOOD_REPORT, status=1))
        self.assertEqual(status, 1)
        self.assertEqual(results["suite: ends with status 0"], ("failed", "ended with 1"))

    def test_all_good(self):
        status, results = self.run_on("gtest", "suite", GTEST.format(report=GOOD_REPORT, status=0))
        self.assertEqual(status, 0)
        self.assertEqual([outcome for outcome, _ in results.values()], ["passed"] * 3)

    def run_shared(self, name):
        file, logs = self.path / name, self.path / "logs"
        file.write_text(SHARED)
        file.chmod(0o755)
        logs.mkdir()
        run_tests.run_gtests(run_tests.Results(logs), [str(file)], 2)
        fields = [line.split("\t") for line in (logs / "results.tsv").read_text().splitlines()]
        return {field[1]: (field[0], field[3]) for field in fields}

    def test_googletest_shared_out_to_two_processes(self):
        self.assertEqual(self.run_shared("suite"), {
            "suite: Suite.First": ("passed", ""),
            "suite: Suite.Second": ("failed", "did not run (status 3)")})

    def test_googletest_that_is_gone_when_it_is_to_run(self):
        file, logs = self.path / "suite", self.path / "logs"
        file.write_text("#!/bin/bash\nrm \"$0\"; printf 'Suite.\\n  First\\n'\n")
        file.chmod(0o755)
        logs.mkdir()
        results = run_tests.Results(logs)
        run_tests.run_gtests(results, [str(file)], 2)
        self.assertEqual(results.failed, 1)
        self.assertIn("FileNotFoundError", (logs / "results.tsv").read_text())

    def test_googletest_on_a_bus_of_its_own_is_not_shared_out(self):
        self.assertEqual(set(self.run_shared("suite_vcan").values()),
                         {("failed", "did not run (status 3)")})

    def test_the_report_for_catkin(self):
        report = self.path / "reports/three.xml"
        self.run_on("unittest", "three_test.py", UNITTEST, "--junit", report)
        suite = ElementTree.parse(report).getroot()
        self.assertEqual([suite.get(key) for key in ("tests", "failures", "errors")],
                         ["5", "4", "0"])
        self.assertEqual(dict(run_tests.xml_cases([report])), {
            "three_test.Three.test_good": None,
            "three_test.Three.test_unequal": "1 != 2 : one\n is not two",
            "three_test.Three.test_raises": "ValueError('x')",
            "three_test.Three.test_left_out": "did not run",
            "three_test.Three.test_parts": "a part",
        })

    def test_the_xml_of_rostest(self):
        report = self.path / "rosunit-x.xml"
        report.write_text('<testsuite><testcase classname="a.B" name="good"/>'
                          '<testcase classname="a.B" name="bad"><failure>1 != 2</failure></testcase>'
                          '<testcase classname="a.B" name="out"><skipped message="why"/></testcase>'
                          "</testsuite>")
        torn = self.path / "rosunit-torn.xml"
        torn.write_text("<testsuite><testcase")
        cases = list(run_tests.xml_cases([report, torn]))
        self.assertEqual(cases[:3], [("a.B.good", None), ("a.B.bad", "1 != 2"), ("a.B.out", "why")])
        self.assertEqual(cases[3][0], "rosunit-torn.xml is readable")
        self.assertIsNotNone(cases[3][1])


if __name__ == "__main__":
    unittest.main()
