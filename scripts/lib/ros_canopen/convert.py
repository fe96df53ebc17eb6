# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""A configuration of ros_canopen as a robot's file, and a report of what became of each key."""
import math
import pathlib

from . import publish
from .bus import Bus
from .controllers import Controllers
from .drives import GENERIC, OwnProfile, profiles
from .limits import Urdf
from .nodes import Descriptions, Packages, check_modes, convert_motor, describe, find_type, nodes_of
from .objects import text_of
from .output import Section, number_text, one_line, quoted
from .refusal import Refusal
from .report import NONE, Report, sweep
from .tree import load, merged

_NOT_THERE = "ros_canopen does not take it any more, either"
_OF_MOTOR_LAYER = ("ros_canopen reads it below `motor_layer` alone, so it counted for nothing", "")
_ERRORS_COUNT = ("the driver heeds all errors of the interface", "see the diagnostics of the bus")
_UNFILTERED = ("feedback is shown as the drive tells it", "filter joint_states where you read them")
_LOOPS = "the drive closes the loops"

HINTS = {
    "hardware_id": ("the diagnostics tell the serial number of each drive", ""),
    "use_realtime_period": ("the cycle is that of SYNC, always", "leave it out"),
    "master_type": (_NOT_THERE, "leave it out"),
    "error_mask": _ERRORS_COUNT,
    "fatal_error_mask": _ERRORS_COUNT,
    "trace": ("there is no dummy interface here",
              "the flight recorder writes what was on the bus"),
    "switching_state": _OF_MOTOR_LAYER,
    "monitor_mode": _OF_MOTOR_LAYER,
    "state_switch_timeout": _OF_MOTOR_LAYER,
    "name": ("no ros_canopen node reads it here",
             "the argument `name` of bus.launch names the node"),
    "joint_names": ("no ros_canopen node reads it", "the joints are those of `axes`"),
    "max_command_silence": ("belongs to another node (cob_control_mode_adapter)",
                            "`command_timeout` of an axis ends a stream of velocities or efforts; "
                            "modes are changed by `set_mode`"),
    "state_publish_rate": ("~<group>/state comes at joint_state_rate", ""),
    "action_monitor_rate": ("the action tells its feedback at 20 Hz", ""),
    "gains": (_LOOPS, "gains are in the drive"),
    "velocity_ff": (_LOOPS, "`feed_forward` of an axis, where the drive has offsets"),
    "position_filters": _UNFILTERED,
    "velocity_filters": _UNFILTERED,
    "effort_filters": _UNFILTERED,
    "pos_unit_factor": (_NOT_THERE, "write pos_to_device and pos_from_device"),
    "vel_unit_factor": (_NOT_THERE, "write vel_to_device and vel_from_device"),
    "eff_unit_factor": (_NOT_THERE, "write eff_to_device and eff_from_device"),
    "enforce_limits": ("limits always count here", ""),
    "extra_joints": ("joint_states has the joints of the axes alone",
                     "publish others by a node of their own"),
    "braketest_required": ("there is no test of brakes here", "it belongs to the maker's node"),
    "required_drive_mode": ("its joints are not known from the controller",
                            "give `modes` of the axes"),
}
HEAD = "Written by scripts/convert_ros_canopen"
SETTLED = {"reset_errors_before_recover": "recover always resets faults",
           "start_ctrl_on_recover": "there are no controllers to start"}


class Converted:
    """The robot's file, profiles of its own ({name: text}), the report, the exit status."""

    def __init__(self, text, own, report):
        self.text, self.own, self.report = text, own, report
        self.status = 1 if report.count(NONE) else 0


def _read(options, report):
    """(what all files say together, what each says)"""
    root, files = None, []
    for file in options.files:
        value, repeated = load(file, str(file))
        for old in repeated:
            report.about(old, "is given twice in one mapping; the last one counts, as in ros_canopen")
        files.append(value)
        root = value if root is None else merged(root, value)
    for key, text in SETTLED.items():
        if root.get(key) is not None:
            report.done(root.get(key), text)
    return root, files


def _nodes(root, options, report):
    """The nodes that are drives, with their EDS and their profile."""
    packages = Packages(options.packages, options.files)
    folders = [file.parent for file in options.files] + [pathlib.Path()]
    descriptions = Descriptions(packages, folders)
    known = profiles(options.profiles)
    nodes = [node for node in nodes_of(root, report) if describe(node, descriptions, known, report)]
    if not nodes:
        raise Refusal(f"{options.files[0]}: no node is a drive of CiA 402, so there is nothing to "
                      "drive; leave these devices to canopen_chain_node")
    urdf = Urdf(options.urdf, str(options.urdf)) if options.urdf is not None else None
    for names, option in ((options.types, "--type"), (options.gears, "--gear")):
        for name in names:
            if name not in {node.joint for node in nodes}:
                raise Refusal(f"{option} {name}=...: there is no joint `{name}`; there are "
                              + ", ".join(node.joint for node in nodes))
    untold = [node.joint for node in nodes
              if not find_type(node, options, urdf, root.get("joint_limits"), report)]
    if untold:
        report.about(("", "type "
                          "of " + ", ".join(untold)), "is in the URDF: taken as revolute; --urdf or "
                     "--type says otherwise")
    return nodes, known


def convert(options):
    """@param options: the script's. @return Converted; or Refusal"""
    report = Report()
    root, files = _read(options, report)
    bus = Bus(root, report, options.bitrate)
    nodes, known = _nodes(root, options, report)
    bus.settle(nodes)
    controllers = Controllers(root, nodes, report)
    axes, owners, taken = Section(), {}, []
    for node in nodes:
        check_modes(node, report)
        own = OwnProfile()
        convert_motor(node, bus, own, report)
        publish.convert(node, report)
        taken.append((node, own, node.objects.finish_homing(own)))
        _own_units(node, own, options.gears.get(node.joint), report)
    for node, own, homing in taken:
        name = _own_name(own, owners, options) if own.needed() and node.profile.generic() else None
        axes.add(quoted(node.axis), _axis(node, own, name, homing, options))
    texts = {name: own.text(known[GENERIC], name, ", ".join(file.name for file in options.files))
             for own, name in owners.values()}
    _tell_own(owners, options, report)
    groups = controllers.sections()
    for value in files:
        sweep(report, value, HINTS)
    return Converted(_file(options, bus, axes, groups, controllers.rate, report), texts, report)


# Profiles of their own

def _own_units(node, own, gear, report):
    """Units in which the drive differs from its profile."""
    scaling = node.scaling
    if scaling.position is None:
        return
    if not node.profile.generic():
        if node.profile.counts() and scaling.scale_of(scaling.velocity) is not None:
            report.none((node.place, f"{node.path}: "
                                     "velocities"), f"the formulas say {scaling.velocity:.9g} units "
                        f"per {scaling.unit}/s, and {node.profile.name} "
                        "counts/s", "the profile counts here; compare")
        return
    scale = scaling.scale_of(scaling.velocity)
    if scale is not None:
        own.units["velocity"] = ("count/s", scale)
        own.units["acceleration"] = ("count/s^2", scale)
    measured = scaling.scale_of(scaling.measured_velocity)
    if measured != scale:
        own.units["velocity_actual"] = ("count/s", measured or 1.0)
    if scaling.vl is not None:
        _vl_units(scaling, own, gear)


def _vl_units(scaling, own, gear):
    """Velocity mode counts in turns of the motor per minute, unless the formula says otherwise."""
    turns = 60 / (2 * math.pi)  # per minute, of 1 rad/s
    if gear is not None and scaling.unit == "rad" and abs(scaling.vl / (gear * turns) - 1) < 1e-3:
        return
    scale = abs(scaling.position) / scaling.vl
    for name in ("vl_target_velocity", "vl_velocity_demand", "vl_velocity_min", "vl_velocity_max"):
        own.units[name] = ("count/s", scale)
    for name in ("vl_acceleration", "vl_deceleration", "vl_quick_stop"):
        own.units[name] = ("count/s^2", scale)


def _own_name(own, owners, options):
    """Axes that differ in the same way share a profile."""
    if own.key() not in owners:
        name = f"{options.name}_drive" + (str(len(owners) + 1) if owners else "")
        owners[own.key()] = (own, name)
    return owners[own.key()][1]


def _tell_own(owners, options, report):
    for own, name in owners.values():
        what = [f"{key} in {scale:.9g} {unit}" for key, (unit, scale) in own.units.items()]
        what += [f"homing method {method}" for method in sorted(set(own.methods))]
        what += ["mode_change: disabled"] if own.disabled else []
        what += [f"timing/state_change {own.state_change:g} s"] if own.state_change is not None else []
        text = f"generic_cia402 but for: {', '.join(what)}"
        if options.output is not None:
            report.about((f"{name}.yaml", "drive"), f"{text}; look it over: accelerations are taken to "
                         "count as velocities do" if own.units else text)
        else:
            report.none((f"{name}.yaml", "drive"), f"a profile of its own is needed, {text}",
                        "give --output FILE, and it is written beside FILE")


# The file

def _axis(node, own, own_name, homing, options):
    axis = Section(f"{node.place} {node.path}")
    axis.add("node_id", str(node.id), "id")
    if own_name is None:
        axis.add("drive", node.profile.name, node.why_profile)
    else:
        folder = options.output.resolve().parent if options.output is not None else None
        axis.add("drive", quoted(f"{folder}/{own_name}.yaml" if folder else own_name), "generic_cia402 "
                 "with what differs; `package://name/path` goes, too")
    if node.eds_name is not None:
        axis.add("eds", quoted(node.eds_name),
                 "eds_pkg, eds_file" if node.get("eds_pkg") else "eds_file")
    if node.joint != node.axis:
        axis.add("joint", quoted(node.joint), "joint")
    axis.add("type", node.type, node.type_from)
    gear = options.gears.get(node.joint)
    if node.profile.counts():
        for key, number, comment in node.scaling.geometry(gear):
            axis.add(key, number_text(number), comment)
        if node.scaling.position is None:
            axis.note("counts_per_turn: give it, and gear_ratio: the formulas do not tell")
    if node.scaling.sign() < 0:
        axis.add("direction", "-1", node.scaling.why_position)
    _modes(node, axis, homing)
    _limits(node, axis)
    _lacks(node, axis, gear)
    if homing is not None:
        axis.add("homing", homing)
    text_of(node.objects, axis)
    if own_name is not None and not own.units:
        axis.add("simulation", "{drive: generic_cia402}",
                 "which simulated drive, where it is tried without hardware")
    return axis


def _modes(node, axis, homing):
    start = node.start or (node.objects.start_mode + (False,) if node.objects.start_mode else None)
    if start is None:
        return
    first = start[0] if isinstance(start[0], str) else node.profile.mode(start[0])
    if first is None:
        return
    axis.add("mode", first, f"at start; {start[1]}")
    others = [node.profile.mode(number) for number in sorted(node.required)]
    others = [name for name in others if name and name != first]
    if others:
        names = ([] if homing is None or "homing" not in node.profile.modes else ["homing"]) + others
        axis.add("modes", "[" + ", ".join(names) + "]",
                 "to which it may be switched: required_drive_mode")


def _limits(node, axis):
    limits, found = Section(), node.limits.found
    if "lower" in found and "upper" in found and not found["lower"][0] < found["upper"][0]:
        raise Refusal(f"{node.joint}: its lower limit {found['lower'][0]:g} ({found['lower'][1]}) is "
                      f"not below its upper one {found['upper'][0]:g} ({found['upper'][1]}); one of "
                      "them is wrong")
    for key in ("lower", "upper", "velocity", "acceleration", "jerk", "effort"):
        if key in node.limits:
            number, where = node.limits.found[key]
            limits.add(key, number_text(number), where)
    if limits.empty():
        axis.note("limits: none in these files; give lower, upper, velocity and acceleration before it "
                  "moves")
        return
    axis.add("limits", limits)


def _lacks(node, axis, gear):
    """Objects of the profile that the driver must not write."""
    lacks = list(node.objects.lacks)
    written = any('"6080:' in write for write, _ in node.objects.writes)
    speed = node.eds.find(0x6080) is not None and not written
    if "velocity" in node.limits and gear is None and speed and node.profile.generic():
        lacks.append(("max_motor_speed", "6080h counts turns of the motor, and the gear is not known "
                      "here: give counts_per_turn of the motor and gear_ratio (or --gear), then take "
                      "this out"))
    if lacks:
        axis.add("lacks", "[" + ", ".join(name for name, _ in lacks) + "]",
                 "; ".join(why for _, why in lacks))


def _file(options, bus, axes, groups, rate, report):
    head = Section()
    head.note(HEAD + " from " + ", ".join(map(str, options.files))
              + ". Behind each line stands where it comes from. Look it over before anything moves: "
              "docs/configuration.md explains every key, docs/coming_from.md what is otherwise than in "
              "ros_canopen.")
    body = Section()
    body.add("bus", bus.section())
    body.add("axes", axes)
    if not groups.empty():
        body.add("groups", groups)
    if rate is not None:
        body.add("joint_state_rate", number_text(rate[0]), rate[1])
    text = head.text() + "\n" + body.text()
    missing = report.lines(NONE)
    if missing:
        tail = Section()
        for line in missing:
            tail.note("- " + one_line(line))
        text += "\n# Without counterpart:\n" + tail.text()
    return text
