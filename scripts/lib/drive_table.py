#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Writes the tables of docs/drives/README.md from test results.

Usage: drive_table.py REPOSITORY RESULTS [--check]

REPOSITORY holds config/drives/*.yaml and docs/drives/: tests.yaml, which tests show a mode or a
homing method, and for each family a document with its checklist. RESULTS is a results.tsv of
run_tests.py. With --check nothing is written. Exit status 1 if something is wrong, with a line each.
"""
import itertools
import pathlib
import sys

import yaml

from drive_evidence import SHORT, STATES, Checklist, Results, families

MARKER = "<!-- Below this line: written by scripts/drive_table. -->\n"


def table(head, rows):
    lines = ["| " + " | ".join(str(cell) for cell in row) + " |\n" for row in (head, *rows)]
    return lines[0] + "|---" * len(head) + "|\n" + "".join(lines[1:])


def share(family, items):
    return f"{sum(bool(family.shown[item]) for item in items)} of {len(items)}"


def tests_of(family, items):
    names = sorted(set().union(*(family.shown[item] for item in items)))
    return ", ".join(f"`{name}`" for name in names) or "open"


def overview(known, checklists):
    for family in known:
        checklist = checklists.get(family.name)
        title = f"[{checklist.title}]({family.name}.md)" if checklist else family.description
        counts = [checklist.counts[state] for state in STATES] if checklist else ["–"] * len(STATES)
        yield [title, f"[{family.name}](../../config/drives/{family.name}.yaml)",
               share(family, family.modes), share(family, family.methods), *counts]


def methods(known):
    """A row for each homing method, a column for each family."""
    for method in sorted(set().union(*(family.methods for family in known)),
                         key=lambda method: (isinstance(method, str), method)):
        cells = ["–" if method not in family.methods else
                 len(family.starts[method]) or "open" for family in known]
        yield [method, *cells]


def generated(known, checklists):
    """What follows the marker."""
    parts = ["\n## Families\n\n",
             table(["family", "profile", "modes shown", "homing methods shown",
                    *(f"items {state}" for state in STATES)], overview(known, checklists)),
             "\n## Modes\n"]
    for family in known:
        title = checklists[family.name].title if family.name in checklists else family.description
        rows = [[f"`{mode}` ({SHORT[mode]})" if mode in SHORT else f"`{mode}`", value,
                 tests_of(family, [mode])] for mode, value in family.modes.items()]
        parts += [f"\n### {title}\n\n", table(["mode", "6060h", "shown by"], rows)]
    parts += ["\n## Homing methods\n\n",
              "A dash: not among those of the profile. `declare_zero`: a person declares the position.\n",
              "Shown by a robot that found the home which the method names, from as many starts (before the "
              "switch,\non it, behind it, with a limit switch first) as the number says, in\n\n",
              table(["profile", "tests"], ([family.name, tests_of(family, family.methods)]
                                           for family in known)), "\n",
              table(["method", *(family.name for family in known)], methods(known))]
    return "".join(parts)


def difference(old, new):
    """The first line that differs, in words."""
    lines = itertools.zip_longest(old.splitlines(), new.splitlines(), fillvalue="nothing")
    for number, (is_there, should_be) in enumerate(lines, 1):
        if is_there != should_be:
            return f"line {number} is\n  {is_there}\nand not\n  {should_be}\nrun scripts/drive_table"
    return "the ends differ; run scripts/drive_table"


def main():
    repository, file, check = (pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]),
                               "--check" in sys.argv[3:])
    documents, problems = repository / "docs/drives", []
    results = Results(file)
    if not results:
        problems.append(f"{file}: no C++ test has run")
    rules = yaml.safe_load((documents / "tests.yaml").read_text(encoding="utf-8"))
    known = families(repository / "config/drives", rules, results, problems)
    checklists = {document.stem: Checklist(document, results, problems)
                  for document in sorted(documents.glob("*.md")) if document.stem != "README"}
    problems += [f"{name}.md: there is no such profile"
                 for name in set(checklists) - {family.name for family in known}]

    readme = documents / "README.md"
    old = readme.read_text(encoding="utf-8")
    if MARKER not in old:
        problems.append(f"README.md: lacks the line {MARKER.strip()}")
    new = old.partition(MARKER)[0] + MARKER + generated(known, checklists)
    if not problems and check and old != new:
        problems.append(f"README.md: {difference(old, new)}")
    elif not problems and old != new:
        readme.write_text(new, encoding="utf-8")
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
