# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Drive profiles: which one fits an EDS, and one of its own for what differs from generic_cia402."""
import re

import yaml

from .eds import object_key
from .output import number_text

FAST = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
GENERIC = "generic_cia402"
HEAD = "# generic_cia402 but for"
SHORT = {"pp": "profile_position", "vl": "velocity", "pv": "profile_velocity", "pt": "profile_torque",
         "hm": "homing", "ip": "interpolated_position", "csp": "cyclic_position",
         "csv": "cyclic_velocity", "cst": "cyclic_torque"}
# The numbers of CiA 402 that ros_canopen's required_drive_mode takes.
MODES = {1: "profile_position", 2: "velocity", 3: "profile_velocity", 4: "profile_torque", 6: "homing",
         7: "interpolated_position", 8: "cyclic_position", 9: "cyclic_velocity", 10: "cyclic_torque"}


class Profile:
    """A file of config/drives."""

    def __init__(self, path):
        tree = yaml.load(path.read_text(encoding="utf-8"), Loader=FAST)
        self.path, self.name = path, path.stem
        self.description = tree.get("description", "")
        self.identity = tree.get("identity") or {}
        self.units = tree.get("units") or {}
        self.modes = tree.get("modes") or {}
        self.methods = (tree.get("homing") or {}).get("methods") or {}
        self.objects = {}  # (index, sub-index): name
        self.types = {}
        for name, entry in (tree.get("objects") or {}).items():
            index, sub = entry["object"].split(":")
            self.objects[(int(index, 16), int(sub, 16))] = name
            self.types[(int(index, 16), int(sub, 16))] = entry["type"]
        # What is written at every boot whatever the axis says: {(index, sub): number}
        names = {name: key for key, name in self.objects.items()}
        self.always = {names[entry["object"]]: entry["raw"] for entry in tree.get("startup") or []
                       if "raw" in entry and entry["object"] in names
                       and not ("from" in entry or "if_given" in entry)}

    def generic(self):
        return self.name == GENERIC

    def counts(self):
        return str(self.units.get("position")) == "count"

    def cyclic_positions(self):
        return [name for name, mode in self.modes.items()
                if mode.get("cyclic") and mode.get("control") == "position"]

    def mode(self, number):
        """The profile's name for a mode of CiA 402, or None."""
        name = MODES.get(number)
        return name if name in self.modes else None


def profiles(folder):
    return {path.stem: Profile(path) for path in sorted(folder.glob("*.yaml"))}


def _fits(profile, eds):
    """Why the profile is that of the drive of an EDS, or None."""
    vendor, wanted = eds.vendor(), profile.identity.get("vendor_id")
    if vendor and wanted == vendor[0]:
        kind, device = profile.identity.get("device_type"), eds.number_of(0x1000)
        products = profile.identity.get("known_products")
        if products and eds.product() and eds.product() not in products:
            return None
        if kind and device and kind != device:
            return None
        return f"{eds.name}: vendor 0x{vendor[0]:X} ({vendor[1]})"
    word = profile.name.split("_")[0]
    if not wanted and len(word) > 4 and word in eds.names().lower():
        return f"{eds.name}: \"{eds.names()}\""
    return None


def choose(known, eds):
    """(profile, why) for the drive of an EDS."""
    for profile in known.values():
        if profile.generic():
            continue
        why = _fits(profile, eds)
        if why is not None:
            return profile, why
    vendor = eds.vendor()
    who = f"vendor 0x{vendor[0]:X}" if vendor else f"\"{eds.names()}\"" if eds.names() else "this drive"
    return known[GENERIC], f"no profile is that of {who}"


class OwnProfile:
    """How a drive differs from generic_cia402, as a file of its own: {what: how}."""

    def __init__(self):
        self.units = {}      # "velocity" or an object's name: (unit, scale)
        self.methods = []    # homing methods beside those of the standard
        self.disabled = False  # modes change while disabled
        self.state_change = None

    def key(self):
        return (tuple(sorted(self.units.items())), tuple(sorted(set(self.methods))), self.disabled,
                self.state_change)

    def needed(self):
        return self.key() != OwnProfile().key()

    def text(self, generic, name, origin):
        """The file: that of generic_cia402 with what differs."""
        lines = generic.path.read_text(encoding="utf-8")
        head = (f"{HEAD} what these say of the drive: {origin}\n"
                "# docs/drive_profiles.md explains every key.\n")
        lines = head + re.sub(r"\A(#[^\n]*\n)+", "", lines)
        lines = re.sub(r"(?m)^name: .*$", f"name: {name}", lines, count=1)
        for what, (unit, scale) in self.units.items():
            spec = f"{{unit: {unit}, scale: {number_text(scale)}}}"
            if what in ("velocity", "acceleration"):
                lines = re.sub(rf"(?m)^  {what}: count/s.*$", f"  {what}: {spec}", lines, count=1)
            else:
                lines = _with_unit(lines, what, spec)
        for method in sorted(set(self.methods), reverse=True):
            lines = re.sub(r"(?m)^  methods:\n", f"  methods:\n    {method}: the maker's own\n", lines,
                           count=1)
        if self.disabled:
            lines = lines.replace("\nmodes:\n", "\nmode_change: disabled\n\nmodes:\n", 1)
        if self.state_change is not None:
            lines = re.sub(r"(?m)^  state_change: .*$",
                           f"  state_change: {number_text(self.state_change)}",
                           lines, count=1)
        return lines


def _with_unit(lines, name, spec):
    """The line of an object with another unit."""
    def changed(match):
        line = re.sub(r", unit: [^,}]*", "", match[0])
        return re.sub(r"quantity: \w+", rf"\g<0>, unit: {spec}", line)
    return re.sub(rf"(?m)^  {name}: \{{.*\}}$", changed, lines, count=1)


def object_in(name):
    """(index, sub) of `obj6064` or `obj6099sub1`, or None."""
    return object_key(name[3:]) if name.startswith("obj") else None
