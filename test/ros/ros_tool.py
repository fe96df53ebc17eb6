# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Programs that other people wrote, as children of a test, and what they complain of."""
import re
import signal
import subprocess
import tempfile

import rosgraph
import rospy
from robot_client import DEADLINE, executable, wait_until
from rosgraph_msgs.msg import Log

COMPLAINT = re.compile(r"(?i:warn|error|fatal|exception|traceback)|TF_")

# Listens to tf as every program does, and complains of what it is told.
LISTENER = ["/usr/bin/python3", "-c", """
import rospy, tf2_ros
rospy.init_node("listener")
listener = tf2_ros.TransformListener(tf2_ros.Buffer())
rospy.spin()
"""]


def node_of(package, name):
    """The command that starts a node of another package."""
    return [executable(name, package)]


class Tool:
    """A running program with a node of that name."""

    def __init__(self, name, command, *arguments):
        self.name = name
        # pylint: disable=consider-using-with
        self._out = tempfile.NamedTemporaryFile(suffix=name)
        self._err = tempfile.NamedTemporaryFile(suffix=name)
        self._process = subprocess.Popen([*command, *arguments, f"__name:={name}"],
                                         stdin=subprocess.DEVNULL, stdout=self._out,
                                         stderr=self._err)

    def wait_listens(self, *topics):
        """Until its node takes these topics."""
        return self._wait_registered(1, "listens to", topics)

    def wait_tells(self, *topics):
        """Until its node offers these topics. One that begins to listen at the same time may be told
        of it twice, and connect twice, of which the node complains."""
        return self._wait_registered(0, "tells", topics)

    def _wait_registered(self, side, what, topics):
        master = rosgraph.Master(rospy.get_name())

        def met():
            nodes = dict(master.getSystemState()[side])
            return all("/" + self.name in nodes.get(topic, []) for topic in topics)
        wait_until(met, lambda: f"{self.name} {what} {topics}\n{self.complaints()}")
        return self

    def wait_end(self):
        """@return exit status, negative: the signal that ended it."""
        return self._process.wait(DEADLINE)

    def stop(self):
        """Ends it as Ctrl-C does, or else by force: a node of rospy that is interrupted as it hands
        over a message with a queue waits for ever, as its handler takes the lock it holds already."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait(DEADLINE)

    def complaints(self):
        """All that it has written to stderr, and lines of stdout that complain."""
        lines = []
        for file, pattern in ((self._out, COMPLAINT), (self._err, re.compile(r"\S"))):
            with open(file.name, encoding="utf-8", errors="replace") as text:
                lines += [f"{self.name}: {line.rstrip()}" for line in text if pattern.search(line)]
        return lines


class Complaints:
    """Warnings and errors of nodes on /rosout."""

    def __init__(self):
        self._lines = []
        self._subscriber = rospy.Subscriber("/rosout", Log, self._on_log)

    def _on_log(self, message):
        if message.level >= Log.WARN:
            self._lines.append((message.name, message.msg))

    def of(self, tools):
        names = {"/" + tool.name for tool in tools}
        return [f"{name}: {text}" for name, text in self._lines if name in names]

    def close(self):
        self._subscriber.unregister()
