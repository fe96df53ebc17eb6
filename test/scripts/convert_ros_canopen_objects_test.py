#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/convert_ros_canopen: what goes into a drive, by dcf_overlay, EDS and DCF."""
import math
import unittest

import yaml

from ros_canopen_files import BUS, DEFAULTS, NODES, SERVO, Case, eds

CONVERTED, APPROXIMATED, NONE = "converted", "approximated", "no counterpart"


class Overlay(Case):
    def overlay(self, text, *options):
        return self.with_defaults(f"  dcf_overlay: {{{text}}}\n", *options)

    def test_homing(self):
        axis = self.overlay('"6098": "19", "6099sub1": "100000", "6099sub2": "0x2710", '
                            '"609A": "36000", '
                            '"607C": "90000"').axis()
        homing = axis["homing"]
        self.assertEqual(homing["method"], 19)
        # millidegrees: 100 deg/s, 10 deg/s, 36 deg/s^2, 90 deg
        self.assertAlmostEqual(homing["search_velocity"], 1.74532925199, 10)
        self.assertAlmostEqual(homing["zero_velocity"], 0.174532925199, 11)
        self.assertAlmostEqual(homing["acceleration"], 0.628318530718, 11)
        self.assertAlmostEqual(homing["offset"], math.pi / 2, 10)
        self.assertNotIn("write", axis)

    def test_method_0_is_no_homing(self):
        converted = self.overlay('"6098": "0", "607C": "5"')
        self.assertNotIn("homing", converted.axis())
        self.assertEqual(converted.axis()["write"], [{"object": "607C:00", "raw": 5}])

    def test_a_method_that_is_in_no_file_is_named(self):
        self.told(self.convert(), NONE, "[6098:00]", "no file says the homing method")

    def test_a_method_of_the_maker_is_a_profile_of_its_own(self):
        self.write("driver.yaml",
                   BUS + "defaults: {eds_file: servo.eds, dcf_overlay: {\"6098\": \"-3\"}}\n" + NODES)
        self.assertEqual(self.run_script("--output", "robot.yaml", "driver.yaml").status, 0)
        profile = yaml.safe_load((self.folder / "robot_drive.yaml").read_text(encoding="utf-8"))
        self.assertIn(-3, profile["homing"]["methods"])
        self.assertIn(37, profile["homing"]["methods"])
        self.told(self.overlay('"6098": "99"'), NONE, "dcf_overlay/6098", "no homing method 99")

    def test_a_method_that_cannot_be_written_is_the_only_one(self):
        self.write("servo.eds", eds({**SERVO, (0x6098, 0): (2, "const")}, {(0x6098, 0): "35"}))
        axis = self.convert().axis()
        self.assertEqual((axis["homing"]["method"], axis["lacks"]), (35, ["homing_method"]))
        self.write("servo.eds", eds({**SERVO, (0x6098, 0): (2, "const")}, {(0x6098, 0): "0"}))
        self.assertEqual(self.convert().status, 0)

    def test_position_limits_are_limits_here(self):
        limits = self.overlay('"607Dsub1": "-180000", "607Dsub2": "90000"').axis()["limits"]
        self.assertAlmostEqual(limits["lower"], -math.pi, 10)
        self.assertAlmostEqual(limits["upper"], math.pi / 2, 10)
        self.write("driver.yaml",
                   BUS + "defaults: {eds_file: servo.eds, pos_to_device: -1000*pos, pos_from_device: "
                   "-obj6064/1000, dcf_overlay: {\"607Dsub1\": \"-3000\", "
                   "\"607Dsub2\": \"500\"}}\n" + NODES)
        self.assertEqual(self.run_script("driver.yaml").axis()["limits"], {"lower": -0.5, "upper": 3})

    def test_the_speed_limit_is_a_limit_here_unless_the_joint_has_one(self):
        self.assertAlmostEqual(self.overlay('"607F": "90000"').axis()["limits"]["velocity"],
                               math.pi / 2, 10)
        converted = self.with_defaults("  dcf_overlay: {\"607F\": \"90000\"}\n",
                                       more="joint_limits: {shoulder: "
                                       "{has_velocity_limits: true, max_velocity: 0.5}}\n")
        self.assertEqual(converted.axis()["limits"], {"velocity": 0.5})
        self.assertEqual(converted.axis()["write"], [{"object": "607F:00", "raw": 90000}])

    def test_heartbeats(self):
        axis = self.overlay('"1016sub1": "0x7F0064", "1017": "50"').axis()
        self.assertEqual(axis["error_control"], {"master_timeout": 0.1, "period": 0.05})
        self.told(self.overlay('"1016sub1": "0x7F0032"'), APPROXIMATED, "1016sub1",
                  "50 ms are no longer")
        self.told(self.overlay('"1016sub1": "0x7E0064"'), NONE, "1016sub1", "watches node 126")
        self.told(self.overlay('"1016sub1": "0"'), APPROXIMATED, "1016sub1", "watches nobody")
        self.told(self.overlay('"1017": "0"'), APPROXIMATED, "1017", "sent none there")

    def test_other_objects_are_written(self):
        objects = {**SERVO, (0x2040, 1): (7, "rw"), (0x2040, 2): (8, "rw"), (0x2041, 0): (3, "rw")}
        self.write("servo.eds", eds(objects))
        writes = self.overlay('"6065": "2000", "2040sub1": "4294967295", "2040SUB2": "0.015", '
                              '"2041": "-5"')
        self.assertEqual(writes.axis()["write"], [
            {"object": "2040:01", "type": "uint32", "raw": "0xFFFFFFFF"},
            {"object": "2040:02", "type": "real32", "value": 0.015},
            {"object": "2041:00", "type": "int16", "raw": -5}, {"object": "6065:00", "raw": 2000}])

    def test_numbers_as_ros_canopen_reads_them(self):
        converted = self.overlay('"6065": "129950.0", "6083": "010", "6084": 7')
        writes = {entry["object"]: entry["raw"] for entry in converted.axis()["write"]}
        self.assertEqual(writes, {"6065:00": 129950, "6083:00": 8, "6084:00": 7})  # 010 is octal
        self.told(converted, APPROXIMATED, "dcf_overlay/6065", "read as 129950")
        self.told(converted, APPROXIMATED, "dcf_overlay/6084", "without quotes")

    def test_what_the_driver_does_itself_is_told(self):
        objects = {**SERVO, (0x1005, 0): (7, "rw"), (0x100C, 0): (6, "rw"), (0x1010, 1): (7, "rw"),
                   (0x1600, 1): (7, "rw"), (0x2000, 0): (5, "rw"), (0x605A, 0): (3, "rw"),
                   (0x605D, 0): (3, "rw"),
                   (0x60C2, 1): (5, "rw"), (0x2041, 0): (9, "rw")}
        self.write("servo.eds", eds(objects, names={(0x2000, 0): "Node-ID"}))
        converted = self.overlay('"1005": "0x80", "100C": "100", "1010sub1": "1", "1600sub1": "0", '
                                 '"2000": "5", "605A": "6", "605D": "2", "60C2sub1": "10", '
                                 '"6040": "6", "6060": "8", '
                                 '"6041": "1", "2041": "text"')
        axis = converted.axis()
        self.assertEqual((axis["quick_stop"], axis["mode"]), ("hold", "cyclic_position"))
        self.assertNotIn("write", axis)
        for part in ("dcf_overlay/1005", "1600sub1", "605A", "60C2sub1", "dcf_overlay/6040",
                     "dcf_overlay/6060"):
            self.told(converted, APPROXIMATED, part)
        for part in ("100C", "1010sub1", "dcf_overlay/2000", "605D", "dcf_overlay/6041", "2041"):
            self.told(converted, NONE, part)

    def test_refusals(self):
        def refused(overlay, *parts):
            self.refused(BUS + f"defaults: {{eds_file: servo.eds, dcf_overlay: {overlay}}}\n" + NODES,
                         *parts)
        refused("5", "defaults/dcf_overlay", "must be a mapping")
        refused('{"6099sub9": "1"}', "driver.yaml:5: defaults/dcf_overlay/6099sub9",
                "servo.eds has no object")
        refused('{"speed": "1"}', "`speed` is no object")
        refused('{"6083": "fast"}', "dcf_overlay/6083", "`fast` is no number", "6083:00")
        refused('{"6083": {a: 1}}', "dcf_overlay/6083", "must be a number as a text")


class Files(Case):
    def test_parameter_values_of_a_dcf_are_written_where_they_are_not_the_default(self):
        self.write("servo.eds", eds(values={(0x6065, 0): "$NODEID+0x100", (0x6083, 0): "5",
                                            (0x6084, 0): "6",
                                            (0x6041, 0): "1", (0x6098, 0): "35"},
                                    defaults={(0x6083, 0): "5", (0x6084, 0): "5"}))
        converted = self.convert()
        self.assertEqual(converted.axis()["write"],
                         # 3 + 0x100
                         [{"object": "6065:00", "raw": 259}, {"object": "6084:00", "raw": 6}])
        self.assertEqual(converted.axis("elbow")["write"][0], {"object": "6065:00", "raw": 260})
        self.assertEqual(converted.axis()["homing"], {"method": 35})
        self.told(converted, APPROXIMATED, "servo.eds: ParameterValue",
                  "1 objects whose value is their DefaultValue")
        self.told(converted, APPROXIMATED, "servo.eds: ParameterValue",
                  "1 objects that cannot be written")

    def test_an_overlay_counts_in_the_place_of_a_dcf(self):
        self.write("servo.eds", eds(values={(0x6083, 0): "5"}))
        axis = self.with_defaults("  dcf_overlay: {\"6083\": \"9\"}\n").axis()
        self.assertEqual(axis["write"], [{"object": "6083:00", "raw": 9}])

    def test_the_layout_of_pdos_is_told(self):
        self.write("servo.eds", eds({**SERVO, (0x1600, 1): (7, "rw")}, {(0x1600, 1): "0x60400010"}))
        self.told(self.convert(), APPROXIMATED, "servo.eds: 1400h to 1BFFh", "RPDO 6040:00")

    def test_the_maker_chooses_the_profile(self):
        self.write("servo.eds",
                   eds(head="VendorName=Inovance\nVendorNumber=0x3B9\nProductNumber=0xD0117"))
        self.assertEqual(self.convert().axis()["drive"], "sv660c")
        self.write("servo.eds", eds({**SERVO, (0x1018, 1): (7, "ro")}, defaults={(0x1018, 1): "0x2D"}))
        self.assertEqual(self.convert().axis()["drive"], "nimotion_stepper")
        self.write("servo.eds", eds(head="VendorName=Megmeet Co.\nProductName=DM5"))
        self.assertEqual(self.convert().axis()["drive"], "megmeet_dm5")
        self.write("servo.eds", eds(head="VendorName=Else\nVendorNumber=0x9A"))
        converted = self.convert()
        self.assertEqual(converted.axis()["drive"], "generic_cia402")
        self.assertIn("no profile is that of vendor 0x9A", converted.text)

    def test_what_the_drive_lacks_is_told(self):
        converted = self.convert()
        self.told(converted, CONVERTED, "servo.eds: objects", "the drive lacks", "error_code")
        objects = dict(SERVO)
        del objects[(0x6061, 0)]
        self.write("servo.eds", eds(objects))
        converted = self.convert()
        self.told(converted, NONE, "servo.eds: objects", "lacks mode_display (6061h)")
        self.assertNotIn("eds", converted.axis())

    def test_a_type_of_another_length_than_the_profile_has_is_told(self):
        self.write("servo.eds", eds({**SERVO, (0x6064, 0): (3, "ro")}))
        converted = self.convert()
        self.told(converted, NONE, "[6064:00]", "int16", "int32")
        self.assertNotIn("eds", converted.axis())

    def test_modes_that_the_eds_denies_are_told(self):
        self.write("servo.eds", eds({**SERVO, (0x6502, 0): (7, "ro")}, defaults={(0x6502, 0): "0x80"}))
        controller = "c: {type: position_controllers/JointPositionController, joint: shoulder, " \
                     "required_drive_mode: 1}\n"
        self.told(self.with_defaults("", more=controller), NONE, "servo.eds: 6502h", "[1]")

    def test_damage_that_can_be_passed_over_is_told(self):
        self.write("servo.eds",
                   eds().replace("[1001]", "junk\n[1001]") + "\n[6065]\nParameterValue=7\n")
        converted = self.convert()
        self.told(converted, APPROXIMATED, "`junk` is neither section nor key")
        self.told(converted, APPROXIMATED, "[6065] is there twice")
        self.assertEqual(converted.axis()["write"], [{"object": "6065:00", "raw": 7}])

    def test_letters_of_other_alphabets_and_cases(self):
        text = eds().replace("[6098]", "[6098]\nDenotation=R\u00fcckweg").replace("6083",
                                                                                  "6083 ").upper()
        self.write("servo.eds", text.encode("latin-1"))
        axis = self.with_defaults("  dcf_overlay: {\"6098\": \"17\"}\n").axis()
        self.assertEqual(axis["homing"], {"method": 17})

    def test_compact_arrays(self):
        text = eds() + "\n[ManufacturerObjects]\nSupportedObjects=1\n1=0x2050\n[2050]\n" \
            "ParameterName=gains\nObjectType=0x8\nDataType=0x0006\nAccessType=rw\n" \
            "CompactSubObj=3\n[2050Value]\n2=70\n"
        self.write("servo.eds", text)
        self.assertEqual(self.convert().axis()["write"],
                         [{"object": "2050:02", "type": "uint16", "raw": 70}])

    def test_refusals(self):
        def refused(text, *parts):
            self.write("servo.eds", text)
            self.refused(BUS + DEFAULTS + NODES, "servo.eds", *parts)
        refused("", "no section [DeviceInfo]")
        refused(b"\x7fELF\x00\x01", "no section [DeviceInfo]")
        refused(eds().replace("SupportedObjects=", "SupportedObjects=many"),
                "[optionalobjects] SupportedObjects",
                "is no number")
        refused(eds().replace("\n2=0x1001", "\n"), "2 is missing")
        refused(eds().replace("2=0x1001", "2=0x12345"), "`0x12345` is no index")
        refused(eds().replace("DataType=0x0004", "DataType=long"), "DataType: `long` is no number")
        refused(eds().replace("DataType=0x0004\n", ""), "has no DataType")
        refused(eds().replace("SubNumber=2\n", ""), "has no SubNumber")
        refused(eds(values={(0x6083, 0): "fast"}), "[6083:00] ParameterValue", "`fast` is no number")


if __name__ == "__main__":
    unittest.main()
