#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Runs tests of three kinds and notes every single case in one file of results.

Usage: run_tests.py gtest    LOGS EXECUTABLE...
       run_tests.py unittest LOGS FILE.py...
       run_tests.py rostest  LOGS FILE.test...

Appends to LOGS/results.tsv a line per case: passed or failed, name, log file. A case that did not
run (crash, time-out, skipped, disabled) has failed. Exit status 1 if any case failed.
"""
import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import traceback
import unittest
import xml.etree.ElementTree as ElementTree

GTEST_TIMEOUT_S = 900
ROSTEST_TIMEOUT_S = 900


class Results:
    """The file of results; a line is written as soon as its test has ended."""

    def __init__(self, logs):
        self.logs = logs
        self.failed = 0

    def note(self, passed, name, log):
        self.failed += not passed
        with open(self.logs / "results.tsv", "a", encoding="utf-8") as file:
            file.write(f"{'passed' if passed else 'failed'}\t{name}\t{log}\n")


def interrupt(process):
    """Asks a process to end what it has started and itself, as Ctrl-C does."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(20)
    except subprocess.TimeoutExpired:
        pass  # run() kills it


def run(command, log, timeout, **options):
    """Runs a command with its output in a log. Whatever it has started ends with it."""
    with open(log, "ab") as file:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file,
                                   stderr=subprocess.STDOUT, start_new_session=True, **options)
        try:
            status = process.wait(timeout)
        except subprocess.TimeoutExpired:
            file.write(f"\nkilled after {timeout} s\n".encode())
            interrupt(process)
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()
        if status != 0:
            file.write(f"\nended with status {status}\n".encode())
    return status


# GoogleTest

def cases_in(executable):
    """Names of all cases of a GoogleTest executable, as "Suite.Case"."""
    listing = subprocess.run([executable, "--gtest_list_tests"], stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL, text=True,
                             timeout=60, check=True).stdout
    cases, suite = [], ""
    for line in listing.splitlines():
        name = line.split("#", 1)[0].rstrip()
        if not name or name.startswith("Running main()"):
            continue
        if name.startswith(" "):
            cases.append(suite + name.strip())
        else:
            suite = name
    return cases


def passed_cases(report):
    """Names of the cases that a JSON report of GoogleTest says have run and passed."""
    try:
        suites = json.loads(report.read_text(encoding="utf-8"))["testsuites"]
    except (OSError, ValueError):
        return set()  # crashed before writing it
    return {f"{suite['name']}.{case['name']}" for suite in suites for case in suite["testsuite"]
            if case.get("result") == "COMPLETED" and not case.get("failures")}


def run_gtest(results, executable):
    name = pathlib.Path(executable).name
    log = results.logs / f"{name}.log"
    report = results.logs / f"{name}.json"
    log.write_bytes(b"")
    report.unlink(missing_ok=True)
    try:
        cases = cases_in(executable)
    except (OSError, subprocess.SubprocessError) as error:
        log.write_text(f"cannot list the tests: {error}\n", encoding="utf-8")
        cases = []
    if not cases:
        results.note(False, f"{name}: has tests", log)
        return
    status = run([executable, "--gtest_brief=1", f"--gtest_output=json:{report}"], log,
                 GTEST_TIMEOUT_S, cwd=results.logs)
    passed = passed_cases(report)
    for case in cases:
        results.note(case in passed, f"{name}: {case}", log)
    if status != 0 and all(case in passed for case in cases):
        results.note(False, f"{name}: ends with status 0, not {status}", log)


# Python's unittest

class Recorder(unittest.TextTestResult):
    """Notes every case of a unittest; the text goes to the log as usual."""

    def startTestRun(self):
        super().startTestRun()
        self.passed = []

    def addSuccess(self, test):
        super().addSuccess(test)
        self.passed.append(test.id())


def run_unittest(results, file):
    path = pathlib.Path(file)
    log = results.logs / f"{path.stem}.log"
    sys.path.insert(0, str(path.parent))
    suite = unittest.defaultTestLoader.loadTestsFromName(path.stem)
    cases = [test.id() for group in suite for test in
             (group if isinstance(group, unittest.TestSuite) else [group])]
    with open(log, "w", encoding="utf-8") as stream:
        outcome = unittest.TextTestRunner(stream, verbosity=2, resultclass=Recorder).run(suite)
    for case in cases:
        results.note(case in outcome.passed, case, log)
    if not cases:
        results.note(False, f"{path.stem}: has tests", log)


# rostest

def xml_cases(files):
    """(name, passed) of every case in JUnit XML files."""
    for file in files:
        try:
            root = ElementTree.parse(file).getroot()
        except ElementTree.ParseError:
            yield f"{file.name} is readable", False
            continue
        for case in root.iter("testcase"):
            bad = any(case.find(tag) is not None for tag in ("failure", "error", "skipped"))
            yield f"{case.get('classname', '')}.{case.get('name')}", not bad


def run_rostest(results, file):
    path = pathlib.Path(file).resolve()
    name = f"{path.parent.name}/{path.stem}"
    log = results.logs / f"{name.replace('/', '_')}.log"
    directory = results.logs / "rostest" / name
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    log.write_bytes(b"")
    status = run(["rostest", "--results-base-dir", str(directory), str(path)], log,
                 ROSTEST_TIMEOUT_S)
    # rosunit-*.xml: the cases of each test node. rostest-*.xml: one case per test node, which
    # fails, too, when the node died before it could report.
    cases = list(xml_cases(sorted(directory.rglob("rosunit-*.xml"))))
    nodes = list(xml_cases(sorted(directory.rglob("rostest-*.xml"))))
    for case, passed in cases:
        results.note(passed, f"{name}: {case}", log)
    if all(passed for _, passed in cases):
        for node, passed in nodes:
            if not passed:
                results.note(False, f"{name}: {node}", log)
    if not nodes or (not cases and all(passed for _, passed in nodes)):
        results.note(False, f"{name}: reports its tests (status {status})", log)


def run_file(kind, results, file):
    """Runs one file of tests. Whatever goes wrong in doing so is a failure of its own."""
    try:
        {"gtest": run_gtest, "unittest": run_unittest, "rostest": run_rostest}[kind](results, file)
    except Exception:  # pylint: disable=broad-except
        log = results.logs / f"{pathlib.Path(file).stem}.error.log"
        log.write_text(traceback.format_exc(), encoding="utf-8")
        results.note(False, f"{pathlib.Path(file).name}: runs", log)


def main():
    kind, logs, files = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    logs.mkdir(parents=True, exist_ok=True)
    results = Results(logs)
    # Nodes of a ROS graph need the processors for themselves.
    at_once = os.cpu_count() if kind == "gtest" else 1
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        list(pool.map(lambda file: run_file(kind, results, file), files))
    return 1 if results.failed else 0


if __name__ == "__main__":
    sys.exit(main())
