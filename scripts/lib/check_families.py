#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Checks that no C++ asks for a drive family: what drives differ in is data, in config/.

Usage: check_families.py REPOSITORY

Looks for the names of the profiles in config/drives, and for the first word of each, in src/, include/
and examples/; comments may name a drive, and so may src/campaign/, which writes robots of given
profiles. `generic` names no family. Exit status 1 if there is such a name.
"""
import pathlib
import re
import sys

from check_text import TOKENS

SOURCES = ("src", "include", "examples")
EXEMPT = "src/campaign"


def names(repository):
    """Of the families, the longest first."""
    stems = {file.stem.lower() for file in (repository / "config/drives").glob("*.yaml")}
    found = {stem for stem in stems if not stem.startswith("generic")}
    return sorted(found | {stem.split("_")[0] for stem in found}, key=len, reverse=True)


def without_comments(source):
    """The same text with blanks for comments, line by line."""
    def blank(token):
        text = token[0]
        return re.sub(r"[^\n]", " ", text) if text.startswith(("//", "/*")) else text
    return TOKENS.sub(blank, source)


def main():
    repository = pathlib.Path(sys.argv[1])
    families = names(repository)
    if not families:
        print("config/drives has no profiles")
        return 1
    wanted = re.compile("|".join(re.escape(name) for name in families), re.IGNORECASE)
    found = 0
    for folder in SOURCES:
        for file in sorted((repository / folder).rglob("*")):
            path = file.relative_to(repository).as_posix()
            if not file.is_file() or path.startswith(EXEMPT + "/"):
                continue
            lines = without_comments(file.read_text(encoding="utf-8")).splitlines()
            for number, line in enumerate(lines, 1):
                for name in wanted.findall(line):
                    print(f"{path}:{number}: names a drive family: {name}")
                    found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
