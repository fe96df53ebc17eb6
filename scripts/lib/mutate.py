#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Breaks lines of a copy of the sources, one at a time, and tells which test sees it.

See scripts/mutate --help. Several are judged at once, each in a copy and a build of its own,
DIRECTORY/N/tree and DIRECTORY/N/tree/build; ccache knows what was built in another one.
"""
import argparse
import fcntl
import hashlib
import json
import multiprocessing
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import mutations
import switches

COPIED = ("cmake", "config", "docs", "examples", "fuzz", "include", "src", "test")
FILES = ("CMakeLists.txt", "README.md")
MODULES = ("drive", "motion", "canopen", "bus", "config")
MALFORMED, SAME = "does not compile", "the compiler makes the same program of it"
MEMORY = 4 << 30  # bytes, for a test that a mutation lets allocate for ever


def files_in(folder):
    return {path.relative_to(folder) for path in folder.rglob("*")
            if path.is_file() and "__pycache__" not in path.parts}


def synchronise(repository, tree):
    """Makes the copy what the repository is; what is the same keeps its time, for the build."""
    for folder in COPIED:
        wanted = files_in(repository / folder)
        for file in files_in(tree / folder) - wanted:
            (tree / folder / file).unlink()
        for file in wanted:
            copy(repository / folder / file, tree / folder / file)
    for file in FILES:
        copy(repository / file, tree / file)


def copy(source, target):
    if target.exists() and source.read_bytes() == target.read_bytes():
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)


class Build:
    """The copy of the sources, and what is built of it."""

    def __init__(self, directory, jobs, flags="-O2 -DNDEBUG"):
        self.directory = directory
        self.jobs = jobs
        self._flags = flags
        self.tree = directory / "tree"
        self.build = self.tree / "build"

    def configure(self):
        self.build.mkdir(parents=True, exist_ok=True)
        return self._log(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja",
                          "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                          f"-DCMAKE_CXX_FLAGS_RELWITHDEBINFO={self._flags}",
                          "-DCMAKE_EXE_LINKER_FLAGS=-s -Wl,--build-id=none",
                          "-DCIA402_UNITY_BUILD=TESTS", "-DCIA402_WITH_ROS=OFF"])

    def make(self, target):
        """@return whether the target could be built."""
        return self._log(["cmake", "--build", self.build, "--target", target, "--parallel",
                          self.jobs])

    def tests(self):
        names = [pathlib.Path(line).name for line in
                 (self.build / "tests.txt").read_text(encoding="utf-8").split()]
        return [name for name in names if not name.endswith("_vcan")]

    def digest(self, test):
        path = self.build / test
        return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else ""

    def _log(self, command):
        environment = dict(os.environ, CCACHE_BASEDIR=str(self.tree))
        return run([str(part) for part in command], self.directory / "build.log", None,
                   env=environment) == 0


def run(command, log, limit, **options):
    """Runs a command with its output in a log. Whatever it has started ends with it, also when this
    program is asked to end: a compiler that goes on would find a file that was put back.
    @return exit status; None: it has not ended in time."""
    with open(log, "wb") as file:
        process = subprocess.Popen(command, stdout=file, stderr=subprocess.STDOUT,
                                   stdin=subprocess.DEVNULL, start_new_session=True, **options)
        try:
            return process.wait(limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            try:
                os.killpg(process.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
            process.wait()


def run_test(executable, log, limit, **environment):
    """Runs a GoogleTest executable up to its first failure. @return why it failed, or None."""
    def bound():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    directory = log.parent / "run"
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    status = run([executable, "--gtest_brief=1", "--gtest_fail_fast"], log, limit, cwd=directory,
                 preexec_fn=bound, env=dict(os.environ, **environment))
    if status is None:
        return f"not ended after {limit:.0f} s"
    if status == 0:
        return None
    failed = re.search(r"\[  FAILED  \] (\S+)", log.read_text(encoding="utf-8", errors="replace"))
    return failed.group(1).rstrip(",") if failed else f"status {status}"


class Trial:
    """Judges mutations by the tests of a build."""

    def __init__(self, build, say):
        self._build = build
        self._say = say
        self._seconds = {}
        self._unbroken = {}  # digests

    def prepare(self, like=None):
        """Builds all tests unbroken and runs them: how long each takes. @param like a trial that knows
        that already. @return a problem, or None."""
        if not self._build.configure():
            return f"cmake failed, see {self._build.directory}/build.log"
        self._say("building what is not broken")
        if not self._build.make("cia402_tests"):
            return f"the tests cannot be built, see {self._build.directory}/build.log"
        self._unbroken = {test: self._build.digest(test) for test in self._build.tests()}
        if like:
            self._seconds = like._seconds  # pylint: disable=protected-access
            return None
        memory = self._build.directory / "durations.json"
        known = json.loads(memory.read_text(encoding="utf-8")) if memory.exists() else {}
        for test, digest in self._unbroken.items():
            self._say(f"running {test}, with nothing broken")
            if known.get(test, [""])[0] != digest:
                began = time.monotonic()
                why = run_test(self._build.build / test, self._build.directory / "test.log", 3600)
                if why is not None:
                    return f"{test} fails though nothing is broken: {why}"
                known[test] = [digest, time.monotonic() - began]
                memory.write_text(json.dumps(known), encoding="utf-8")
            self._seconds[test] = known[test][1]
        return None

    def judge(self, mutation):
        """@return "seen by ...", "survived", or why it is none: MALFORMED, SAME."""
        path = self._build.tree / mutation.file
        text = path.read_text(encoding="utf-8")
        try:
            path.write_text(mutations.broken(text, mutation), encoding="utf-8")
            return self._run(mutation)
        finally:
            path.write_text(text, encoding="utf-8")

    def _run(self, mutation):
        own = own_test(mutation)
        others = sorted(self._seconds, key=self._seconds.get)
        verdict = SAME
        for test in sorted(others, key=lambda name: name != own):
            if not self._build.make(test):
                return MALFORMED
            if self._build.digest(test) == self._unbroken[test]:
                continue  # the line is not in it
            why = run_test(self._build.build / test, self._build.directory / "test.log",
                           60.0 + 5.0 * self._seconds[test])
            if why is not None:
                return f"seen by {test}: {why}"
            verdict = "survived"
        return verdict


def own_test(mutation):
    return "test_" + pathlib.PurePath(mutation.file).parts[1]


class SwitchedTrial:
    """Judges mutations that are all in one build, by the tests of their modules alone."""

    def __init__(self, build, directory):
        self._build, self._log = build, directory / "test.log"
        self._seconds = {}
        directory.mkdir(parents=True, exist_ok=True)

    def prepare(self, tests):
        for test in tests:
            began = time.monotonic()
            why = run_test(self._build.build / test, self._log, 3600)
            if why is not None:
                return f"{test} fails though nothing is broken: {why}"
            self._seconds[test] = time.monotonic() - began
        return None

    def judge(self, switch):
        number, mutation = switch
        test = own_test(mutation)
        why = run_test(self._build.build / test, self._log, 5.0 + 5.0 * self._seconds[test],
                       **{switches.VARIABLE: str(number)})
        return "survived" if why is None else f"seen by {test}: {why}"


def switched(options, folders, say):
    """Builds with all switches in place. @return [(number, mutation)] in the drawn order, trials."""
    build = Build(options.build / "switched", options.jobs,
                  f"-O1 -DNDEBUG -include {options.build / 'switched' / 'tree' / 'mistake.h'}")
    build.tree.mkdir(parents=True, exist_ok=True)
    synchronise(options.repository, build.tree)
    put = switches.Switches(options.repository, build)
    put.put(folders, options.seed)
    if not build.configure():
        sys.exit(f"mutate: cmake failed, see {build.directory}/build.log")
    say(f"looking which of {len(put.mutations)} switches compile")
    problem = put.take_away_malformed(options.jobs)
    if problem:
        sys.exit(f"mutate: what is broken does not compile:\n{problem}")
    tests = sorted({own_test(mutation) for mutation in put.mutations.values()})
    say(f"building {len(put.mutations)} switches")
    if not all(build.make(test) for test in tests):
        sys.exit(f"mutate: the tests cannot be built, see {build.directory}/build.log")
    trials = [SwitchedTrial(build, build.directory / f"run{i}") for i in range(options.jobs)]
    for trial in trials:
        problem = trial.prepare(tests)
        if problem:
            sys.exit(f"mutate: {problem}")
    numbers = {id(mutation): number for number, mutation in put.mutations.items()}
    drawn = mutations.drawn(put.mutations.values(), options.seed)
    return [(numbers[id(mutation)], mutation) for mutation in drawn], trials


def all_mutations(repository, folders):
    found = []
    for folder in folders:
        for path in mutations.sources(repository / folder):
            found += mutations.mutations_of(str(path.relative_to(repository)),
                                            path.read_text(encoding="utf-8"))
    return found


def at(place, repository):
    """All mutations of one line. @param place "src/drive/axis.cpp:120"."""
    file, _, line = place.rpartition(":")
    text = (repository / file).read_text(encoding="utf-8")
    return [mutation for mutation in mutations.mutations_of(file, text)
            if mutation.line == int(line)]


def work(trial, tasks, verdicts):
    """A process that judges: (number, mutation) to (number, verdict), or what kept it from that."""
    for number, mutation in iter(tasks.get, None):
        try:
            verdicts.put((number, trial.judge(mutation)))
        except Exception as error:  # pylint: disable=broad-exception-caught
            verdicts.put((number, error))


def judged(chosen, trials, count):
    """Judges mutations until `count` have changed the program, as many at once as there are trials.
    Yields (mutation, verdict) of all in their order."""
    tasks, verdicts = multiprocessing.SimpleQueue(), multiprocessing.SimpleQueue()
    crew = [multiprocessing.Process(target=work, args=(trial, tasks, verdicts), daemon=True)
            for trial in trials]
    for one in crew:
        one.start()
    try:
        yield from in_order(chosen, tasks.put, verdicts.get, 8 * len(crew), count)
    finally:
        for one in crew:
            one.terminate()
        for one in crew:
            one.join()


def in_order(chosen, put, get, ahead, count):
    """Puts up to `ahead` mutations more than were yielded, each with its number, and gets their
    verdicts in any order."""
    chosen = iter(chosen)
    under_way, known, number, done = {}, {}, 0, 0
    while done < count:
        while len(under_way) < ahead:
            mutation = next(chosen, None)
            if mutation is None:
                break
            under_way[number + len(under_way)] = mutation
            put((number + len(under_way) - 1, mutation))
        if not under_way:
            return
        while number not in known:
            other, verdict = get()
            if isinstance(verdict, Exception):
                raise verdict
            known[other] = verdict
        verdict = known.pop(number)
        done += verdict not in (MALFORMED, SAME)
        yield under_way.pop(number), verdict
        number += 1


def summary(verdicts):
    """@param verdicts of all that were drawn."""
    judged = [verdict for verdict in verdicts if verdict not in (MALFORMED, SAME)]
    seen = sum(verdict != "survived" for verdict in judged)
    return (f"{len(judged)} lines broken, {seen} seen, {len(judged) - seen} survived; drawn anew: "
            f"{verdicts.count(MALFORMED)} that did not compile, {verdicts.count(SAME)} of which the "
            f"compiler made the same program")


def arguments(words):
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("--repository", type=pathlib.Path, required=True)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--dir", nargs="+", default=[f"src/{module}" for module in MODULES])
    parser.add_argument("--at", action="append", default=[])
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--switched", action="store_true")
    return parser.parse_args(words)


def trials_of(options, count, say):
    """As many as may be judged at once."""
    trials = []
    for number in range(min(options.jobs, count)):
        build = Build(options.build / str(number + 1), options.jobs)
        build.tree.mkdir(parents=True, exist_ok=True)
        synchronise(options.repository, build.tree)
        trial = Trial(build, say)
        problem = trial.prepare(like=trials[0] if trials else None)
        if problem:
            sys.exit(f"mutate: {problem}")
        build.jobs = 1
        trials.append(trial)
    return trials


def main():
    options = arguments(sys.argv[1:])
    repository = options.repository
    folders = [folder.rstrip("/") for folder in options.dir]
    if options.at and options.switched:
        sys.exit("mutate: --at and --switched do not go together")
    if options.at:
        chosen = [mutation for place in options.at for mutation in at(place, repository)]
        head, count = "", len(chosen)
    else:
        chosen = list(mutations.drawn(all_mutations(repository, folders), options.seed))
        head, count = f"seed {options.seed}: ", options.count
    if not chosen:
        sys.exit("mutate: there is no line to break")
    if options.list:
        for mutation in chosen[:count]:
            print(mutation)
        return

    def say(text):
        print(f"== {text}", file=sys.stderr, flush=True)
    options.build.mkdir(parents=True, exist_ok=True)
    lock = open(options.build / "lock", "w", encoding="utf-8")  # until the end
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        sys.exit(f"mutate: another one works in {options.build}; wait for its end")
    if options.switched:
        chosen, trials = switched(options, folders, say)
    else:
        trials = trials_of(options, count, say)
    verdicts = []
    for mutation, verdict in judged(chosen, trials, count):
        verdicts.append(verdict)
        print(f"{head}{mutation[1] if options.switched else mutation}: {verdict}", flush=True)
    print(f"{head}{summary(verdicts)}")


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the copy is put right all the same
    main()
