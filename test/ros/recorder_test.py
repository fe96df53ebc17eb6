#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The flight recorder: files on faults and on demand."""
import os
import re
import shutil
import tempfile

from recordings import find_recording, first, head_of, read_log, read_text, wait_recording
from robot_client import Process, Robot, RobotTest, main, wait_until


class Recorder(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix="recordings_")
        cls.process = Process("bus_node", "robot", cls.CONFIG, interface="sim",
                              recorder={"directory": cls.directory, "post_trigger": 0.3})
        cls.robot = Robot()
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        shutil.rmtree(cls.directory)

    def dump(self):
        """Reads an object and asks for a recording. @return the answer, or None while a failure is
        being recorded."""
        self.succeed("elbow/read_object", object="1018:01")
        answer = self.robot.call("dump_recording")
        return answer if answer.success else None

    def test_01_memory_and_place_are_told_at_the_start(self):
        self.wait_log(f"flight recorder: the last 10 s in |MB|{self.directory}")

    def test_02_service_answers_with_the_files(self):
        answer = wait_until(self.dump, "a recording on demand")
        self.assert_words(answer.message, "flight recording|asked for")
        log = re.search(r"frames in (\S+\.log)", answer.message)[1]
        text = re.search(r"in words in (\S+\.txt)", answer.message)[1]
        self.assertTrue(os.path.basename(log).endswith("Z_sim_requested.log"), log)
        frames = read_log(log)
        self.assertGreater(len(frames), 100)
        self.assertEqual({frame[1] for frame in frames}, {"sim"})
        stamps = [frame[0] for frame in frames]
        self.assertEqual(stamps, sorted(stamps))
        lines = read_text(text)
        first(lines, "SDO", ["elbow (2)", "1018:01 vendor id"])
        first(lines, "TPDO1", ["elbow (2)", "statusword", "switch on disabled"])
        self.assertEqual(sum(line[1] != "--" for line in lines), len(frames))

    def test_03_a_fault_is_recorded_with_its_story(self):
        self.home_and_enable()
        self.succeed("inject_fault", axis="elbow", fault="encoder")
        self.robot.wait_state("elbow", "fault")
        self.wait_log(f"flight recording|elbow (node 2)|0x7305|{self.directory}")
        log = wait_recording(self.directory, "elbow_fault_7305")
        frames = read_log(log)
        emergencies = [frame for frame in frames if frame[2] == 0x082]
        self.assertEqual(emergencies[-1][3][:4], "0573")
        text = log[:-4] + ".txt"
        self.assertIn("elbow (node 2): fault 0x7305 incremental sensor 1 fault", head_of(text))
        lines = read_text(text)
        emergency = first(lines, "EMCY", ["elbow (2)", "0x7305 incremental sensor 1 fault"])
        word = first(lines, "TPDO1", ["elbow (2)", "fault"])
        state = first(lines, "axis", ["elbow (2)", "operation enabled -> fault"])
        self.assertLess(emergency, state)
        self.assertLess(word, state)
        # More than what happened before, and what happened after.
        self.assertLess(lines[0][0], -1.0)
        self.assertGreater(lines[-1][0], 0.25)
        self.succeed("inject_fault", axis="elbow", fault="clear")
        self.succeed("elbow/clear_faults")

    def test_04_a_folder_that_cannot_be_written_is_told(self):
        self.assertIsNone(find_recording(self.directory, "nothing"))
        other = Process("bus_node", "other", self.CONFIG, interface="sim",
                        recorder={"directory": "/proc/recordings"})
        robot = Robot("other")
        try:
            def met():  # refused while a failure is being recorded
                answer = robot.call("dump_recording")
                self.assertFalse(answer.success)
                return "could not be written" in answer.message and answer.message
            self.assert_words(wait_until(met, "told"), "/proc/recordings")
        finally:
            other.stop()
            robot.close()


if __name__ == "__main__":
    main("recorder")
