#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Runs tests of three kinds and notes every single case in one file of results.

Usage: run_tests.py [--junit REPORT] gtest    LOGS EXECUTABLE...
       run_tests.py [--junit REPORT] unittest LOGS FILE.py...
       run_tests.py [--junit REPORT] rostest  LOGS FILE.test...

Appends to LOGS/results.tsv a line per case: passed or failed, name, log file, and what was said of
a failure, cut short. A case that did not run (crash, time-out, skipped, disabled) has failed. Exit
status 1 if any case failed. With --junit the cases of this run are written to REPORT, too, as
catkin wants to read them.
"""
import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import threading
import traceback
import unittest
import xml.etree.ElementTree as ElementTree

GTEST_TIMEOUT_S = 1800  # under sanitizers, on a machine that has other work
ROSTEST_TIMEOUT_S = 900


class Results:
    """The file of results; a line is written as soon as its test has ended."""

    def __init__(self, logs):
        self.logs = logs
        self.failed = 0
        self._cases = []  # (name, why it failed or None)

    def note(self, name, log, why=None):
        """@param why what was said of the failure, or None: passed."""
        self.failed += why is not None
        self._cases.append((name, why))
        words = " ".join((why or "").split())[:300]
        with open(self.logs / "results.tsv", "a", encoding="utf-8") as file:
            file.write(f"{'passed' if why is None else 'failed'}\t{name}\t{log}\t{words}\n")

    def write_junit(self, report):
        """All cases so far as JUnit XML."""
        suite = ElementTree.Element("testsuite", name=report.stem, tests=str(len(self._cases)),
                                    failures=str(self.failed), errors="0")
        for name, why in self._cases:
            suite_name, _, case_name = name.rpartition(".")
            case = ElementTree.SubElement(suite, "testcase", classname=suite_name, name=case_name)
            if why is not None:
                # XML 1.0 has no control characters, not even as references.
                ElementTree.SubElement(case, "failure").text = "".join(
                    c if c in "\n\t" or c >= " " else "?" for c in why)
        report.parent.mkdir(parents=True, exist_ok=True)
        ElementTree.ElementTree(suite).write(report, encoding="utf-8", xml_declaration=True)


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


def outcomes_in(report):
    """{case: why it failed, or None} of what a JSON report of GoogleTest says has run."""
    try:
        suites = json.loads(report.read_text(encoding="utf-8"))["testsuites"]
    except (OSError, ValueError):
        return {}  # crashed before writing it
    return {f"{suite['name']}.{case['name']}":
            " ".join(failure["failure"] for failure in case["failures"])
            if case.get("failures") else None
            for suite in suites for case in suite["testsuite"]
            if case.get("result") == "COMPLETED"}


class GoogleTest:
    """An executable, whose cases are dealt out to several processes: each runs a share of them."""

    def __init__(self, results, executable, shares):
        self.results, self.executable, self.shares = results, executable, shares
        self.name = pathlib.Path(executable).name
        self.log = results.logs / f"{self.name}.log"
        self.log.write_bytes(b"")
        self.outcomes, self.statuses = {}, []
        self._lock = threading.Lock()
        try:
            self.cases = cases_in(executable)
        except (OSError, subprocess.SubprocessError) as error:
            self.log.write_text(f"cannot list the tests: {error}\n", encoding="utf-8")
            self.cases = []
        if not self.cases:
            self.results.note(f"{self.name}: has tests", self.log, "none found")

    def run(self, share):
        """Runs a share. With the last one it is noted what has become of all cases."""
        report = self.results.logs / f"{self.name}.{share}.json"
        report.unlink(missing_ok=True)
        shards = {"GTEST_TOTAL_SHARDS": str(self.shares), "GTEST_SHARD_INDEX": str(share)}
        try:
            status = run([self.executable, "--gtest_brief=1", f"--gtest_output=json:{report}"],
                         self.log, GTEST_TIMEOUT_S, cwd=self.results.logs,
                         env={**os.environ, **shards})
        except OSError as error:
            status = repr(error)
        with self._lock:
            self.outcomes.update(outcomes_in(report))
            self.statuses.append(status)
            if len(self.statuses) == self.shares:
                self.note()

    def note(self):
        bad = next((status for status in self.statuses if status != 0), 0)
        reasons = [self.outcomes.get(case, f"did not run (status {bad})") for case in self.cases]
        for case, why in zip(self.cases, reasons):
            self.results.note(f"{self.name}: {case}", self.log, why)
        if bad != 0 and all(why is None for why in reasons):
            self.results.note(f"{self.name}: ends with status 0", self.log, f"ended with {bad}")


def run_gtests(results, executables, processors):
    """Their cases take very different times: each executable is shared out to all processors."""
    with concurrent.futures.ThreadPoolExecutor(processors) as pool:
        running = []
        for executable in executables:
            alone = executable.endswith("_vcan")  # one bus for all
            test = GoogleTest(results, executable, 1 if alone else processors)
            running += [pool.submit(test.run, share) for share in range(test.shares) if test.cases]
        for share in running:
            share.result()


# Python's unittest

class Recorder(unittest.TextTestResult):
    """Notes the outcome of every case of a unittest; the text goes to the log as usual."""

    def startTestRun(self):
        super().startTestRun()
        self.outcomes = {}

    def addSuccess(self, test):
        super().addSuccess(test)
        self.outcomes.setdefault(test.id(), None)

    def addFailure(self, test, err):
        super().addFailure(test, err)
        self.outcomes[test.id()] = str(err[1])

    def addError(self, test, err):
        super().addError(test, err)
        self.outcomes[test.id()] = repr(err[1])

    def addSubTest(self, test, subtest, err):
        super().addSubTest(test, subtest, err)
        if err is not None:
            self.outcomes[test.id()] = str(err[1])


def run_unittest(results, file):
    path = pathlib.Path(file)
    log = results.logs / f"{path.stem}.log"
    sys.path.insert(0, str(path.parent))
    suite = unittest.defaultTestLoader.loadTestsFromName(path.stem)
    cases = [test.id() for group in suite for test in
             (group if isinstance(group, unittest.TestSuite) else [group])]
    with open(log, "w", encoding="utf-8") as stream:
        run_of = unittest.TextTestRunner(stream, verbosity=2, resultclass=Recorder).run(suite)
    for case in cases:
        results.note(case, log, run_of.outcomes.get(case, "did not run"))
    if not cases:
        results.note(f"{path.stem}: has tests", log, "none found")


# rostest

def xml_cases(files):
    """(name, why it failed or None) of every case in JUnit XML files."""
    for file in files:
        try:
            root = ElementTree.parse(file).getroot()
        except ElementTree.ParseError as error:
            yield f"{file.name} is readable", str(error)
            continue
        for case in root.iter("testcase"):
            bad = [part.text or part.get("message") or part.tag
                   for part in case if part.tag in ("failure", "error", "skipped")]
            yield f"{case.get('classname', '')}.{case.get('name')}", " ".join(bad) if bad else None


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
    for case, why in cases:
        results.note(f"{name}: {case}", log, why)
    if all(why is None for _, why in cases):
        for node, why in nodes:
            if why is not None:
                results.note(f"{name}: {node}", log, why)
    if not nodes or (not cases and all(why is None for _, why in nodes)):
        results.note(f"{name}: reports its tests", log, f"status {status}")


def run_file(kind, results, file):
    """Runs one file of tests. Whatever goes wrong in doing so is a failure of its own."""
    try:
        {"unittest": run_unittest, "rostest": run_rostest}[kind](results, file)
    except Exception as error:  # pylint: disable=broad-except
        log = results.logs / f"{pathlib.Path(file).stem}.error.log"
        log.write_text(traceback.format_exc(), encoding="utf-8")
        results.note(f"{pathlib.Path(file).name}: runs", log, repr(error))


def main():
    arguments = sys.argv[1:]
    report = None
    if arguments[0] == "--junit":
        report, arguments = pathlib.Path(arguments[1]).resolve(), arguments[2:]
    kind, logs, files = arguments[0], pathlib.Path(arguments[1]).resolve(), arguments[2:]
    logs.mkdir(parents=True, exist_ok=True)
    results = Results(logs)
    if kind == "gtest":
        run_gtests(results, files, os.cpu_count() or 1)
    else:
        for file in files:
            run_file(kind, results, file)
    if report is not None:
        results.write_junit(report)
    return 1 if results.failed else 0


if __name__ == "__main__":
    sys.exit(main())
