#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What a bus_node takes of a machine beside processor time: memory, threads, wake-ups.

Prints a table for robots of 1, 8 and 32 axes on vcan0: nobody listens to the node, its drives are
booted and disabled.
"""
import os
import sys
import tempfile
import time
import unittest

import yaml

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from robot_client import Process, Robot, main, wait_until  # noqa: E402

MEASURED_S = 20.0
MOST_MB = {1: 40.0, 8: 40.0, 32: 48.0}
MOST_THREADS = 12
MOST_WAKE_UPS = 150.0  # a second; some more where the machine is crowded, see docs/benchmarks.md


def robot_of(count):
    """A robot's file: generic drives that stand still, one trajectory group."""
    axes = {f"axis_{number:02}": {"node_id": number} for number in range(1, count + 1)}
    return {
        "bus": {"interface": "vcan0", "bitrate": 1000000, "sync_period": 0.05, "heartbeat": 0.5},
        "defaults": {
            "drive": "generic_cia402", "type": "revolute", "mode": "cyclic_position",
            "counts_per_turn": 131072, "gear_ratio": 100.0, "homing": {"method": 37},
            "limits": {"lower": -2.5, "upper": 2.5, "velocity": 1.5, "acceleration": 4.0}},
        "axes": axes,
        "groups": {"arm": {"joints": list(axes)}},
    }


def threads_of(pid):
    """{thread: (name, how often it slept, page faults)} from /proc. What another thread takes the
    processor from does not wake afterwards, and is not counted."""
    threads = {}
    for task in os.listdir(f"/proc/{pid}/task"):
        folder = f"/proc/{pid}/task/{task}"
        with open(f"{folder}/status", encoding="ascii") as file:
            status = dict(line.split(":", 1) for line in file)
        with open(f"{folder}/stat", encoding="ascii") as file:
            fields = file.read().rpartition(")")[2].split()
        threads[task] = (status["Name"].strip(), int(status["voluntary_ctxt_switches"]),
                         int(fields[7]) + int(fields[9]))
    return threads


def resident_mb(pid):
    with open(f"/proc/{pid}/smaps_rollup", encoding="ascii") as file:
        kilobytes = next(int(line.split()[1]) for line in file if line.startswith("Rss:"))
    return kilobytes * 1024 / 1e6


def bus_thread(pid):
    return next(values for values in threads_of(pid).values() if values[0] == "bus")


class Footprint(unittest.TestCase):
    def setUp(self):
        self.processes = []

    def tearDown(self):
        for process in reversed(self.processes):
            process.stop()

    def start(self, node, name, config):
        process = Process(node, name, config)
        self.processes.append(process)
        return process

    def booted(self, count):
        """Starts a robot. @return its node, and the page faults of the bus thread until then."""
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            yaml.safe_dump(robot_of(count), file)
            file.flush()
            self.start("simulated_drives", f"drives_{count}", file.name)
            node = self.start("bus_node", f"robot_{count}", file.name)
            robot = Robot(f"robot_{count}")
            wait_until(lambda: robot.bus_state and robot.bus_state.cycles > 0, "it runs")
            faults = bus_thread(node.pid())[2]
            robot.wait_ready(300.0)
            self.assertTrue(robot.call("home").success)
            self.assertTrue(robot.call("enable").success)
            self.assertTrue(robot.call("disable").success)
            robot.close()
        return node, faults

    def footprint(self, count):
        node, faults = self.booted(count)
        pid = node.pid()
        time.sleep(1.0)  # until the connections are gone
        before, began = threads_of(pid), time.monotonic()
        time.sleep(MEASURED_S)  # rates are measured over a time
        after, seconds = threads_of(pid), time.monotonic() - began
        self.assertEqual(sorted(before), sorted(after))
        rates = sorted(((after[task][1] - before[task][1]) / seconds, after[task][0])
                       for task in after if after[task][0] != "bus")
        wake_ups = sum(rate for rate, _ in rates)
        later = bus_thread(pid)[2] - faults
        memory = resident_mb(pid)
        print(f"{count} axes: {memory:.1f} MB resident, {len(after)} threads, {wake_ups:.0f} "
              f"wake-ups a second without the bus thread ("
              + ", ".join(f"{name} {rate:.0f}" for rate, name in reversed(rates) if rate >= 0.5)
              + f"), {later} page faults of the bus thread once it ran", flush=True)
        self.assertLessEqual(memory, MOST_MB[count])
        self.assertLessEqual(len(after), MOST_THREADS)
        self.assertLessEqual(wake_ups, MOST_WAKE_UPS)
        self.assertEqual(later, 0)

    def test_01_axis(self):
        self.footprint(1)

    def test_08_axes(self):
        self.footprint(8)

    def test_32_axes(self):
        self.footprint(32)


if __name__ == "__main__":
    main("footprint")
