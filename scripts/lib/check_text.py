#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Checks that what the nodes say is ASCII: the tools of ROS print other characters as `??`.

Usage: check_text.py REPOSITORY

Looks at the string literals of src/ and include/, and at every character of what is read or handed
out as it stands: config/, launch/, msg/, srv/ and action/. Exit status 1 if there is another one.
"""
import pathlib
import re
import sys

SOURCES = ("src", "include")
WHOLE = ("config", "launch", "msg", "srv", "action")

# What can hold a quote: comments, then literals; the first that begins counts.
TOKENS = re.compile(r'''
    //[^\n]*
  | /\*.*?\*/
  | R"(?P<end>[^()\\\s]*)\((?P<raw>.*?)\)(?P=end)"
  | "(?P<text>(?:\\.|[^"\\\n])*)"
  | (?<=[0-9])'(?=[0-9])  # of digits
  | '(?:\\.|[^'\\\n])+'
''', re.VERBOSE | re.DOTALL)


def literals(source):
    """(offset, text) of every string literal of a C++ file."""
    for token in TOKENS.finditer(source):
        for group in ("raw", "text"):
            if token[group] is not None:
                yield token.start(group), token[group]


def strangers(file, whole):
    """(line, text) of every literal, or every line of a file, that is not ASCII."""
    source = file.read_text(encoding="utf-8")
    if whole:
        return [(number, line.strip()) for number, line in enumerate(source.splitlines(), 1)
                if not line.isascii()]
    return [(source.count("\n", 0, offset) + 1, text) for offset, text in literals(source)
            if not text.isascii()]


def main():
    repository = pathlib.Path(sys.argv[1])
    found = 0
    for folder in SOURCES + WHOLE:
        for file in sorted((repository / folder).rglob("*")):
            if not file.is_file():
                continue
            for line, text in strangers(file, folder in WHOLE):
                print(f"{file.relative_to(repository)}:{line}: not ASCII: {text}")
                found += 1
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
