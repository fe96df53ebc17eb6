# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Limits and kinds of joints: joint_limits of ros_control, and a URDF."""
import math
import xml.etree.ElementTree as ElementTree

from .refusal import Refusal

TYPES = ("revolute", "prismatic", "continuous")
PAIRS = {"position": (("min_position", "lower"), ("max_position", "upper")),
         "velocity": (("max_velocity", "velocity"),),
         "acceleration": (("max_acceleration", "acceleration"),),
         "jerk": (("max_jerk", "jerk"),), "effort": (("max_effort", "effort"),)}


class Limits:
    """Of one joint; of several sources the narrowest counts."""

    def __init__(self):
        self.found = {}  # key: (number, where from)

    def narrow(self, key, number, where):
        """@return False where a narrower one is known, or the number is none for this key."""
        if key not in ("lower", "upper") and not number > 0:
            return False
        known = self.found.get(key)
        wider = known is not None and (number < known[0] if key == "lower" else number > known[0])
        if not wider:
            self.found[key] = (number, where)
        return not wider

    def __contains__(self, key):
        return key in self.found


def read_joint_limits(section, joint, limits, report):
    """has_..._limits and their numbers of a joint; what is switched off is told as that."""
    joint_section = section.get(joint) if section is not None else None
    if joint_section is None:
        return
    for kind, pairs in PAIRS.items():
        switch = joint_section.get(f"has_{kind}_limits")
        on = switch is not None and switch.flag()
        for name, key in pairs:
            value = joint_section.get(name)
            if value is None:
                continue
            if not on:
                report.done(value, f"counts for nothing without has_{kind}_limits: true")
            elif limits.narrow(key, value.number(), f"{value.path}"):
                report.done(value, f"limits/{key}")
            elif key not in ("lower", "upper") and value.number() <= 0:
                report.none(value, "is no limit that a joint could move "
                                   "within", "give one greater than 0")
            else:
                report.done(value, f"a narrower limits/{key} counts")
        if switch is not None:
            report.done(switch, "as its numbers say" if on else "no such limit")


class Urdf:
    """The joints of a URDF: {name: (type, {lower, upper, velocity, effort})}."""

    def __init__(self, path, name):
        self.name, self.joints = name, {}
        try:
            root = ElementTree.parse(path).getroot()
        except OSError as error:
            raise Refusal(f"{name}: cannot be read: {error.strerror}; check --urdf") from None
        except (ElementTree.ParseError, UnicodeDecodeError, LookupError, ValueError) as error:
            raise Refusal(f"{name}: is no XML: {error}; a xacro file must be expanded first (xacro "
                          "FILE)") \
                from None
        for joint in root.findall("joint"):
            limit = joint.find("limit")
            numbers = {} if limit is None else {
                key: self._number(joint, key, text) for key, text in limit.attrib.items()
                if key in ("lower", "upper", "velocity", "effort")}
            self.joints[joint.get("name", "")] = (joint.get("type", ""), numbers)
        if not self.joints:
            raise Refusal(f"{name}: has no joint; a xacro file must be expanded first (xacro FILE)")

    def _number(self, joint, key, text):
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise Refusal(f"{self.name}: joint {joint.get('name')}: limit {key}: `{text}` is no "
                          "number; a xacro file must be expanded first (xacro FILE)")
        return number

    def apply(self, joint, limits, report):
        """@return the type of the joint, or None where the URDF does not have it."""
        if joint not in self.joints:
            report.none((self.name, joint), "the URDF has no such joint",
                        "ros_canopen would not start, either")
            return None
        kind, numbers = self.joints[joint]
        path = f"joint {joint}"
        if kind not in TYPES:
            report.none((self.name, path), f"its type is `{kind}`", "it is written as revolute")
            kind = "revolute"
        for key, number in numbers.items():
            if kind == "continuous" and key in ("lower", "upper"):
                continue
            if not limits.narrow(key, number, f"URDF, joint {joint}"):
                report.about((self.name, f"{path}: {key}"),
                             f"{number:g} is no limit, or a narrower one is given")
        report.done((self.name, path), "type and limits")
        return kind
