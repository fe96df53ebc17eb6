#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Calls that wait for their answers do not keep others waiting."""
import os
import threading

import rospy
from cia402_driver.srv import ReadObject
from robot_client import RobotTest, main, wait_until

READERS = 20
MOST_THREADS = 12


class Readers:
    """Clients that read an object of a drive that is silent, again and again: a second of the bus'
    time each, one after another."""

    def __init__(self, service):
        self.answers = 0
        self._service = service
        self._end = False
        self._lock = threading.Lock()
        self._threads = [threading.Thread(target=self._read, daemon=True) for _ in range(READERS)]
        for thread in self._threads:
            thread.start()

    def _read(self):
        while not self._end:
            rospy.ServiceProxy(self._service, ReadObject)(object="1000:00")
            with self._lock:
                self.answers += 1

    def stop(self):
        self._end = True
        for thread in self._threads:
            thread.join()


class Waiting(RobotTest):
    def test_stops_begin_at_once_however_many_calls_wait(self):
        self.home_and_enable()
        self.succeed("inject_fault", axis="gripper", fault="silent")
        wait_until(lambda: not self.robot.node("gripper").ready, "the gripper is lost")
        readers = Readers("/robot/gripper/read_object")
        try:
            wait_until(lambda: readers.answers > 0, "they wait")
            before = readers.answers
            self.succeed("shoulder/halt", "shoulder")
            self.succeed("wrist/quick_stop", "wrist")
            self.succeed("elbow/disable", "elbow")
            # Behind the readers it would have taken as many answers as there are readers.
            self.assertLess(readers.answers - before, READERS // 2)
            self.assertLessEqual(len(os.listdir(f"/proc/{self.process.pid()}/task")), MOST_THREADS)
        finally:
            readers.stop()
        self.succeed("inject_fault", axis="gripper", fault="clear")

    def test_calls_to_several_axes_wait_at_the_same_time(self):
        answers = {}

        def home(axis):
            answers[axis] = self.robot.call(f"{axis}/home").success
        threads = [threading.Thread(target=home, args=[axis]) for axis in ("shoulder", "elbow")]
        for thread in threads:
            thread.start()
        running = set()
        wait_until(lambda: running.update(
            axis.name for axis in self.robot.axis_states.axes if axis.procedure == "home")
            or len(running) == 2, "both run")
        for thread in threads:
            thread.join()
        self.assertEqual(answers, {"shoulder": True, "elbow": True})


if __name__ == "__main__":
    main("waiting")
