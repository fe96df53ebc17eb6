#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""A bus_node under load from all its topics and services at once, with good and bad arguments.

Every call is answered in words, the node survives, and one recover brings all axes back. What a
sanitizer says of the node is a failure. CIA402_LOAD_S: how long, 60 s unless told.
"""
import os
import random
import re
import shutil
import sys
import tempfile
import threading
import time

import rosgraph
import rospy
import rosservice
import rostopic

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from arguments import SERVICES, TOPICS  # noqa: E402
from robot_client import Process, Robot, RobotTest, main, wait_until  # noqa: E402

SECONDS = float(os.environ.get("CIA402_LOAD_S", "60"))
CALLERS = 8
SANITIZER_WORDS = ("AddressSanitizer", "LeakSanitizer", "runtime error:")


def races(output):
    """ThreadSanitizer's reports in which the driver's own code touches the memory or the lock: what
    Debian's libraries of ROS do, which are not built under it, it cannot judge."""
    reports = [part for part in output.split("==================")
               if "WARNING: ThreadSanitizer" in part]
    return [report for report in reports if re.search(r"#[012] cia402::", report)]


def refused_in_words(name, error):
    """The answer of query_state has no field for a reason: the failed call carries it."""
    return name.endswith("/query_state") and re.search(
        r"responded with an error: b'.*\w+ \w+.*'", str(error)) is not None


class Load(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix="load_")
        cls.process = Process("bus_node", "robot", cls.CONFIG, interface="sim",
                              recorder={"directory": cls.folder, "post_trigger": 0.2, "keep": 3})
        cls.robot = Robot()
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        cls.robot.close()
        if cls.process.running():
            cls.process.kill()
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.end = time.monotonic() + SECONDS
        self.random = random.Random(1)
        self.lock = threading.Lock()
        self.services, self.waiting = self.offered(), []
        self.problems = []
        self.calls = {}
        self.cut_off = []
        self.answers = []
        self.sent = {}

    def start(self, work, *arguments):
        def run():
            try:
                work(*arguments)
            except Exception as error:  # pylint: disable=broad-except
                self.problems.append(f"{work.__name__}{arguments}: {error!r}")
        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        return thread

    def next_service(self):
        """All of them, one after another, each round in another order."""
        with self.lock:
            if not self.waiting:
                self.waiting = self.services[:]
                self.random.shuffle(self.waiting)
            return self.waiting.pop()

    def call(self, seed):
        """One caller: services with any of their arguments, as fast as answers come."""
        chance = random.Random(seed)
        proxies = {}
        while time.monotonic() < self.end:
            name = self.next_service()
            if name not in proxies:
                proxies[name] = rospy.ServiceProxy(name, rosservice.get_service_class_by_name(name))
            request = SERVICES[name.rsplit("/", 1)[-1]](chance, self.folder)
            try:
                answer = proxies[name](**request)
            except rospy.ServiceException as error:
                if refused_in_words(name, error):
                    self.count(name)
                    continue
                # ROS itself may close a connection too many (it races with itself in close_socket)
                lost = str(error).startswith("transport error")
                (self.cut_off if lost else self.problems).append(f"{name} {request}: {error}")
                continue
            if not getattr(answer, "message", "of dynamic_reconfigure"):
                self.problems.append(f"{name} {request}: answered without a word")
            self.count(name)

    def count(self, name):
        with self.lock:
            self.calls[name] = self.calls.get(name, 0) + 1

    def publish(self, topic, kind):
        """Sends to one topic a hundred times a second."""
        chance = random.Random(topic)
        publisher = rospy.Publisher(topic, kind, queue_size=1)
        while time.monotonic() < self.end:
            publisher.publish(TOPICS[kind](chance))
            self.sent[topic] = self.sent.get(topic, 0) + 1
            time.sleep(0.01)
        publisher.unregister()

    def topics(self):
        """What the node listens to: (topic, class)."""
        _, subscribers, _ = rosgraph.Master("/load").getSystemState()
        heard = [topic for topic, nodes in subscribers if "/robot" in nodes]
        return [(topic, rostopic.get_topic_class(topic)[0]) for topic in heard]

    @staticmethod
    def offered():
        """The node's services but those of every node."""
        return [name for name in rosservice.get_service_list(node="/robot")
                if name.rsplit("/", 1)[-1] not in ("get_loggers", "set_logger_level")]

    def recover(self):
        for axis in self.AXES:
            self.robot.call("inject_fault", axis=axis, fault="clear")
        self.answers = []
        # It names the calls that help: halted axes, and those without a zero.
        return (self.succeeds("recover") or self.succeeds("enable") and
                self.succeeds("home") and self.succeeds("recover"))

    def succeeds(self, service):
        answer = self.robot.call(service)
        self.answers.append(f"{service}: {answer.message}")
        return answer.success

    def check_alive(self):
        """A dead node is told with its last words: what the callers miss says nothing of the cause."""
        if not self.process.running():
            status = self.process.wait()
            reported = self.process.output().splitlines()
            first = next((number for number, line in enumerate(reported)
                          if any(word in line for word in SANITIZER_WORDS)), len(reported) - 20)
            words = "\n".join(reported[max(first, 0):][:60])
            self.fail(f"the node has died with status {status}: {words}")

    def test_all_topics_and_services_at_once(self):
        topics = self.topics()
        self.assertGreaterEqual(len(self.services), 80)
        # Four axes; the group: command, and goal and cancel; goal and cancel of home.
        self.assertEqual(len(topics), 10)  # four axes; the group: command, commands; two actions
        threads = [self.start(self.call, seed) for seed in range(CALLERS)]
        threads += [self.start(self.publish, topic, kind) for topic, kind in topics]
        for thread in threads:
            thread.join(SECONDS + 300.0)
            self.assertFalse(thread.is_alive(), "a call was not answered")
        print(f"{sum(self.calls.values())} calls, {sum(self.sent.values())} messages", flush=True)
        self.check_alive()
        self.assertEqual(self.problems, [])
        self.assertLess(len(self.cut_off), 5 + sum(self.calls.values()) / 100, self.cut_off)
        self.assertEqual(sorted(self.sent), sorted(topic for topic, _ in topics))
        self.assertEqual(sorted(self.calls), sorted(self.services))
        wait_until(self.recover, lambda: f"recovered, but {self.answers}", 300.0)
        self.robot.wait_ready()
        self.assertEqual(self.process.stop(), 0)
        output = self.process.output()
        for word in SANITIZER_WORDS:
            self.assertNotIn(word, output)
        self.assertEqual(races(output), [])


if __name__ == "__main__":
    main("load")
