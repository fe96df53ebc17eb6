# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Conversion formulas as counts_per_turn, direction, position_offset, rated_torque and units."""
import math

from .drives import object_in
from .formula import Formula, FormulaError, NotLinear
from .refusal import Refusal

# What ros_canopen takes where a formula is not given.
DEFAULTS = {"pos_to_device": "rint(rad2deg(pos)*1000)", "pos_from_device": "deg2rad(obj6064)/1000",
            "vel_to_device": "rint(rad2deg(vel)*1000)", "vel_from_device": "deg2rad(obj606C)/1000",
            "eff_to_device": "rint(eff)", "eff_from_device": "0"}
SAME = 1e-6  # relative; formulas are written with a few digits
SOURCES = {"pos": ((0x6064, 0), "position_actual"), "vel": ((0x606C, 0), "velocity_actual"),
           "eff": ((0x6077, 0), "torque_actual")}
VELOCITY_MODES, TORQUE_MODES, VL = {2, 3, 9}, {4, 10}, 2


def same(one, other):
    return abs(one - other) <= SAME * max(abs(one), abs(other))


class Scaling:
    """Device units per rad or m of a joint; None where the formulas do not tell."""

    def __init__(self, node, report):
        self.node, self.report = node, report
        self.position = None           # with its sign
        self.offset = 0.0              # joint position where the drive says 0
        self.why_position = ""
        self.speed_known = False       # a formula tells the next one
        self.velocity = None           # of 60FFh, 6081h, 607Fh, 6099h
        self.measured_velocity = None  # of 606Ch
        self.vl = None                 # of 6042h
        self.rated = None              # joint effort of 1000 units of 6077h
        self.unit = "m" if node.type == "prismatic" else "rad"
        self._position()
        self._velocity()
        self._effort()

    def sign(self):
        return -1 if self.position is not None and self.position < 0 else 1

    def _at(self, key):
        """The Value of a formula, or where its default counts."""
        value = self.node.get(key)
        return value if value is not None else \
            (self.node.place, f"nodes/{self.node.name}: {key} (default: {DEFAULTS[key]})")

    def _linear(self, key):
        """(Linear or None, the Value or None) of a formula; what is not linear is told."""
        value = self.node.get(key)
        text = value.string() if value is not None else DEFAULTS[key]
        try:
            formula = Formula(text)
        except FormulaError as error:
            raise Refusal(f"{value.place}: {value.path}: `{text}` is no formula: {error}; mend "
                          "it") from None
        try:
            found = formula.linear()
        except NotLinear as error:
            self.report.none(value, f"is more than a factor and an offset: {error}",
                             "the driver takes a factor of the drive's own units")
            return None, value
        for note in found.notes:
            self.report.about(value, note)
        return found, value

    def _to_device(self, key, variable):
        """The formula towards the drive as (factor, offset), or None."""
        found, value = self._linear(key)
        if found is None:
            return None
        if found.variable != variable or found.factor == 0:
            self.report.none(value, f"does not depend on `{variable}` alone",
                             f"write a formula of `{variable}`")
            return None
        return found

    def _from_device(self, key):
        """The formula from the drive, or None."""
        found, value = self._linear(key)
        if found is None or found.constant():
            if found is not None and key != "eff_from_device":
                self.report.none(value, "is always the same number",
                                 "the driver shows what the drive tells")
            return None
        wanted, name = SOURCES[key[:3]]
        if object_in(found.variable) != wanted:
            self.report.none(value, f"is made of `{found.variable}`, and the driver reads {name} "
                             f"({wanted[0]:04X}h)", "`read_object` reads others")
            return None
        if found.factor == 0:
            self.report.none(value, "has the factor 0", "the driver shows what the drive tells")
            return None
        return found

    # Positions

    def _position(self):
        to, back = self._to_device("pos_to_device", "pos"), self._from_device("pos_from_device")
        to_value, back_value = self.node.get("pos_to_device"), self.node.get("pos_from_device")
        if to is None and back is None:
            return
        if back is not None:
            self.position, self.offset = 1 / back.factor, back.offset
            self.why_position = f"pos_from_device {self.node.formula('pos_from_device', DEFAULTS)}"
        else:
            self.position, self.offset = to.factor, -to.offset / to.factor
            self.why_position = f"pos_to_device {self.node.formula('pos_to_device', DEFAULTS)}"
        counts = f"{self.position:.9g} counts per {self.unit}"
        if back_value is not None and back is not None:
            self.report.done(back_value, f"{counts}: counts_per_turn")
        if to is not None and to_value is not None:
            if back is None or self._inverse(to, back):
                self.report.done(to_value, f"{counts}: counts_per_turn")
            else:
                self.report.none(to_value, f"is {to.factor:.9g} counts per {self.unit}, and "
                                 f"pos_from_device {self.position:.9g}: targets and measured positions "
                                 "would differ",
                                 "pos_from_device counts here; find out which is right")
        if to is not None and back is not None and to_value is None and not self._inverse(to, back):
            self.report.none(back_value, "is not the inverse of the default pos_to_device, which is "
                             "used where none is "
                             "given", "the measured positions count here; see which is right")
        if self.position == 1 and self.unit == "rad":
            self.report.about(to_value or back_value, "hands the drive's counts through as if they "
                              "were rad: give counts_per_turn and gear_ratio, and what commands the "
                              "joint must then say rad")

    def _inverse(self, to, back):
        shift = -to.offset / to.factor - back.offset
        return same(to.factor * back.factor, 1) and abs(shift) <= SAME * max(1, abs(back.offset))

    # Velocities

    def _velocity(self):
        modes = self.node.required & VELOCITY_MODES
        to, back = self._speed("vel_to_device", modes), self._speed("vel_from_device", modes)
        if self.position is None:
            self._untaken(("vel_to_device", to), ("vel_from_device", back))
            return
        plain = abs(self.position)
        self.measured_velocity = back if back is not None else plain
        self.velocity = self.measured_velocity
        if to is not None and modes - {VL}:
            self.velocity = to
            if back is None:
                self.measured_velocity = to
        if VL in modes:
            self.vl = to
        self.speed_known = back is not None or (to is not None and same(to, self.velocity))
        self._tell_velocity("vel_from_device", back, self.measured_velocity)
        if modes or to is None or same(to, self.velocity):
            self._tell_velocity("vel_to_device", to, to)
        elif self.node.get("vel_to_device") is not None and back is not None:
            self.report.none(self.node.get("vel_to_device"), f"is {to:.9g} units per {self.unit}/s, "
                             f"and vel_from_device {back:.9g}; no controller in the files commands "
                             "velocities, which would tell the object that takes "
                             "it", "give the file of the controllers, too; vel_from_device counts "
                             "here, also for the drive's profile velocities: look that up")
        elif self.node.get("vel_to_device") is not None:
            self.report.about(self.node.get("vel_to_device"), "no controller in the files commands "
                              "velocities, so it counts for nothing; give the file of the controllers, "
                              "too")

    def _speed(self, key, modes):
        """The factor towards the drive, without its sign, or None."""
        value, to = self.node.get(key), key == "vel_to_device"
        given = any(self.node.get(name) is not None for name in ("pos_to_device", "pos_from_device"))
        if value is None and given and not (modes and to):
            return None  # the default is in mdeg/s, whatever the positions are: nobody has meant it
        found = self._to_device(key, "vel") if to else self._from_device(key)
        if found is None:
            return None
        factor = found.factor if to else 1 / found.factor
        if found.offset != 0:
            self.report.none(self._at(key),
                             "has an offset, and a velocity here is 0 where the drive says 0",
                             "leave it out")
            return None
        if self.position is not None and factor * self.position < 0:
            self.report.none(self._at(key), "turns the other way than the positions do",
                             "one of the signs is wrong")
            return None
        if factor == 1 and value is not None and not modes and abs(self.position or 0) != 1:
            self.report.none(value, "hands the drive's unit through, and no controller commands "
                             "velocities: taken as not said, the drive's velocities as counts/s",
                             "look its unit up; another one needs a profile (docs/drive_profiles.md, "
                             "units)")
            return None
        return abs(factor)

    def _untaken(self, *keys):
        for key, factor in keys:
            if factor is not None and self.node.get(key) is not None:
                self.report.none(self.node.get(key), "cannot be taken, as the positions have no factor",
                                 "give counts_per_turn first")

    def _tell_velocity(self, key, factor, taken):
        value = self.node.get(key)
        if factor is None or value is None:
            return
        what = "counts/s, as positions count" if same(taken, abs(self.position)) else \
            f"{taken:.9g} units of the drive per {self.unit}/s: a unit in a profile of its own"
        self.report.done(value, what)

    # Efforts

    def _effort(self):
        modes = self.node.required & TORQUE_MODES
        back, value = self._from_device("eff_from_device"), self.node.get("eff_from_device")
        if back is None:
            if value is not None and not value.told:
                self.report.done(value, "no efforts are shown, unless rated_torque is given")
        elif back.offset != 0 or back.factor * self.sign() < 0:
            self.report.none(value, "has an offset, or another sign than the positions have",
                             "give rated_torque by hand")
        else:
            self.rated = abs(back.factor) * 1000
            self.report.done(value, "rated_torque")
        to = self._to_device("eff_to_device", "eff")
        value = self.node.get("eff_to_device")
        if to is None:
            return
        if not modes:
            if value is not None:
                self.report.done(value, "no controller commands efforts, so it counts for nothing")
        elif self.rated is None:
            self._rated_by_target(to, value)
        elif same(abs(to.factor) * self.rated, 1000):
            self._done(value, "rated_torque")
        else:
            self.report.none(self._at("eff_to_device"), f"says {1000 / abs(to.factor):.9g} for 1000 "
                             "units of the drive, and eff_from_device "
                             f"{self.rated:.9g}", "eff_from_device counts here")

    def _rated_by_target(self, to, value):
        if to.offset != 0 or to.factor * self.sign() < 0:
            self.report.none(self._at("eff_to_device"),
                             "has an offset, or another sign than the positions have",
                             "give rated_torque by hand")
            return
        self.rated = 1000 / abs(to.factor)
        self._done(value, "rated_torque")
        if to.factor == 1:
            self.report.about(self._at("eff_to_device"), "a unit of the drive is taken for 1 N m, "
                              "which makes rated_torque 1000: 6071h counts in 1/1000 of the motor's, "
                              "give that")

    def _done(self, value, text):
        if value is not None:
            self.report.done(value, text)

    # As keys of an axis

    def geometry(self, gear):
        """[(key, number, comment)]. @param gear motor turns per joint turn, or None"""
        if self.position is None:
            return []
        rows = []
        ratio = gear if gear is not None else 1.0
        joint_turn = 1.0 if self.unit == "m" else 2 * math.pi
        what = "motor turn" if gear is not None else \
            ("m" if self.unit == "m" else "turn of the joint: motor and gear in one")
        rows.append(("counts_per_turn", abs(self.position) * joint_turn / ratio,
                     f"per {what}; {self.why_position}"))
        if gear is not None:
            rows.append(("gear_ratio", gear, "--gear"))
        if self.unit == "m":
            rows.append(("lead", 1.0, "m: the formula gives the counts of a metre"))
        if self.offset != 0:
            rows.append(("position_offset", self.offset, self.why_position))
        if self.rated is not None:
            screw = 1 / (2 * math.pi) if self.unit == "m" else 1.0
            rows.append(("rated_torque", self.rated * screw / ratio, "N m, by the formula of efforts"))
        return rows

    def scale_of(self, factor):
        """counts/s that a unit of the drive is; None where it is 1."""
        return None if same(factor, abs(self.position)) else abs(self.position) / factor
