#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/convert_ros_canopen makes a robot's file of ros_canopen's and names what it leaves out."""
import math
import unittest

import yaml

from ros_canopen_files import BUS, DEFAULTS, NODES, Case, eds

CONVERTED, APPROXIMATED, NONE = "converted", "approximated", "no counterpart"


class Bus(Case):
    def test_bus_sync_and_heartbeat_become_bus(self):
        bus = self.convert().robot["bus"]
        self.assertEqual(bus, {"interface": "can1", "bitrate": 1000000, "sync_period": 0.01,
                               "sync_counter": 0,
                               "node_id": 127, "heartbeat": 0.05})  # 20 Hz; 0x77F is node 0x7F

    def test_all_of_a_plain_configuration_has_a_counterpart(self):
        converted = self.with_defaults("  dcf_overlay: {\"6098\": \"35\"}\n")
        self.assertEqual((converted.status, converted.lines(NONE)), (0, []))

    def test_sync_with_a_counter_of_an_external_master(self):
        text = BUS.replace("SimpleMaster", "ExternalMaster").replace("overflow: 0", "overflow: 20")
        bus = self.convert(text + DEFAULTS + NODES).robot["bus"]
        self.assertEqual((bus["sync"], bus["sync_counter"]), ("external", 20))

    def test_update_ms_is_the_period_where_there_is_no_sync(self):
        converted = self.convert("update_ms: 25\nsync: {interval_ms: 0}\n" + DEFAULTS + NODES)
        self.assertEqual(converted.robot["bus"]["sync_period"], 0.025)
        self.told(converted, APPROXIMATED, "driver.yaml:1", "update_ms", "no cycle without SYNC")

    def test_what_a_launch_file_gives_is_named(self):
        converted = self.convert(DEFAULTS + NODES)
        self.assertEqual(converted.robot["bus"]["interface"], "can0")
        for part in ("bus/device", "sync/interval_ms", "heartbeat", "bus/bitrate",
                     "type of shoulder, elbow"):
            self.told(converted, APPROXIMATED, part)

    def test_a_heartbeat_that_is_no_whole_number_of_milliseconds_is_rounded_and_told(self):
        text = BUS.replace("rate: 20", "rate: 3").replace("77f", "77e")
        converted = self.convert(text + DEFAULTS + NODES)
        bus = converted.robot["bus"]
        self.assertEqual((bus["heartbeat"], bus["node_id"]), (0.333, 126))  # 1/3 s; 0x77E
        self.told(converted, APPROXIMATED, "heartbeat/rate", "0.333 s")

    def test_the_master_gets_no_node_id_of_a_drive(self):
        converted = self.convert(BUS + DEFAULTS + "nodes: {a: {id: 127}, b: {id: 126}}\n")
        self.assertEqual(converted.robot["bus"]["node_id"], 125)
        self.told(converted, APPROXIMATED, "bus/node_id", "127 is that of a drive")

    def test_what_no_bus_here_has_is_named(self):
        text = BUS.replace("device: can1,",
                           "device: can1, loopback: true, master_type: x, error_mask: {a: true},")
        text = text.replace("SocketCANInterface", "OtherInterface")
        text = text.replace("SimpleMaster", "OtherMaster")
        text = text.replace("overflow: 0", "overflow: 0, silence_us: 5").replace("77f#05", "123#05")
        converted = self.convert(text + DEFAULTS + NODES)
        self.assertEqual(converted.status, 1)
        for part in ("loopback", "master_type", "error_mask", "driver_plugin", "master_allocator",
                     "silence_us",
                     "heartbeat/msg"):
            self.told(converted, NONE, part)

    def test_the_dummy_interface_is_the_simulation(self):
        converted = self.convert(BUS.replace("SocketCANInterface", "DummyInterface") + DEFAULTS + NODES)
        self.assertEqual(converted.robot["bus"]["interface"], "sim")

    def test_bit_rate_of_a_dcf_and_of_the_command_line(self):
        self.write("servo.eds", eds() + "\n[DeviceComissioning]\nNodeID=9\nBaudrate=500\n")
        converted = self.convert()
        self.assertEqual(converted.robot["bus"]["bitrate"], 500000)
        self.told(converted, APPROXIMATED, "Baudrate", "ros_canopen does not heed it")
        self.told(converted, APPROXIMATED, "NodeID 9", "`id` counts")
        self.assertEqual(self.convert(BUS + DEFAULTS + NODES, "--bitrate",
                                      "250000").robot["bus"]["bitrate"], 250000)

    def test_refusals(self):
        rest = DEFAULTS + NODES
        self.refused(BUS.replace("interval_ms: 10", "interval_ms: ten") + rest, "driver.yaml:3",
                     "sync/interval_ms",
                     "`ten`", "must be a number")
        self.refused(BUS.replace("overflow: 0", "overflow: 1") + rest, "sync/overflow", "0 or 2 to 240")
        self.refused(BUS.replace("overflow: 0", "overflow: 241") + rest, "sync/overflow",
                     "from 0 to 240")
        self.refused(BUS.replace("rate: 20", "rate: 0") + rest, "heartbeat/rate", "greater than 0")
        self.refused(BUS.replace("rate: 20", "rate: 0.01") + rest, "heartbeat/rate", "65.535 s at most")
        self.refused(BUS.replace("77f#05", "77f5") + rest, "heartbeat/msg", "`77f5`", "77f#05")
        self.refused(BUS.replace("can1", "a_name_too_long_") + rest, "bus/device", "at most 15 letters")
        self.refused(BUS.replace("can1", "$(arg can)") + rest, "bus/device", "roslaunch fills in")
        self.refused(BUS.replace("can1", "can1, loopback: 7") + rest, "bus/loopback", "true or false")


class Nodes(Case):
    def test_a_mapping_of_nodes(self):
        axis = self.convert().axis()
        self.assertEqual({key: axis[key] for key in ("node_id", "drive", "eds", "type",
                                                     "counts_per_turn")},
                         {"node_id": 3, "drive": "generic_cia402",
                          "eds": str(self.folder / "servo.eds"),
                          # millidegrees: 1000 in each of 360
                          "type": "revolute", "counts_per_turn": 360000})

    def test_a_list_of_nodes_with_names_and_joints(self):
        converted = self.convert(BUS + DEFAULTS + "nodes: [{name: m-1, id: 0x0A, joint: knee}]\n")
        self.assertEqual((converted.axis("m_1")["node_id"], converted.axis("m_1")["joint"]),
                         (10, "knee"))
        self.told(converted, APPROXIMATED, "nodes[0]/name", "`m-1`", "the axis is called m_1")

    def test_modules_is_the_old_name_of_nodes(self):
        converted = self.convert(BUS + DEFAULTS + "modules: {knee: {id: 7}}\n")
        self.assertEqual(converted.axis("knee")["node_id"], 7)

    def test_anchors_merge_keys_and_defaults(self):
        text = """
defaults: {eds_file: servo.eds, dcf_overlay: {"6083": "10", "6084": "20"}}
wheel: &wheel
  dcf_overlay: {"6083": "11"}
  pos_to_device: "rint(pos*100)"
  pos_from_device: "obj6064/100"
nodes:
  left: {<<: *wheel, id: 1}
  right: {<<: [*wheel], id: 2, dcf_overlay: {"6084": "22"}}
"""
        converted = self.convert(BUS + text)
        writes = {name: {entry["object"]: entry["raw"] for entry in converted.axis(name)["write"]}
                  for name in ("left", "right")}
        # A merge key is flat: its dcf_overlay gives way to the node's; `defaults` fills in by key.
        self.assertEqual(writes, {"left": {"6083:00": 11, "6084:00": 20}, "right": {"6083:00": 10,
                                                                                    "6084:00": 22}})
        self.assertAlmostEqual(converted.axis("left")["counts_per_turn"], 200 * math.pi, 8)
        self.told(converted, CONVERTED, "driver.yaml:8: wheel/dcf_overlay/6083")

    def test_several_files_merge_as_roslaunch_loads_them(self):
        self.write("bus.yaml", BUS + "nodes: {shoulder: {dcf_overlay: {\"6083\": \"7\"}}}\n")
        self.write("driver.yaml", "bus/device: can5\n" + DEFAULTS + NODES)
        converted = self.run_script("bus.yaml", "driver.yaml")
        self.assertEqual(converted.robot["bus"]["interface"], "can5")
        self.assertEqual(converted.axis()["write"], [{"object": "6083:00", "raw": 7}])
        self.told(converted, CONVERTED, "bus.yaml:2: bus/device: `can1`",
                  "another value is given in its place")

    def test_a_key_given_twice_is_told(self):
        converted = self.convert(BUS + DEFAULTS + "nodes: {a: {id: 1, id: 2}}\n")
        self.assertEqual(converted.axis("a")["node_id"], 2)
        self.told(converted, APPROXIMATED, "nodes/a/id: `1`", "given twice")

    def test_keys_that_nobody_reads_are_named_with_their_place(self):
        converted = self.convert(BUS + DEFAULTS + "nodes: {a: {id: 1, brake: {x: 5, y: [1, 2]}}}\n"
                                 "other: word\n")
        self.told(converted, NONE, "driver.yaml:7: nodes/a/brake", "x=5, y=[1, 2]")
        self.told(converted, NONE, "driver.yaml:8: other: `word`")
        self.assertIn("# - driver.yaml:8: other: `word`", converted.text)

    def test_an_eds_in_a_package(self):
        text = BUS + "defaults: {eds_pkg: arm, eds_file: /eds/a.eds}\n" + NODES
        self.write("elsewhere/package.xml", "<package><name>arm</name></package>")
        self.write("elsewhere/eds/a.eds", eds())
        self.refused(text, "driver.yaml:5: defaults/eds_pkg: `arm`", "--package arm=FOLDER")
        converted = self.convert(text, "--package", "arm=elsewhere")
        self.assertEqual(converted.axis()["eds"], "package://arm/eds/a.eds")
        self.write("elsewhere/config/driver.yaml", text)
        self.assertEqual(self.run_script("elsewhere/config/driver.yaml").axis()["eds"],
                         "package://arm/eds/a.eds")

    def test_a_device_that_is_no_drive_is_left_out(self):
        self.write("sensor.eds", eds({(0x1000, 0): (7, "ro"), (0x2018, 0): (5, "ro")}))
        text = BUS + DEFAULTS + "nodes: {a: {id: 1}, line: {id: 10, eds_file: sensor.eds}}\n"
        converted = self.convert(text)
        self.assertEqual(list(converted.robot["axes"]), ["a"])
        self.told(converted, NONE, "nodes/line", "sensor.eds has no 6040h")
        self.refused(BUS + "nodes: {line: {id: 10, eds_file: sensor.eds}}\n", "no node is a drive")

    def test_refusals(self):
        head = BUS + DEFAULTS
        self.refused(head, "has no `nodes`")
        self.refused("", "has no `nodes`")
        self.refused(head + "nodes: {}\n", "holds no node")
        self.refused(head + "nodes: 5\n", "driver.yaml:7: nodes", "must be a mapping")
        self.refused(head + "nodes: {a: 5}\n", "nodes/a", "must be a mapping")
        self.refused(head + "nodes: {a: {}}\n", "driver.yaml:7: nodes/a", "has no `id`")
        self.refused(head + "nodes: {a: {id: 128}}\n", "nodes/a/id", "`128`", "1 to 127")
        self.refused(head + "nodes: {a: {id: x}}\n", "nodes/a/id", "`x`", "must be a number")
        self.refused(head + "nodes: {a: {id: 3}, b: {id: 3}}\n", "nodes/b: id `3` is that of nodes/a")
        self.refused(head + "nodes: [{name: a, id: 3}, {name: a, id: 4}]\n", "name `a`")
        self.refused(head + "nodes: [{id: 3}]\n", "nodes[0]", "has no `name`")
        self.refused(head + "nodes: {a: {id: 3, joint: c}, b: {id: 4, joint: c}}\n", "joint `c`")
        self.refused(BUS + NODES, "nodes/shoulder", "has no `eds_file`")
        self.refused(BUS + "defaults: {eds_file: none.eds}\n" + NODES, "defaults/eds_file",
                     "`none.eds`")
        self.refused(BUS + "defaults: 3\n" + NODES, "defaults", "must be a mapping")
        self.write("arm/package.xml", "<package><name>arm</name></package>")
        self.refused(BUS + "defaults: {eds_pkg: arm, eds_file: no.eds}\n" + NODES, "no file", "no.eds")

    def test_yaml_that_is_none_is_refused(self):
        self.refused("a: [1", "driver.yaml", "is no YAML")
        self.refused("a: 1\n---\nb: 2\n", "is no YAML")
        self.refused("[1, 2]", "must be a mapping")
        self.refused("a: &x [*x]\n", "an anchor holds itself")
        self.refused("<<: 5\n", "`<<` takes a mapping")
        self.refused("? [1]\n: 2\n", "a key must be a text")
        self.refused("a: !thing 5\n", "tag `!thing`")
        self.refused("a: deg(x)\n", "`deg(x)` is no angle")
        self.refused("[" * 3000, "driver.yaml")
        self.write("driver.yaml", b"a: \xff\n")
        converted = self.run_script("driver.yaml")
        self.assertEqual(converted.status, 2)
        self.assertIn("is not UTF-8", converted.report)
        self.assertIn("cannot be read", self.run_script("missing.yaml").report)

    def test_command_line(self):
        self.write("driver.yaml", BUS + DEFAULTS + NODES)
        self.assertIn("Usage:", self.run_script("--help").text)
        for arguments, part in (((), "no file is given"),
                                (("--color", "x"), "unknown option `--color`"),
                                (("--urdf",), "--urdf needs a value"),
                                (("--type", "a=round"), "must be one of"),
                                (("--type", "a"), "NAME=VALUE"), (("--gear", "a=-1"), "greater than 0"),
                                (("--bitrate", "7"), "must be one of"),
                                (("--gear", "hip=2", "driver.yaml"), "there is no joint `hip`"),
                                (("--output", "no/robot.yaml", "driver.yaml"), "cannot be written"),
                                (("--output", "servo.eds", "driver.yaml"), "not by this script")):
            converted = self.run_script(*arguments)
            self.assertEqual(converted.status, 2, arguments)
            self.assertIn(part, converted.report)


class Layers(Case):
    def test_a_motor_layer_as_here(self):
        converted = self.with_defaults("  dcf_overlay: {\"6098\": \"35\"}\n  motor_allocator: "
                                       "canopen::Motor402::Allocator\n"
                                       "  motor_layer: {switching_state: 5, monitor_mode: true}\n")
        self.assertEqual(converted.status, 0)

    def test_modes_changed_while_disabled_and_slow_transitions_are_a_profile(self):
        self.write("driver.yaml",
                   BUS + "defaults: {eds_file: servo.eds, dcf_overlay: {\"6098\": \"35\"}, "
                   "motor_layer: "
                   "{switching_state: 2, state_switch_timeout: 8}}\n" + NODES)
        self.assertEqual(self.run_script("--output", "my-robot.yaml", "driver.yaml").status, 0)
        profile = yaml.safe_load((self.folder / "my_robot_drive.yaml").read_text(encoding="utf-8"))
        self.assertEqual((profile["mode_change"], profile["timing"]["state_change"]), ("disabled", 8))
        robot = yaml.safe_load((self.folder / "my-robot.yaml").read_text(encoding="utf-8"))
        self.assertEqual(robot["axes"]["elbow"]["drive"], str(self.folder / "my_robot_drive.yaml"))

    def test_what_has_no_counterpart(self):
        converted = self.with_defaults("  motor_allocator: other::Allocator\n  switching_state: 2\n"
                                       "  motor_layer: {switching_state: 6, monitor_mode: false, "
                                       "torch: 1}\n"
                                       "  position_filters: [{name: a, type: b}]\n"
                                       "  pos_unit_factor: 3\n"
                                       "  log: [\"6041\"]\n  publish: [\"6041!\", \"2018\"]\n")
        for part in ("motor_allocator", "defaults/switching_state", "motor_layer/switching_state",
                     "monitor_mode",
                     "motor_layer/torch", "position_filters", "pos_unit_factor", "no topic has 2018"):
            self.told(converted, NONE, part)
        self.told(converted, APPROXIMATED, "defaults/publish", "6041: statusword of ~axis_states")
        self.told(converted, APPROXIMATED, "defaults/log")

    def test_refusals(self):
        for text, part in (("publish: [word]", "`word`, which is no object"),
                           ("publish: 5", "must be a list"),
                           ("motor_layer: 5", "must be a mapping"), ("eds_pkg: [a]", "must be a text"),
                           ("motor_layer: {switching_state: 9}", "from 0 to 8")):
            self.refused(BUS + f"defaults: {{eds_file: servo.eds, {text}}}\n" + NODES,
                         "driver.yaml:5: defaults/", part)


if __name__ == "__main__":
    unittest.main()
