#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy on the sources in src/ and benchmark/, as their compile_commands.json has them.

Usage: run_clang_tidy.py REPOSITORY BUILD_DIRECTORY CACHE_DIRECTORY
Files that passed are not checked again until they, a header of the repository they include, the
compiler's arguments, .clang-tidy or clang-tidy change. Many files of a target are checked as one, for
most of the time goes into the headers that they share: files that declare no name twice. Where that
finds something, or they do not go together, each half of them is, down to one file. Names that a source
declares by `using` or `namespace x =` and does not use are found here: clang-tidy sees them in a file
that is checked by itself only. Exit status 1 if a file fails.
"""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

BATCH = 32  # files
TARGET = re.compile(r"/([^/ ]+)\.dir/")
DECLARED = re.compile(r"^[ \t]*(?:using (?:\w+::)+(\w+);|namespace (\w+) = [\w:]+;).*$", re.MULTILINE)
# What a source declares for itself; a member of a class is no such name.
OWN = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
CONSTANTS = re.compile(r"^(?:inline |static )?const(?:expr)? [^;]*;", re.MULTILINE)
CONSTANT = re.compile(r"\b(k[A-Z]\w*)\s*[={\[(]")
TYPE = re.compile(r"^(?:(?:class|struct|enum class|enum) (\w+)\b(?!;)|using (\w+) = (?!.*::\2;))",
                  re.MULTILINE)
BORROWED = re.compile(r"^using (?:\w+ = )?(?:\w+::)+(\w+);", re.MULTILINE)
FUNCTION = re.compile(r"^[A-Za-z][\w:<>,&*\[\] ]*[ &*](\w+)\(", re.MULTILINE)
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
    digest = hashlib.sha256(version + " ".join(flags(command)).encode())
    for path in [repository / ".clang-tidy"] + sorted(files):
        digest.update(str(path.relative_to(repository)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def tidy(arguments):
    """Returns whether clang-tidy is content and what it says."""
    run = subprocess.run(["clang-tidy", "--quiet"] + arguments, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, text=True, check=False)
    said = run.stdout
    if run.returncode != 0 and not said.strip():
        said = run.stderr
    return run.returncode == 0, said


def flags(command):
    """The compiler's arguments that bear on what a source means."""
    words = shlex.split(command)
    kept = []
    for at, word in enumerate(words):
        if word in ("-isystem", "-include"):
            kept += words[at:at + 2]
        elif word.startswith(("-I", "-D", "-std=", "-W", "-f")):
            kept.append(word)
    return kept


def unused_names(source):
    """A line for each name that the source declares and does not use."""
    text = re.sub(r"//.*", "", source.read_text(encoding="utf-8"))
    said = ""
    for match in DECLARED.finditer(text):
        name = match.group(1) or match.group(2)
        if not re.search(rf"\b{name}\b", text[:match.start()] + text[match.end():]):
            said += f"{source}: `{name}` is declared ({match.group().strip()}) and not used\n"
    return said


def check(repository, cache, batch):
    """Returns [(source, passed, what clang-tidy says)] of a list of (source, command)."""
    unused = [(source, False, unused_names(source)) for source, _ in batch if unused_names(source)]
    if unused:
        return unused
    configuration = f"--config-file={repository / '.clang-tidy'}"
    if len(batch) == 1:
        ((source, command),) = batch
        return [(source,) + tidy([configuration, str(source), "--"] + flags(command))]
    one = cache / f"batch_{os.getpid()}_{abs(hash((batch[0][0], len(batch))))}.cpp"
    one.write_text("".join(f'#include "{source}"\n' for source, _ in batch))
    # A batch includes sources, which is what one of the checks is about.
    passed, _ = tidy([configuration, "--checks=-bugprone-suspicious-include", str(one), "--"] +
                     flags(batch[0][1]))
    one.unlink()
    if passed:
        return [(source, True, "") for source, _ in batch]
    half = len(batch) // 2
    return check(repository, cache, batch[:half]) + check(repository, cache, batch[half:])


def declared(source):
    """Names that no other file of its batch may declare, rather too many, and those that it has from
    another namespace, which each may have."""
    text = "".join(OWN.findall(source.read_text(encoding="utf-8")))
    text = re.sub(r"//.*", "", text)
    names = {name for found in CONSTANTS.findall(text) for name in CONSTANT.findall(found)}
    for either in TYPE.findall(text):
        names.update(filter(None, either))
    return names.union(FUNCTION.findall(text)), set(BORROWED.findall(text))


def batches(todo):
    """Lists of up to BATCH (source, command) of one target, that declare no name twice."""
    targets = {}
    for source, command in todo:
        match = TARGET.search(command)
        found = targets.setdefault(match.group(1) if match else str(source), [])
        names, borrowed = declared(source)
        for files, taken, lent in found:
            apart = not names & (taken | lent) and not borrowed & taken
            if len(files) < BATCH and apart:
                files.append((source, command))
                taken |= names
                lent |= borrowed
                break
        else:
            found.append(([(source, command)], names, borrowed))
    return [files for found in targets.values() for files, _, _ in found]


def compiled_by(file):
    """The sources behind a file of compile_commands.json: itself, or those that CMake joined in it."""
    if file.parent.name != "Unity":
        return [file.resolve()]
    joined = re.findall(r'^#include "(.+)"', file.read_text(encoding="utf-8"), re.MULTILINE)
    return [pathlib.Path(path).resolve() for path in joined]


def sources_to_check(repository, build):
    """(source, command) of every compiled file in the checked folders."""
    with open(build / "compile_commands.json", encoding="utf-8") as file:
        for entry in json.load(file):
            for source in compiled_by(pathlib.Path(entry["file"])):
                if (repository / "src") in source.parents or \
                        (repository / "benchmark") in source.parents:
                    yield source, entry["command"]


def main():
    repository, build, cache = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
    cache.mkdir(parents=True, exist_ok=True)
    for left_over in cache.glob("batch_*.cpp"):  # of a run that was ended
        left_over.unlink()
    version = subprocess.run(["clang-tidy", "--version"], stdout=subprocess.PIPE, check=True).stdout
    todo, marks = [], {}
    for source, command in sources_to_check(repository, build):
        marks[source] = cache / fingerprint(repository, source, command, version)
        if not marks[source].exists():
            todo.append((source, command))
    print(f"{len(marks)} files, {len(todo)} to check")
    if not marks:
        print("nothing to check: is the build directory right?")
        return 1
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        running = [pool.submit(check, repository, cache, batch) for batch in batches(todo)]
        for ended in concurrent.futures.as_completed(running):
            for source, passed, said in ended.result():
                if passed:
                    marks[source].touch()
                else:
                    failed += 1
                    print(said, flush=True)
    print(f"{failed} files with findings")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
