#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy on the sources in src/ and benchmark/, as their compile_commands.json has them.

Usage: run_clang_tidy.py REPOSITORY BUILD_DIRECTORY CACHE_DIRECTORY
Files that passed are not checked again until they, a header of the repository they include, the
compiler's arguments, .clang-tidy or clang-tidy change. Exit status 1 if a file fails.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

INCLUDE = re.compile(rb'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def own_files(repository, source, known):
    """The source and the headers of the repository it includes, directly or not."""
    if source in known:
        return
    known.add(source)
    for name in INCLUDE.findall(source.read_bytes()):
        for base in (source.parent, repository / "include", repository / "src"):
            header = base / name.decode()
            if header.is_file():
                own_files(repository, header.resolve(), known)
                break


def fingerprint(repository, source, command, version):
    files = set()
    own_files(repository, source, files)
    digest = hashlib.sha256(version + command.encode())
    for path in [repository / ".clang-tidy"] + sorted(files):
        digest.update(str(path.relative_to(repository)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def check(build, source):
    """Returns whether the file passes and what clang-tidy says."""
    run = subprocess.run(["clang-tidy", "--quiet", "-p", str(build), str(source)],
                         stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    said = run.stdout
    if run.returncode != 0 and not said.strip():
        said = run.stderr
    return run.returncode == 0, said


def sources_to_check(repository, build):
    """(source, command) of every compiled file in the checked folders."""
    with open(build / "compile_commands.json", encoding="utf-8") as file:
        for entry in json.load(file):
            source = pathlib.Path(entry["file"]).resolve()
            if (repository / "src") in source.parents or \
                    (repository / "benchmark") in source.parents:
                yield source, entry["command"]


def main():
    repository, build, cache = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    cache.mkdir(parents=True, exist_ok=True)
    version = subprocess.run(["clang-tidy", "--version"], stdout=subprocess.PIPE, check=True).stdout
    todo, marks = [], {}
    for source, command in sources_to_check(repository, build):
        marks[source] = cache / fingerprint(repository, source, command, version)
        if not marks[source].exists():
            todo.append(source)
    print(f"{len(marks)} files, {len(todo)} to check")
    if not marks:
        print("nothing to check: is the build directory right?")
        return 1
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for source, (passed, said) in zip(todo, pool.map(lambda file: check(build, file), todo)):
            if passed:
                marks[source].touch()
            else:
                failed += 1
                print(said, flush=True)
    print(f"{failed} files with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
