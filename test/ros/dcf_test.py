#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What a drive holds, written as a DCF by service; names of an EDS in services."""
import configparser
import os
import shutil
import tempfile

from robot_client import Process, Robot, RobotTest, main

EDS = "package://cia402_driver/test/config/motor.eds"


def read_dcf(path):
    parser = configparser.ConfigParser(interpolation=None)
    parser.optionxform = str
    with open(path, newline="", encoding="utf-8") as file:
        parser.read_string(file.read().replace("\r\n", "\n"))
    return parser


class Dcf(RobotTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.process = Process("bus_node", "robot", cls.CONFIG, interface="sim",
                              **{"axes/shoulder/eds": EDS})
        cls.robot = Robot()
        cls.robot.wait_ready()

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        shutil.rmtree(cls.folder)

    def save(self, axis, words):
        path = os.path.join(self.folder, axis + ".dcf")
        self.succeed(f"{axis}/save_dcf", f"{axis}|objects read|written to {path}|{words}", path=path)
        return path

    def test_names_of_the_eds_in_services(self):
        answer = self.succeed("shoulder/read_object", "6064", object="Position actual value")
        by_index = self.succeed("shoulder/read_object", object="6064:00")
        self.assertEqual(answer.bytes, by_index.bytes)
        self.refuse("shoulder/read_object", "shoulder|motor.eds|there is no object",
                    object="Postion actual value")

    def test_with_an_eds_its_objects_and_names_are_written(self):
        dcf = read_dcf(self.save("shoulder", "could not be read"))
        self.assertEqual(dcf["DeviceComissioning"]["NodeID"], "0x01")
        self.assertEqual(dcf["DeviceComissioning"]["NodeName"], "shoulder")
        self.assertEqual(dcf["FileInfo"]["LastEDS"], "motor.eds")
        self.assertEqual(dcf["607A"]["ParameterName"], "Target position")
        held = self.succeed("shoulder/read_object", object="Vendor-ID").number
        self.assertEqual(int(dcf["1018sub1"]["ParameterValue"], 0), held)
        self.assertNotIn("ParameterValue", dcf["2011"])  # the drive does not have it

    def test_without_an_eds_it_can_be_used_as_one_afterwards(self):
        path = self.save("wrist", "")
        dcf = read_dcf(path)
        self.assertEqual(int(dcf["1000"]["ParameterValue"], 0), 0x00020192)
        self.assertEqual(dcf["1018sub1"]["AccessType"], "ro")
        self.assertEqual(dcf["6065"]["ParameterName"], "following_error_window")
        self.assertEqual(dcf["FileInfo"]["FileName"], "wrist.dcf")
        self.assertNotIn("wrist.dcf.part", os.listdir(self.folder))
        again = Process("bus_node", "again", self.CONFIG, interface="sim",
                        **{"axes/wrist/eds": path})
        robot = Robot("again")
        try:
            robot.wait_ready()
            self.assertNotIn("wrist.dcf: line", again.output())
            answer = robot.call("wrist/read_object", object="Identity object/Vendor-ID")
            self.assertTrue(answer.success, answer.message)
        finally:
            robot.close()
            again.stop()

    def test_what_was_dumped_comes_back_once_that_is_confirmed(self):
        path = self.save("wrist", "")
        held = self.succeed("wrist/read_object", object="6066:00").number
        self.succeed("wrist/write_object", object="6066:00", value=str(int(held) + 7))
        self.refuse("wrist/load_dcf", "wrist|1 differ|6066:00|nothing was written|confirm: true",
                    path=path)
        self.assertEqual(self.succeed("wrist/read_object", object="6066:00").number, held + 7)
        self.succeed("wrist/load_dcf", "wrist|1 were written and read back|6066:00", path=path,
                     confirm=True)
        self.assertEqual(self.succeed("wrist/read_object", object="6066:00").number, held)

    def test_what_is_no_dcf_is_not_loaded(self):
        path = os.path.join(self.folder, "none.dcf")
        with open(path, "w", encoding="ascii") as file:
            file.write("nothing")
        self.refuse("wrist/load_dcf", "wrist|none.dcf not loaded|line 1", path=path, confirm=True)
        self.refuse("wrist/load_dcf", "wrist|does not end in .dcf", path="/tmp/wrist")
        self.refuse("wrist/load_dcf", "wrist|/nowhere/a.dcf|cannot be read", path="/nowhere/a.dcf")

    def test_paths_that_cannot_be_written_are_refused_before_reading(self):
        self.refuse("wrist/save_dcf", "wrist|does not end in .dcf|/tmp/wrist.dcf", path="/tmp/wrist")
        self.refuse("wrist/save_dcf", "wrist|there is no folder /nowhere", path="/nowhere/a.dcf")
        os.mkdir(os.path.join(self.folder, "folder.dcf"))
        self.refuse("wrist/save_dcf", "cannot write", path=os.path.join(self.folder, "folder.dcf"))


if __name__ == "__main__":
    main("dcf")
