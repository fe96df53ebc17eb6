#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Reading and writing objects of the drives by service."""
import math

from robot_client import RobotTest, main


class Objects(RobotTest):
    def test_read_by_name_tells_value_and_unit(self):
        answer = self.succeed("shoulder/read_object", "shoulder|6064", object="position_actual")
        self.assertIn("rad", answer.value)
        self.assertEqual(len(answer.bytes), 4)
        counts = int.from_bytes(answer.bytes, "little", signed=True)
        self.assertEqual(answer.number, counts)
        self.assertEqual(answer.raw, " ".join(f"{byte:02X}" for byte in answer.bytes))

    def test_read_by_index_in_all_spellings(self):
        # The last two are what rosservice makes of 0x6041 and of 6041:00.
        for spelling in ("6041", "6041h:0", "6041:00", "0x6041:00", "24641", "362460"):
            answer = self.succeed("wrist/read_object", "6041", object=spelling)
            self.assertEqual(len(answer.bytes), 2)
            self.assertEqual(int(answer.number) & 0x4F, 0x40)  # switch on disabled

    def test_read_of_text(self):
        text = "Generic CiA 402 servo"  # config/simulated_drives/generic_cia402.yaml
        for spelling in ("1008:00", "1008h text"):
            answer = self.succeed("shoulder/read_object", "1008", object=spelling)
            self.assertEqual(answer.value, f'"{text}"')
            self.assertEqual(bytes(answer.bytes), text.encode())
            self.assertEqual(answer.raw, text.encode().hex(" ").upper())
            self.assertTrue(math.isnan(answer.number))

    def test_a_type_that_nobody_names_is_not_guessed(self):
        answer = self.succeed("shoulder/read_object", "4 bytes; its type is not known",
                              object="1018h:1")
        self.assertTrue(math.isnan(answer.number))
        vendor = int.from_bytes(answer.bytes, "little")
        answer = self.succeed("shoulder/read_object", object="1018h:1 u32")
        self.assertEqual(answer.number, vendor)

    def test_read_of_a_missing_object_tells_the_abort_in_words(self):
        self.refuse("shoulder/read_object", "shoulder|5FFF|does not exist", object="5FFF:00")

    def test_read_of_an_unknown_name_is_refused(self):
        self.refuse("shoulder/read_object", "shoulder|positon_actual", object="positon_actual")

    def test_write_by_name_and_by_index(self):
        before = self.succeed("shoulder/read_object", object="following_error_window").number
        self.succeed("shoulder/write_object", "shoulder|6065", object="following_error_window",
                     value="123456")
        self.assertEqual(self.succeed("shoulder/read_object", object="6065").number, 123456)
        self.succeed("shoulder/write_object", object="6065:00", value=hex(int(before)))
        self.assertEqual(self.succeed("shoulder/read_object", object="6065").number, before)

    def test_write_to_a_read_only_object_tells_the_abort_in_words(self):
        self.refuse("shoulder/write_object", "shoulder|statusword|read-only", object="statusword",
                    value="1")

    def test_write_of_nonsense_is_refused_before_it_is_sent(self):
        self.refuse("shoulder/write_object", "shoulder|fast", object="following_error_window",
                    value="fast")
        self.refuse("shoulder/write_object", "300", object="homing_method", value="300")

    def test_damiao_floats_are_read_as_numbers(self):
        answer = self.succeed("gripper/read_object", "gripper", object="position_actual")
        self.assertAlmostEqual(answer.number, self.robot.position("gripper"), delta=1e-3)

    def test_outputs_are_set_by_name_and_the_others_kept(self):
        self.succeed("shoulder/set_digital_outputs", "shoulder|do1 on, do3 on",
                     names=["do1", "do3"], values=[True, True])
        self.succeed("shoulder/set_digital_outputs", names=["do1"], values=[False])
        answer = self.succeed("shoulder/read_object", object="digital_outputs")
        self.assertEqual(int(answer.number), 0x00040000)
        self.refuse("shoulder/set_digital_outputs", "do99|do1, ", names=["do99"], values=[True])

    def test_touch_probe_without_an_edge_ends_at_its_deadline(self):
        answer = self.refuse("shoulder/arm_touch_probe", "shoulder|touch probe 2|rising",
                             probe=2, edge="rising", timeout=0.2)
        self.assertTrue(math.isnan(answer.rising) and math.isnan(answer.falling))
        function = self.succeed("shoulder/read_object", object="touch_probe_function")
        self.assertEqual(function.number, 0)


if __name__ == "__main__":
    main("objects")
