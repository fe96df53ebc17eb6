#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/convert_ros_canopen: conversion formulas become counts, units and torques, or are named."""
import pathlib
import unittest

import yaml

from ros_canopen_files import BUS, NODES, SERVO, Case, eds

CONVERTED, APPROXIMATED, NONE = "converted", "approximated", "no counterpart"


class Formulas(Case):
    def test_the_defaults_are_millidegrees(self):
        self.assertEqual(self.convert().axis()["counts_per_turn"], 360000)

    def test_counts_gear_and_sign(self):
        axis = self.with_defaults("  pos_to_device: rint(-pos * 4096 * 21 / (2 * pi))\n"
                                  "  pos_from_device: obj6064 * -2 * pi / (4096 * 21)\n").axis()
        self.assertEqual((axis["counts_per_turn"], axis["direction"]), (86016, -1))  # 4096 * 21

    def test_a_gear_that_is_told_takes_its_part(self):
        axis = self.with_defaults("  pos_to_device: rint(rad2deg(pos)*3200*26/360)\n"
                                  "  pos_from_device: deg2rad(obj6064*360/3200/26)\n",
                                  "--gear", "shoulder=26").axis()
        self.assertEqual((axis["counts_per_turn"], axis["gear_ratio"]), (3200, 26))

    def test_an_offset_is_the_position_where_the_drive_says_0(self):
        axis = self.with_defaults("  pos_to_device: rint(1000*pos - 500)\n"
                                  "  pos_from_device: (obj6064 + 500) / 1000\n").axis()
        self.assertEqual(axis["position_offset"], 0.5)
        self.assertAlmostEqual(axis["counts_per_turn"], 6283.18530718, 8)  # 2 pi * 1000

    def test_metres(self):
        axis = self.with_defaults("  pos_to_device: rint(pos*1000000*2)\n"
                                  "  pos_from_device: obj6064/1000000/2\n",
                                  "--type", "shoulder=prismatic").axis()
        self.assertEqual((axis["type"], axis["counts_per_turn"], axis["lead"]),
                         ("prismatic", 2000000, 1))

    def test_formulas_that_contradict_each_other_are_told(self):
        converted = self.with_defaults("  pos_to_device: pos*1000\n  pos_from_device: obj6064/2000\n")
        self.told(converted, NONE, "defaults/pos_to_device", "1000 counts per rad", "2000")
        self.assertAlmostEqual(converted.axis()["counts_per_turn"], 12566.3706144, 7)  # 2 pi * 2000

    def test_the_default_towards_the_drive_contradicts_a_lone_formula(self):
        self.told(self.with_defaults("  pos_from_device: obj6064/2000\n"), NONE, "pos_from_device",
                  "not the inverse of the default")

    def test_what_is_more_than_a_factor_is_named_with_the_reason(self):
        for formula, reason in (("norm(obj6064, -100, 100)", "wraps"),
                                ("smooth(obj6064, x, 0.3)", "filters"),
                                ("avg(obj6064, p1)", "mean"), ("sin(obj6064)", "`sin` is no factor"),
                                ("obj6064 > 5 ? 1 : obj6064", "compares"), ("p = obj6064", "remembers"),
                                ("obj6064 * obj606C", "multiplies"), ("obj6064^2", "power"),
                                ("1 / obj6064", "below"), ("obj6064 + obj606C", "two numbers"),
                                ("obj6064 / 0", "divides by 0"), ("abs(obj6064)", "loses the sign"),
                                ("5", "always the same"), ("obj6063 / 10", "6064h"),
                                ("0 * obj6064", "factor 0")):
            converted = self.with_defaults(f"  pos_from_device: \"{formula}\"\n")
            self.told(converted, NONE, "driver.yaml:7: defaults/pos_from_device", reason)

    def test_without_a_formula_that_tells_the_loader_asks_for_the_counts(self):
        converted = self.with_defaults("  pos_from_device: norm(obj6064, 0, 9)\n"
                                       "  pos_to_device: sin(pos)\n")
        self.assertNotIn("counts_per_turn", converted.axis())
        self.assertIn("# counts_per_turn: give it", converted.text)

    def test_rounding_on_the_way_is_told(self):
        converted = self.with_defaults("  pos_to_device: 262144*rint(rad2deg(pos))/360\n"
                                       "  pos_from_device: deg2rad(360*obj6064/262144)\n")
        self.assertEqual(converted.axis()["counts_per_turn"], 262144)
        self.told(converted, APPROXIMATED, "pos_to_device", "rounds on the way")

    def test_device_units_that_are_handed_through_are_told(self):
        converted = self.with_defaults("  pos_to_device: pos\n  pos_from_device: obj6064\n")
        self.told(converted, APPROXIMATED, "pos_to_device", "as if they were rad")

    def test_syntax_errors_are_refused_with_their_place(self):
        for formula, part in (("2*(pos", "`)` is missing"), ("pos pos", "nothing more may follow"),
                              ("turn(pos)", "no function `turn`"), ("pos*", "ends where"),
                              ("norm(pos)", "takes 3"), ("pos $ 2", "`$ 2`"), ("", "it is empty"),
                              ("3 = pos", "only a variable"), ("(" * 200 + "pos", "nested too deep"),
                              ("+".join(["pos"] * 400), "more than 300 parts")):
            defaults = f"defaults: {{eds_file: servo.eds, pos_to_device: \"{formula}\"}}\n"
            self.refused(BUS + defaults + NODES,
                         "driver.yaml:5: defaults/pos_to_device", part, "mend it")

    def test_nothing_of_a_formula_is_run(self):
        self.refused(BUS + "defaults: {eds_file: servo.eds, pos_to_device: __import__('os')}\n" + NODES,
                     "is no formula")

    def test_efforts_give_the_rated_torque(self):
        formula = "  eff_from_device: obj6077/1000.0*2.5\n"
        self.assertEqual(self.with_defaults(formula).axis()["rated_torque"], 2.5)
        axis = self.with_defaults(formula, "--gear", "shoulder=50").axis()
        # 2.5 / 50, 360000 / 50
        self.assertEqual((axis["rated_torque"], axis["counts_per_turn"]), (0.05, 7200))
        axis = self.with_defaults(formula, "--type", "shoulder=prismatic").axis()
        self.assertAlmostEqual(axis["rated_torque"], 0.397887357730, 11)  # 2.5 N * 1 m / (2 pi)

    def test_efforts_of_other_objects_have_no_counterpart(self):
        converted = self.with_defaults("  eff_from_device: obj6078/1000*9\n")
        self.assertNotIn("rated_torque", converted.axis())
        self.told(converted, NONE, "eff_from_device", "obj6078", "6077h")
        self.told(self.with_defaults("  eff_from_device: \"0\"\n"), CONVERTED, "eff_from_device",
                  "no efforts")
        self.told(self.with_defaults("  eff_from_device: obj6077 + 3\n"), NONE, "eff_from_device",
                  "offset")


class Velocities(Case):
    CONTROLLER = "wheel: {type: velocity_controllers/JointVelocityController, joint: shoulder, " \
                 "required_drive_mode: %d}\n"
    # 4096 counts per turn of the motor, 50 of these per turn of the joint; speeds in rpm of the motor
    RPM = """  pos_to_device: pos*4096*50/(2*pi)
  pos_from_device: obj6064*2*pi/4096/50
  vel_to_device: rint(vel*50*60/(2*pi))
  vel_from_device: obj606C*2*pi/60/50
"""

    def profile(self, defaults, number):
        self.write("driver.yaml", BUS + "defaults:\n  eds_file: servo.eds\n" + defaults + NODES
                   + self.CONTROLLER % number)
        converted = self.run_script("--output", "robot.yaml", "driver.yaml")
        self.assertIn(converted.status, (0, 1), converted.report)
        robot = yaml.safe_load((self.folder / "robot.yaml").read_text(encoding="utf-8"))
        drive = robot["axes"]["shoulder"]["drive"]
        if not drive.startswith("/"):
            return drive
        return yaml.safe_load(pathlib.Path(drive).read_text(encoding="utf-8"))

    def test_counts_per_second_need_nothing(self):
        self.assertEqual(self.profile("", 3), "generic_cia402")

    def test_another_unit_is_a_profile_of_its_own(self):
        profile = self.profile(self.RPM, 3)
        self.assertEqual(profile["name"], "robot_drive")
        self.assertEqual(profile["units"]["velocity"]["unit"], "count/s")
        # 1 rpm of the motor is 4096 / 60 counts/s
        self.assertAlmostEqual(profile["units"]["velocity"]["scale"], 68.2666666667, 9)
        self.assertEqual(profile["units"]["acceleration"]["unit"], "count/s^2")
        self.assertEqual(profile["objects"]["target_velocity"]["object"], "60FF:00")

    def test_on_standard_output_the_profile_is_missing_and_named(self):
        converted = self.with_defaults(self.RPM)
        self.assertEqual((converted.status, converted.axis()["drive"]), (1, "robot_drive"))
        self.told(converted, NONE, "robot_drive.yaml", "velocity in 68.2666667 count/s",
                  "--output FILE")

    def test_velocity_mode_has_a_unit_of_its_own(self):
        objects = dict(SERVO, **{})
        objects.update({(0x6042, 0): (3, "rw"), (0x6043, 0): (3, "ro")})
        self.write("servo.eds", eds(objects))
        profile = self.profile("  vel_to_device: rint(rad2deg(vel)*250)\n", 2)
        self.assertEqual(profile["units"]["velocity"], "count/s")
        # 1000 counts per degree, 250 units of 6042h per degree/s
        self.assertEqual(profile["objects"]["vl_target_velocity"]["unit"],
                         {"unit": "count/s", "scale": 4})

    def test_measured_velocities_may_have_another_unit(self):
        profile = self.profile("  vel_from_device: deg2rad(obj606C)/100\n", 3)
        self.assertEqual(profile["units"]["velocity"], "count/s")
        # a hundredth of a degree/s is 10 counts/s
        self.assertEqual(profile["objects"]["velocity_actual"]["unit"],
                         {"unit": "count/s", "scale": 10})

    def test_formulas_that_are_not_meant_are_named(self):
        converted = self.with_defaults("  vel_to_device: vel\n  vel_from_device: obj606C\n")
        self.assertEqual(converted.axis()["drive"], "generic_cia402")
        self.told(converted, NONE, "vel_from_device", "taken as not said")
        self.told(self.with_defaults("  vel_from_device: -deg2rad(obj606C)/1000\n"), NONE,
                  "vel_from_device",
                  "turns the other way")
        self.told(self.with_defaults("  vel_from_device: deg2rad(obj606C)/1000 + 1\n"), NONE,
                  "vel_from_device",
                  "offset")
        self.told(self.with_defaults("  vel_to_device: rad2deg(vel)*250\n"), NONE, "vel_to_device",
                  "no controller in the files commands velocities")

    def test_speeds_in_an_unknown_unit_are_written_as_they_are(self):
        converted = self.with_defaults("  vel_to_device: vel\n  vel_from_device: obj606C\n"
                                       "  dcf_overlay: {\"607F\": \"5000\", \"6098\": \"17\", "
                                       "\"6099sub1\": \"8\"}\n")
        self.assertEqual(converted.axis()["write"],
                         [{"object": "607F:00", "raw": 5000}, {"object": "6099:01", "raw": 8}])
        self.assertEqual(converted.axis()["homing"], {"method": 17})

    def test_torque_modes_take_the_unit_of_targets(self):
        objects = dict(SERVO)
        objects[(0x6071, 0)] = (3, "rw")
        self.write("servo.eds", eds(objects))
        more = self.CONTROLLER.replace("velocity", "effort") % 10
        axis = self.with_defaults("  eff_to_device: rint(eff*400)\n", more=more).axis()
        # 1000 units / 400
        self.assertEqual((axis["mode"], axis["rated_torque"]), ("cyclic_torque", 2.5))
        converted = self.with_defaults("  eff_to_device: rint(eff)\n", more=more)
        self.told(converted, APPROXIMATED, "eff_to_device", "makes rated_torque 1000")
        self.told(self.with_defaults("  eff_to_device: eff*400\n  eff_from_device: obj6077/500\n",
                                     more=more), NONE,
                  "eff_to_device", "says 2.5", "eff_from_device 2")


if __name__ == "__main__":
    unittest.main()
