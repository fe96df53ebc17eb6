#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""save_parameters, restore_parameters and nmt by service."""
from robot_client import RobotTest, main, wait_until

OBJECT = "6066:00"  # following error time out


class Parameters(RobotTest):
    def tearDown(self):
        self.succeed("disable")

    def read(self):
        return self.succeed("shoulder/read_object", object=OBJECT).number

    def test_saved_values_outlive_the_power_and_restoring_undoes_it(self):
        factory = self.read()
        self.succeed("shoulder/write_object", object=OBJECT, value=str(int(factory) + 7))
        self.succeed("shoulder/save_parameters", "shoulder|1010:01 (all parameters)")
        boots = self.robot.node("shoulder").boot_ups
        self.succeed("inject_fault", axis="shoulder", fault="power_cycle")
        wait_until(lambda: self.robot.node("shoulder").boot_ups > boots
                   and self.robot.node("shoulder").ready, "power-cycled and ready")
        self.assertEqual(self.read(), factory + 7)
        self.succeed("shoulder/restore_parameters", "shoulder|1011:01|reset|disabled")
        self.assertEqual(self.read(), factory)
        self.robot.wait_state("shoulder", "switch on disabled")

    def test_a_factory_reset_wants_to_be_confirmed(self):
        factory = self.read()
        self.succeed("shoulder/write_object", object=OBJECT, value=str(int(factory) + 7))
        self.refuse("shoulder/factory_reset", "shoulder|nothing was restored|by 1011h|confirm: true")
        self.assertEqual(self.read(), factory + 7)
        self.succeed("shoulder/factory_reset", "shoulder|1011:01|reset|disabled", confirm=True)
        self.assertEqual(self.read(), factory)

    def test_all_axes_at_once(self):
        self.succeed("save_parameters", "save_parameters done on 4 of 4 axes")

    def test_an_enabled_axis_is_refused(self):
        self.succeed("wrist/enable")
        for name in ("wrist/save_parameters", "wrist/restore_parameters"):
            self.refuse(name, "wrist|not disabled (operation enabled)|disable it first")
        for word in ("stop", "pre_operational", "reset_node", "reset_communication"):
            self.refuse("wrist/nmt", "wrist|not disabled|quick_stop or disable", command=word)
            self.refuse("nmt", "wrist|not disabled", command=word)
        self.assertEqual(self.robot.axis("wrist").state, "operation enabled")

    def test_nmt_stop_and_start_of_one_node(self):
        self.succeed("wrist/nmt", "wrist|the drive is stopped", command="stop")
        wait_until(lambda: self.robot.node("wrist").nmt_state == "stopped", "shown as stopped")
        self.assertTrue(self.robot.node("shoulder").ready)
        self.refuse("wrist/enable", "wrist|stop")
        self.succeed("wrist/nmt", "configured and operational", command="start")
        self.succeed("wrist/enable")

    def test_nmt_reset_of_all_nodes(self):
        self.succeed("nmt", "reset_communication done on 4 of 4 nodes",
                     command="reset_communication")

    def test_unknown_nmt_command(self):
        self.refuse("nmt", "halt|pre_operational|reset_node", command="halt")


if __name__ == "__main__":
    main("parameters")
