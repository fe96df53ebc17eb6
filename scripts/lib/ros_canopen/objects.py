# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What ros_canopen writes into a drive: `dcf_overlay`, and each ParameterValue of its DCF."""
import re

from .drives import MODES
from .eds import evaluated, shown
from .output import Section, number_text, quoted, raw_text
from .refusal import Refusal

SETPOINTS = {(0x6040, 0), (0x607A, 0), (0x60FF, 0), (0x6071, 0), (0x6042, 0), (0x60C1, 1)}
BY_DRIVER = {0x1005: "COB-ID of SYNC", 0x1006: "SYNC period", 0x1014: "COB-ID of EMCY",
             0x1019: "SYNC counter", 0x1200: "SDO channel"}
COMMUNICATION, STANDARD = 0x2000, 0x6000
# Names of makers' objects that are never written along: who does loses the drive.
OF_THE_BUS = re.compile(r"node.?id|bit.?rate|baud", re.IGNORECASE)
FLOATS = {8, 0x11}
HOMING_KEYS = {(0x6099, 1): ("search_velocity", "velocity"), (0x6099, 2): ("zero_velocity", "velocity"),
               (0x609A, 0): ("acceleration", "acceleration"), (0x607C, 0): ("offset", "position")}


class Setting:
    """A number that goes into an object."""

    def __init__(self, key, entry, text, where, overlay):
        self.key, self.entry, self.text = key, entry, text
        self.where = where      # the Value of an overlay, or (place, path) in a DCF
        self.overlay = overlay
        self.number = None
        self.source = where.path if overlay else where[0]


def settings_of(node, report):
    """Of the DCF and what `dcf_overlay` puts over it, by index."""
    found = {}
    for key, entry in node.eds.entries.items():
        if entry.value is not None:
            where = (entry.place, f"[{shown(key)}] ParameterValue `{entry.value}`")
            found[key] = Setting(key, entry, entry.value, where, False)
    overlay = node.get("dcf_overlay")
    for name, value in (overlay.map() if overlay is not None else {}).items():
        key = node.key_of(name, value)
        if value.text is None:
            value.refuse("must be a number as a text: \"1000\"")
        if not isinstance(value.value, str):
            report.about(value, "is a number without quotes, which ros_canopen refuses: taken as that "
                                "number")
        found[key] = Setting(key, node.eds.entries[key], value.text, value, True)
    for setting in found.values():
        _number(setting, node, report)
    return [found[key] for key in sorted(found)]


def _number(setting, node, report):
    """Reads its text as ros_canopen does for the type of the object."""
    entry, text = setting.entry, setting.text
    if entry.type_number in FLOATS:
        try:
            setting.number = float(text)
        except ValueError:
            _refuse(setting, "is no number")
    elif entry.type_name() is not None:
        found = evaluated(text, node.id)
        if found is None:
            _refuse(setting, "is no number")
        setting.number, cut = found
        if cut:
            report.about(setting.where, f"is read as {setting.number}, as ros_canopen does: the object "
                         "holds a whole number")


def _refuse(setting, what):
    place, path = (setting.where.place, setting.where.path) if setting.overlay else setting.where
    raise Refusal(f"{place}: {path}: `{setting.text}` {what}, and {shown(setting.key)} "
                  f"({setting.entry.name}) holds one; mend it")


class Objects:
    """Puts the settings of one drive where they belong."""

    def __init__(self, node, bus, report):
        self.node, self.bus, self.report = node, bus, report
        self.writes = []        # (YAML, where from)
        self.error_control = Section()
        self.quick_stop = None
        self.homing = {}        # key: Setting
        self.method = None      # Setting of 6098h
        self.start_mode = None  # of 6060h
        self.lacks = []         # (object of the profile, why)
        self.as_from_factory, self.read_only, self.texts, self.layout = 0, 0, 0, []
        for setting in settings_of(node, report):
            self._place(setting)
        self._sum_up()

    def _place(self, setting):
        index, sub = setting.key
        if 0x1400 <= index < 0x1C00:
            self._pdo(setting)
        elif setting.number is None:
            self._text(setting)
        elif setting.key == (0x6098, 0):
            self.method = setting
        elif not setting.entry.writable():
            self._read_only(setting)
        elif index < COMMUNICATION:
            self._communication(setting)
        elif setting.key in SETPOINTS:
            self._setpoint(setting)
        elif setting.key in self.node.profile.always:
            self._always(setting)
        else:
            special = {0x6060: self._mode, 0x6099: self._homing, 0x609A: self._homing,
                       0x607C: self._homing, 0x607D: self._position_limit, 0x607F: self._velocity_limit,
                       0x60C2: self._interpolation, 0x605A: self._quick_stop}.get(index, self._write)
            special(setting)

    def _read_only(self, setting):
        if setting.overlay:
            self.report.none(setting.where, f"the EDS says that {shown(setting.key)} cannot be written "
                             f"({setting.entry.access or 'no AccessType'})", "leave it out")
        else:
            self.read_only += 1

    # Into `write`

    def _write(self, setting):
        entry = setting.entry
        if not setting.overlay and setting.text == entry.default:
            self.as_from_factory += 1
            return
        if COMMUNICATION <= setting.key[0] < STANDARD and OF_THE_BUS.search(entry.name):
            self.report.none(setting.where, f"{shown(setting.key)} ({entry.name}) is of the bus, which "
                             "the driver does not write "
                             "along", "the services lss_assign, set_bus_parameters and "
                             "write_object do that")
            return
        known = setting.key in self.node.profile.objects
        kind = "" if known else f", type: {entry.type_name()}"
        number = f"value: {number_text(setting.number)}" if entry.type_number in FLOATS else \
            f"raw: {raw_text(setting.number)}"
        self.writes.append((f"{{object: \"{shown(setting.key)}\"{kind}, {number}}}",
                            f"{entry.name}; {setting.source}"))
        self.report.done(setting.where, "write")

    def _text(self, setting):
        if not setting.overlay:
            self.texts += 1
        else:
            self.report.none(setting.where, f"{shown(setting.key)} ({setting.entry.name}) holds no "
                             "number, and `write` takes "
                             "numbers", "the service load_dcf writes a DCF into the drive")

    def _always(self, setting):
        """What the profile writes itself at every boot."""
        wanted = self.node.profile.always[setting.key]
        if setting.number == wanted:
            self.report.done(setting.where, f"{self.node.profile.name} writes that itself")
            return
        self.report.none(setting.where, f"{self.node.profile.name} writes {wanted} to "
                         f"{shown(setting.key)} ({setting.entry.name}), on which the driver counts "
                         "when it stops",
                         "add it to `write` of the axis if it must be so")

    # Communication

    def _pdo(self, setting):
        if setting.overlay:
            self.report.about(setting.where, "the driver plans the PDOs itself; `pdos` of the axis "
                              "sets them by hand")
            return
        mapping = 0x1600 <= setting.key[0] < 0x1800 or setting.key[0] >= 0x1A00
        if mapping and setting.key[1] and setting.number:
            kind = "RPDO" if setting.key[0] < 0x1800 else "TPDO"
            self.layout.append(f"{kind} {setting.number >> 16:04X}:{setting.number >> 8 & 0xFF:02X}")
        else:
            self.layout.append("")

    def _communication(self, setting):
        index = setting.key[0]
        if index == 0x1016:
            self._consumer(setting)
        elif index == 0x1017:
            self._producer(setting)
        elif index in BY_DRIVER:
            self.report.about(setting.where, f"the driver sets the drive's {BY_DRIVER[index]} itself")
        elif index in (0x100C, 0x100D):
            self._guarding(setting)
        elif index == 0x1007:
            self.report.about(setting.where, "is `bus/sync_window` here (s), for all drives")
        elif index in (0x1010, 0x1011) and not setting.overlay:
            self.report.about(setting.where, "the driver saves and restores nothing by itself")
        elif index in (0x1010, 0x1011):
            self.report.none(setting.where, "the driver saves and restores nothing by itself",
                             "call save_parameters or restore_parameters")
        else:
            self._write(setting)

    def _guarding(self, setting):
        if setting.number == 0:
            self.report.done(setting.where, "no node guarding, nor here")
        else:
            self.report.none(setting.where, "ros_canopen asks no drive by guarding, so the drive alone "
                             "would "
                             "notice", "write `error_control: {kind: guarding, period: ...}` where it "
                             "has no heartbeat")

    def _consumer(self, setting):
        """1016h: whose heartbeat the drive watches, and for how long (ms)."""
        who, milliseconds = setting.number >> 16 & 0x7F, setting.number & 0xFFFF
        if not who or not milliseconds:
            self.report.about(setting.where,
                              "watches nobody there; here the drive watches the master where it can")
        elif who != self.bus.master[0]:
            self.report.none(setting.where, f"watches node {who}, and the master here has node-ID "
                             f"{self.bus.master[0]}; the driver sets 1016h "
                             "itself", "one of the two is wrong")
        elif milliseconds / 1000 <= self.bus.heartbeat[0]:
            self.report.about(setting.where, f"{milliseconds} ms are no longer than the master's "
                              f"heartbeat ({self.bus.heartbeat[0]:g} s): three of these are waited for")
        else:
            self.error_control.add("master_timeout", number_text(milliseconds / 1000), setting.source)
            self.report.done(setting.where, "error_control/master_timeout")

    def _producer(self, setting):
        if not setting.number:
            self.report.about(setting.where, "the drive sent none there; here it is asked for one as "
                              "often as the master sends its own (`error_control: none` asks for none)")
            return
        self.error_control.add("period", number_text(setting.number / 1000), setting.source)
        self.report.done(setting.where, "error_control/period")

    # Motion

    def _setpoint(self, setting):
        if setting.number == 0:
            self.report.done(setting.where, "the driver commands it itself")
        else:
            self.report.about(setting.where, f"the driver commands {shown(setting.key)} itself, from "
                              "where the motor stands")

    def _mode(self, setting):
        if setting.number in MODES and setting.number != 6:
            self.start_mode = (setting.number, setting.source)
            self.report.about(setting.where, "the mode to start in, where no controller says one")
        elif setting.number == 0:
            self.report.done(setting.where, "the driver sets the mode itself")
        else:
            self.report.none(setting.where, "is no mode to start in", "give `mode` of the axis")

    def _homing(self, setting):
        if setting.key in HOMING_KEYS:
            self.homing[setting.key] = setting
        else:
            self._write(setting)

    def _position_limit(self, setting):
        scaling, sub = self.node.scaling, setting.key[1]
        if scaling.position is None or sub not in (1, 2) or not self.node.profile.counts():
            self._write(setting)
            return
        if not setting.overlay and setting.text == setting.entry.default:
            self.as_from_factory += 1
            return
        upper = (sub == 2) == (scaling.position > 0)
        number = setting.number / scaling.position + scaling.offset
        key = "upper" if upper else "lower"
        if self.node.type == "continuous":
            self._write(setting)
        elif self.node.limits.narrow(key, number, f"{shown(setting.key)}, {setting.source}"):
            self.report.done(setting.where, f"limits/{key}, for set-points, too")
        else:
            self.report.about(setting.where, f"a narrower limits/{key} counts, in the drive, too")

    def _velocity_limit(self, setting):
        scaling = self.node.scaling
        if "velocity" in self.node.limits or not scaling.speed_known or not setting.number:
            self._write(setting)
            return
        if not setting.overlay and setting.text == setting.entry.default:
            self.as_from_factory += 1
            return
        self.node.limits.narrow("velocity", setting.number / scaling.velocity,
                                f"{shown(setting.key)}, {setting.source}")
        self.report.done(setting.where, "limits/velocity, for set-points, too")

    def _interpolation(self, setting):
        self.report.about(setting.where, "the driver writes 60C2h from bus/sync_period")

    def _quick_stop(self, setting):
        if setting.number in (5, 6, 7, 8) and self.node.profile.generic():
            self.quick_stop = ("hold", setting.source)
            self.report.about(setting.where, "quick_stop: hold (the driver writes 6)")
        else:
            self.report.about(setting.where, "quick_stop: disable (the driver writes 2)")

    # What is left

    def _sum_up(self):
        name = self.node.eds.name
        if self.as_from_factory:
            self.report.about((name, "ParameterValue"), f"{self.as_from_factory} objects whose value "
                              "is their DefaultValue are not written: the drives are taken to be as "
                              "from the factory there (the service load_dcf compares and writes all)")
        if self.read_only:
            self.report.about((name, "ParameterValue"), f"{self.read_only} objects that cannot be "
                              "written have one: nothing is written to them")
        if self.texts:
            self.report.about((name, "ParameterValue"), f"{self.texts} objects hold a text, or what is "
                              "no number: they are not written (the service load_dcf does that)")
        if self.layout:
            mapped = ", ".join(filter(None, self.layout))
            self.report.about((name, "1400h to "
                                     "1BFFh"), "the PDOs of the file are not taken, the driver plans "
                              f"its own{' (there: ' + mapped + ')' if mapped else ''}; `pdos` sets "
                              "them by hand")

    def finish_homing(self, own):
        """@return the `homing` section, or None. @param own the axis' OwnProfile"""
        method, profile = self.method, self.node.profile
        if method is None or method.number == 0 or not self._has(method, own):
            self._no_homing()
            return None
        section = Section()
        section.add("method", str(method.number), method.source)
        self.report.done(method.where, "homing/method")
        if not method.entry.writable():
            self.lacks.append(("homing_method",
                               f"{shown(method.key)} cannot be written, it is the drive's only one"))
        for key, setting in self.homing.items():
            name, quantity = HOMING_KEYS[key]
            number = self._in_joint(setting.number, quantity)
            if number is None or (quantity != "position" and number <= 0) or not profile.counts():
                self._write(setting)
                continue
            section.add(name, number_text(number), f"{shown(key)} {setting.text}; {setting.source}")
            self.report.done(setting.where, f"homing/{name}")
        return section

    def _in_joint(self, number, quantity):
        scaling = self.node.scaling
        if scaling.position is None:
            return None
        if quantity == "position":
            return number / scaling.position + scaling.offset
        return number / scaling.velocity if scaling.speed_known else None

    def _has(self, method, own):
        profile = self.node.profile
        if method.number in profile.methods:
            return True
        if profile.generic() and -128 <= method.number < 0:
            own.methods.append(method.number)
            return True
        self.report.none(method.where, f"{profile.name} has no homing method {method.number}",
                         "give homing/method another one of the profile (docs/drives/README.md)")
        return False

    def _no_homing(self):
        method = self.method
        if method is not None and method.number == 0:
            self.report.done(method.where, "no homing: the positions of the drive count as they are")
        elif method is None and self.node.eds.find(0x6098) is not None:
            entry = self.node.eds.find(0x6098)
            self.report.none((entry.place, f"[{shown(entry.key)}]"), "no file says the homing method: "
                             "ros_canopen homes by what the drive "
                             "holds", "read 6098h (read_object) and give homing/method; "
                             "without it the axis is not homed and its positions count as they are")
        for setting in self.homing.values():
            self._write(setting)


def text_of(objects, axis):
    """Puts what an axis gets by its objects into its section."""
    if objects.quick_stop is not None:
        axis.add("quick_stop", quoted(objects.quick_stop[0]), objects.quick_stop[1])
    if not objects.error_control.empty():
        axis.add("error_control", objects.error_control)
    if objects.writes:
        axis.add("write", objects.writes)
