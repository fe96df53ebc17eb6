#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Checks the layers of the house (docs/architecture.md) in the text of the sources.

No include points upwards, and below bus/ there is no clock, sleep, socket, thread or lock but in
the SocketCAN edge. Prints one line per offence, file:line: reason; exit status 1 if there is one.
"""
import pathlib
import re
import sys

# What a module may include besides itself.
MODEL = ["common", "yaml", "can", "fieldbus", "canopen", "motion", "drive", "config"]
MAY_INCLUDE = {
    "common": [],
    "yaml": ["common"],
    "can": ["common"],
    "fieldbus": ["common"],
    "canopen": ["common", "can", "fieldbus"],
    "motion": ["common"],
    "drive": ["common", "fieldbus", "motion"],
    "config": ["common", "yaml", "can", "fieldbus", "canopen", "motion", "drive"],
    "decode": MODEL,
    "bus": MODEL + ["decode"],
    "sim": MODEL,
    "driver": MODEL + ["decode", "bus", "sim"],
    "ros": MODEL + ["decode", "bus", "sim", "driver"],
    "tools": MODEL + ["decode", "bus", "sim"],
    "campaign": MODEL + ["decode", "bus", "sim", "tools"],
}
# sim/ takes only types and numbers from the master's stack: what encodes, decodes or decides there
# must not do so here, or a mistake would meet itself on both ends of the wire and stay unseen.
SIM_MAY_NOT_INCLUDE = re.compile(
    r"canopen/(sdo/|pdo/|emcy/|sync/|node/|boot/|nmt/(heartbeat|node_guarding)|master)"
    r"|fieldbus/(bytes|emergency|device)|drive/(axis/(axis\.h|state_machine)|profile/conversion)")

SANS_IO = MODEL + ["decode", "sim"]
# The edge of can/ towards the kernel.
EDGE = re.compile(r"/can/(socketcan|raw_socket|link_probe|link_message|link_settings|wall_clock)")
FORBIDDEN = [
    (re.compile(r"#include\s*<(thread|mutex|shared_mutex|condition_variable|future|semaphore|"
                r"ctime|time\.h|pthread\.h|poll\.h|unistd\.h|sys/(socket|select|epoll|timerfd|time)\.h|"
                r"net/.*|linux/can.*)>"), "header"),
    (re.compile(r"\b(steady_clock|system_clock|high_resolution_clock|clock_gettime|gettimeofday)\b"),
     "clock"),
    (re.compile(r"\b(sleep_for|sleep_until|usleep|nanosleep|clock_nanosleep)\b"), "sleep"),
    (re.compile(r"\bstd::(thread|mutex|shared_mutex|recursive_mutex|condition_variable|lock_guard|"
                r"unique_lock|scoped_lock|future|promise|async)\b"), "thread or lock"),
]
INCLUDE = re.compile(r'#include\s*[<"](?:cia402_driver/)?([a-z_]+)/([^">]+)[">]')
ROS_INCLUDE = re.compile(r"#include\s*[<\"](ros|tf2|tf2_ros|actionlib|[a-z0-9]+_(msgs|srvs))/")


def code_of(line):
    """The line without its // comment."""
    return line.split("//", 1)[0]


def offences_in_line(module, path, line):
    include = INCLUDE.search(line)
    if include:
        other, file = include.groups()
        if other != module and other in MAY_INCLUDE and other not in MAY_INCLUDE[module]:
            yield f"{module}/ may not include {other}/"
        if module == "sim" and SIM_MAY_NOT_INCLUDE.match(f"{other}/{file}"):
            yield f"sim/ may take only types from {other}/, not {file}"
    if module != "ros" and ROS_INCLUDE.search(line):
        yield "only ros/ may know ROS"
    if module in SANS_IO and not EDGE.search(path):
        for pattern, kind in FORBIDDEN:
            found = pattern.search(line)
            if found:
                yield f"{kind} below bus/: {found.group(0)}"


def offences(root):
    for base in (root / "include" / "cia402_driver", root / "src"):
        for path in sorted(base.rglob("*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            module = path.relative_to(base).parts[0]
            if path.parent == base:  # the face of the whole
                module = "driver"
            if module not in MAY_INCLUDE:
                yield f"{path.relative_to(root)}: {module}/ is no module of the house"
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                for reason in offences_in_line(module, path.as_posix(), code_of(line)):
                    yield f"{path.relative_to(root)}:{number}: {reason}"


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    found = list(offences(root))
    print("\n".join(found), end="\n" if found else "")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
