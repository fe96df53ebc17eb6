# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""`nodes` and `defaults` of ros_canopen: which drives there are, and what files describe them."""
import os
import pathlib
import re
import xml.etree.ElementTree as ElementTree

from .drives import choose
from .eds import Eds, object_key, shown
from .limits import Limits, read_joint_limits
from .objects import Objects
from .refusal import Refusal
from .scaling import Scaling
from .tree import merged

MOTOR = "canopen::Motor402::Allocator"
FIRST_STATES = {2: "switch on disabled", 3: "ready to switch on", 4: "switched on"}
ENABLED = 5


def graph_name(text):
    """As axes and groups may be called: a letter, then letters, digits and _."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", text)
    return name if re.match("[A-Za-z]", name) else "a_" + name


class Packages:
    """Where ROS packages are: as told, around the files, in ROS_PACKAGE_PATH."""

    def __init__(self, told, files):
        self.told = told
        self.around = [parent for file in files for parent in file.resolve().parents]
        paths = os.environ.get("ROS_PACKAGE_PATH", "").split(":")
        self.paths = [pathlib.Path(path) for path in paths if path]

    def find(self, name):
        if name in self.told:
            return self.told[name]
        for folder in self.around:
            if self._is(folder, name):
                return folder
        for folder in self.around[:6] + self.paths:
            for candidate in (folder / name, *folder.glob(f"*/{name}")):
                if self._is(candidate, name):
                    return candidate
        return None

    @staticmethod
    def _is(folder, name):
        manifest = folder / "package.xml"
        try:
            return manifest.is_file() and \
                ElementTree.parse(manifest).findtext("name", "").strip() == name
        except (ElementTree.ParseError, OSError):
            return False


class Node:
    """One entry of `nodes`, with `defaults` below it."""

    def __init__(self, key, value, defaults):
        value.map()
        self.place, self.path, self.given = value.place, value.path, value
        self.values = merged(defaults, value) if defaults is not None else value
        name = self.get("name")
        self.name = name.string() if name is not None else key
        number = self.get("id")
        if value.get("id") is None:
            raise Refusal(f"{value.place}: {value.path}: has no `id`; give the node-ID of the drive, 1 "
                          "to 127")
        self.id = number.whole(1, 127)
        joint = self.get("joint")
        self.joint = joint.string() if joint is not None else self.name
        self.axis = graph_name(self.name)
        self.limits = Limits()
        self.required = set()   # numbers of modes that controllers want
        self.start = None       # (number, which controller)
        self.type, self.type_from = "revolute", ""
        self.eds = self.profile = self.why_profile = self.scaling = self.objects = self.eds_name = None

    def get(self, key):
        return self.values.get(key)

    def formula(self, key, defaults):
        value = self.get(key)
        return value.shown() if value is not None else f"{defaults[key]} (default)"

    def key_of(self, text, value):
        """(index, sub-index) of an object as ros_canopen names it, which the EDS must have."""
        key = object_key(text)
        if key is None:
            value.refuse(f"`{text}` is no object; write it like 6098 or 6099sub1")
        if key not in self.eds.entries:
            value.refuse(f"{self.eds.name} has no object [{text}]; look its number up")
        return key


def nodes_of(root, report):
    """All nodes; names and node-IDs are each there once."""
    section, defaults = root.get("nodes"), root.get("defaults")
    if section is None:
        section = root.get("modules")
    if section is None:
        raise Refusal(f"{root.place.rsplit(':', 1)[0]}: has no `nodes`; give all files that the launch "
                      "file loads for the node, too")
    if defaults is not None:
        defaults.map()
    if section.is_list():
        found = [Node(_listed_name(item), item, defaults) for item in section.items]
    else:
        found = [Node(key, value, defaults) for key, value in section.map().items()]
    if not found:
        section.refuse("holds no node")
    for i, node in enumerate(found):
        for other in found[:i]:
            _compare(node, other)
        report.done(node.get("id"), "node_id")
        if node.get("name") is not None and node.axis == node.name:
            report.done(node.get("name"), "the name of the axis")
        elif node.axis != node.name:
            report.about(node.get("name") or (node.place, node.path), "the axis is called "
                         f"{node.axis}: a name has letters, digits and _ here")
        if node.get("joint") is not None:
            report.done(node.get("joint"), "joint")
    return found


def _listed_name(item):
    if not item.is_map() or item.get("name") is None:
        raise Refusal(f"{item.place}: {item.path}: has no `name`; give it, as ros_canopen wants one in "
                      "a list")
    return item.get("name").string()


def _compare(node, other):
    for what, mine, theirs in (("id", node.id, other.id), ("name", node.axis, other.axis),
                               ("joint", node.joint, other.joint)):
        if mine == theirs:
            raise Refusal(f"{node.place}: {node.path}: {what} `{mine}` is that of {other.path} "
                          f"({other.place}), too; give each its own")


class Descriptions:
    """EDS files, each read once."""

    def __init__(self, packages, folders):
        self.packages, self.folders, self.known = packages, folders, {}

    def of(self, node):
        """(Eds, its name for the robot's file)"""
        file, package = node.get("eds_file"), node.get("eds_pkg")
        if file is None:
            raise Refusal(f"{node.place}: {node.path}: has no `eds_file`, and `defaults` neither; "
                          "ros_canopen needs one")
        text = file.string()
        if package is not None:
            name = package.string()
            folder = self.packages.find(name)
            if folder is None:
                package.refuse(f"is a package that is not found; give --package {name}=FOLDER")
            path, name = folder / text.lstrip("/"), f"package://{name}/{text.lstrip('/')}"
        else:
            path = next((base / text for base in self.folders if (base / text).is_file()), None)
            if path is None:
                file.refuse("is not found beside the YAML file, nor here; check the path, or give "
                            "`eds_pkg`")
            name = str(path.resolve())
        if not path.is_file():
            file.refuse(f"is not there: no file {path}; check the path")
        if path not in self.known:
            self.known[path] = Eds(path, path.name)
        return self.known[path], name


def describe(node, descriptions, known, report):
    """Reads the EDS and finds the profile. @return whether it is a drive"""
    node.eds, node.eds_name = descriptions.of(node)
    for key, what in (("eds_pkg", "eds"), ("eds_file", "eds")):
        if node.get(key) is not None:
            report.done(node.get(key), what)
    for note in node.eds.notes:
        report.about((node.eds.name, "the file"), note)
    number = node.eds.commissioning("NodeID")
    if number and number != node.id:
        report.about((node.eds.name, "NodeID "
                                     f"{number}"), "is not the `id` of every node that has this file; "
                     "`id` counts, as in ros_canopen")
    if node.eds.find(0x6040) is None:
        report.none((node.place, node.path), f"{node.eds.name} has no 6040h: it is no CiA 402 drive, "
                    "and the driver speaks to drives "
                    "alone", "leave this device to canopen_chain_node, with "
                    "`sync: external` on one of the two sides")
        return False
    node.profile, node.why_profile = choose(known, node.eds)
    kind = report.done if not node.profile.generic() else lambda *a: None
    kind((node.eds.name, "vendor"), f"drive: {node.profile.name}")
    _check_objects(node, report)
    return True


def _check_objects(node, report):
    """What the drive must have, and what the profile says otherwise than the EDS."""
    needed = {0x6041: "statusword", 0x6060: "mode_of_operation", 0x6061: "mode_display",
              0x6064: "position_actual"}
    missing = [f"{name} "
               f"({index:04X}h)" for index, name in needed.items() if node.eds.find(index) is None]
    if missing:
        report.none((node.eds.name, "objects"), "lacks " + ", ".join(missing) + ", without which the "
                    "driver moves no "
                    "drive", "get the right EDS, or leave `eds` out if the drive has them")
        node.eds_name = None
    lacks = [name for key, name in node.profile.objects.items() if key not in node.eds.entries]
    if lacks:
        report.done((node.eds.name, "objects"), f"the drive lacks {', '.join(lacks)}: the driver reads "
                    "that in `eds`, and does without what only defaults ask for")
    for key, kind in node.profile.types.items():
        entry = node.eds.entries.get(key)
        if entry is not None and entry.type_name() and _bits(entry.type_name()) != _bits(kind):
            report.none((entry.place, f"[{shown(key)}]"), f"{entry.name} is of type "
                        f"{entry.type_name()}, and of {kind} in {node.profile.name}: `eds` is left "
                        "out, as the driver would refuse it",
                        "look up which is right; another one needs a profile of its own")
            node.eds_name = None


def check_modes(node, report):
    """What controllers want, and the EDS denies."""
    bits = node.eds.supported_modes()
    wanted = [number for number in sorted(node.required)
              if bits is not None and not bits >> (number - 1) & 1]
    if wanted:
        report.none((node.eds.name, "6502h"), f"says that the drive does not have the mode(s) {wanted} "
                    "that controllers want", "see which is right")


def _bits(name):
    digits = re.sub(r"\D", "", name)
    return int(digits) if digits else 1


def find_type(node, options, urdf, joint_limits, report):
    """Type and limits of the joint. @return whether something says the type"""
    if urdf is not None:
        kind = urdf.apply(node.joint, node.limits, report)
        if kind is not None:
            node.type, node.type_from = kind, "URDF"
    read_joint_limits(joint_limits, node.joint, node.limits, report)
    if node.joint in options.types:
        node.type, node.type_from = options.types[node.joint], "--type"
    if not node.type_from:
        node.type_from = "not in these files: --urdf or --type says otherwise"
        return False
    if node.type == "continuous":
        node.limits.found.pop("lower", None)
        node.limits.found.pop("upper", None)
    return True


def convert_motor(node, bus, own, report):
    """Formulas, settings of the motor layer, objects."""
    node.scaling = Scaling(node, report)
    allocator = node.get("motor_allocator")
    if allocator is not None and allocator.string() == MOTOR:
        report.done(allocator, "CiA 402, as here")
    elif allocator is not None:
        report.none(allocator, "is a motor layer of its own, whose ways the driver does not know",
                    "what it does differently belongs into a profile (docs/drive_profiles.md)")
    _motor_layer(node, own, report)
    node.objects = Objects(node, bus, report)


def _motor_layer(node, own, report):
    layer = node.get("motor_layer")
    if layer is None:
        return
    layer.map()
    state, monitor, timeout = layer.get("switching_state"), layer.get("monitor_mode"), \
        layer.get("state_switch_timeout")
    if state is not None:
        number = state.whole(0, 8)
        if number == ENABLED:
            report.done(state, "modes are changed while enabled, as here")
        elif number in FIRST_STATES and node.profile.generic():
            own.disabled = True
            report.about(state, f"modes were changed in {FIRST_STATES[number]}: a profile of its own "
                         "says `mode_change: disabled`")
        else:
            report.none(state, "is no state in which the driver changes "
                               "modes", "see mode_change of the profile "
                        "(docs/drive_profiles.md)")
    if monitor is not None and monitor.flag():
        report.done(monitor, "the driver always compares 6061h with the mode that it commands")
    elif monitor is not None:
        report.none(monitor, "the driver always compares 6061h with the mode that it commands",
                    "a drive that does not show its mode needs `mode_change` of a profile")
    if timeout is not None:
        if node.profile.generic():
            own.state_change = timeout.number()
            report.done(timeout, "timing/state_change of a profile of its own")
        else:
            report.none(timeout, f"{node.profile.name} says itself how long its drives take")
