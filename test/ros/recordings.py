# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Reads what the flight recorder wrote."""
import glob
import os
import re

from robot_client import wait_until

LOG_LINE = re.compile(r"^\((\d{10}\.\d{6})\) (\S+) ([0-9A-F]{3}|[0-9A-F]{8})#(R\d?|(?:[0-9A-F]{2}){0,8})"
                      r" [RT]$")
TEXT_LINE = re.compile(r"^(\d+\.\d{6}) +([+-]\d+\.\d{6})  (rx|tx|--)  (\S+) +(\S.*)$")


def read_log(path):
    """(time, interface, identifier, data) of each line of a candump log; an AssertionError for a
    line that is none."""
    frames = []
    with open(path, encoding="ascii") as log:
        for line in log:
            match = LOG_LINE.match(line.rstrip("\n"))
            assert match, f"{path}: no line of candump: {line!r}"
            frames.append((float(match[1]), match[2], int(match[3], 16), match[4]))
    return frames


def read_text(path):
    """(relative time, direction, service, rest) of each line of a recording in words."""
    lines = []
    with open(path, encoding="utf-8") as text:
        for line in text:
            if line.startswith("#"):
                continue
            match = TEXT_LINE.match(line.rstrip("\n"))
            assert match, f"{path}: no line of a recording: {line!r}"
            lines.append((float(match[2]), match[3], match[4], match[5]))
    return lines


def head_of(path):
    with open(path, encoding="utf-8") as text:
        return "".join(line for line in text if line.startswith("#"))


def find_recording(directory, words):
    """The log of the first recording whose name holds the words, or None. Both files are there, as
    the text is written after the log, and its head before all else."""
    for text in sorted(glob.glob(os.path.join(directory, f"*{words}*.txt"))):
        return text[:-4] + ".log"
    return None


def wait_recording(directory, words):
    return wait_until(lambda: find_recording(directory, words), f"a recording {words}")


def first(lines, service, words):
    """Index of the first line of a service that holds all the words."""
    for index, (_, _, name, rest) in enumerate(lines):
        if name == service and all(word in rest for word in words):
            return index
    raise AssertionError(f"no line {service} {words}")
