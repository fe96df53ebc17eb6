#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The flight recorder on a real CAN interface: a fault of a drive in another process is on file."""
import itertools
import os
import shutil
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "ros"))
from recordings import first, head_of, read_log, read_text, wait_recording  # noqa: E402
from robot_client import Process, Robot, RobotTest, main, rospy, wait_until  # noqa: E402
from wire import Wire  # noqa: E402

CONFIG = "test/vcan/robot.yaml"


class VcanRecorder(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix="recordings_")
        cls.wire = Wire()
        cls.drives = Process("simulated_drives", "simulated_drives", CONFIG)
        cls.process = Process("bus_node", "robot", CONFIG,
                              recorder={"directory": cls.directory})
        cls.robot = Robot()
        cls.robot.wait_ready(60.0)

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        cls.drives.stop()
        cls.wire.close()
        shutil.rmtree(cls.directory)

    def inject(self, axis, fault):
        from cia402_driver.srv import InjectFault
        rospy.wait_for_service("/simulated_drives/inject_fault", 40.0)
        answer = rospy.ServiceProxy("/simulated_drives/inject_fault", InjectFault)(axis, fault)
        self.assertTrue(answer.success, answer.message)

    def statuswords(self):
        """Those of the wrist, on the wire so far."""
        return [data[:2].hex().upper() for _, identifier, data in self.wire.since(0.0)
                if identifier == 0x183]

    def test_a_fault_is_on_file(self):
        wait_until(self.robot.recovered, "recovered")
        wait_until(lambda: self.robot.call("wrist/enable").success, "enabled")
        wait_until(lambda: len(self.statuswords()) > 50, "some cycles of feedback")
        began = time.time()
        self.inject("wrist", "encoder")
        self.robot.wait_state("wrist", "fault")
        log = wait_recording(self.directory, "vcan0_wrist_fault_7305")
        self.wait_log(f"flight recording|wrist (node 3)|{os.path.basename(log)}")
        frames = read_log(log)
        self.assertEqual({frame[1] for frame in frames}, {"vcan0"})

        # The log is what was on the wire: the emergency and every change of the wrist's statusword.
        emergency = next(frame for frame in frames if frame[2] == 0x083 and frame[3][:4] == "0573")
        self.assertGreater(emergency[0], began - 0.1)
        self.assertLess(emergency[0], began + 40.0)
        logged = [frame[3][:4] for frame in frames if frame[2] == 0x183]
        wired = self.statuswords()
        self.assertGreater(len(logged), 50)
        self.assertIn(" ".join(word for word, _ in itertools.groupby(logged)),
                      " ".join(word for word, _ in itertools.groupby(wired)))

        text = log[:-4] + ".txt"
        self.assertIn("wrist (node 3): fault 0x7305 incremental sensor 1 fault", head_of(text))
        lines = read_text(text)
        told = first(lines, "EMCY", ["wrist (3)", "0x7305 incremental sensor 1 fault"])
        fell = first(lines, "axis", ["wrist (3)", "operation enabled -> fault"])
        self.assertLess(told, fell)

    def test_b_service_writes_what_there_is(self):
        def met():  # refused while a failure is being recorded
            answer = self.robot.call("dump_recording")
            return answer.success and answer.message
        self.assert_words(wait_until(met, "written"), "vcan0_requested.log|vcan0_requested.txt")


if __name__ == "__main__":
    main("vcan_recorder")
