# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Configurations and EDS files in the shape of ros_canopen's, to test scripts/convert_ros_canopen."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = REPOSITORY / "scripts/convert_ros_canopen"

# (index, sub-index): (DataType, AccessType); what a plain servo has
SERVO = {(0x1000, 0): (7, "ro"), (0x1001, 0): (5, "ro"), (0x1016, 1): (7, "rw"), (0x1017, 0): (6, "rw"),
         (0x6040, 0): (6, "rw"), (0x6041, 0): (6, "ro"), (0x6060, 0): (2, "rw"), (0x6061, 0): (2, "ro"),
         (0x6064, 0): (4, "ro"), (0x6065, 0): (7, "rw"), (0x606C, 0): (4, "ro"), (0x6077, 0): (3, "ro"),
         (0x607A, 0): (4, "rw"), (0x607C, 0): (4, "rw"), (0x607D, 1): (4, "rw"), (0x607D, 2): (4, "rw"),
         (0x607F, 0): (7, "rw"), (0x6081, 0): (7, "rw"), (0x6083, 0): (7, "rw"), (0x6084, 0): (7, "rw"),
         (0x6098, 0): (2, "rw"), (0x6099, 1): (7, "rw"), (0x6099, 2): (7, "rw"), (0x609A, 0): (7, "rw"),
         (0x60FF, 0): (4, "rw")}
COMPOUNDS = (0x1010, 0x1016, 0x1018, 0x1029, 0x1600, 0x2040, 0x2060, 0x607D, 0x6046, 0x6048, 0x6049,
             0x604A,
             0x6099, 0x60C1, 0x60C2, 0x60FE)


def eds(objects=None, values=None, defaults=None, head="", names=None):
    """The text of an EDS; `values` are ParameterValues, `defaults` DefaultValues, by object."""
    objects = SERVO if objects is None else objects
    values, defaults, names = values or {}, defaults or {}, names or {}
    indices = sorted({index for index, _ in objects})
    text = f"[FileInfo]\nFileName=servo.eds\n\n[DeviceInfo]\n{head}\n\n[OptionalObjects]\n"
    text += f"SupportedObjects={len(indices)}\n"
    text += "".join(f"{i}=0x{index:04X}\n" for i, index in enumerate(indices, 1))
    for index in indices:
        subs = sorted(sub for other, sub in objects if other == index)
        if index in COMPOUNDS:
            text += f"\n[{index:04X}]\nParameterName=object {index:04X}\nObjectType=0x9\n"
            text += f"SubNumber={len(subs)}\n"
        for sub in subs:
            kind, access = objects[(index, sub)]
            section = f"{index:04X}sub{sub:X}" if index in COMPOUNDS else f"{index:04X}"
            text += f"\n[{section}]\nParameterName={names.get((index, sub), f'object {section}')}\n"
            text += f"ObjectType=0x7\nDataType=0x{kind:04X}\nAccessType={access}\nPDOMapping=1\n"
            if (index, sub) in defaults:
                text += f"DefaultValue={defaults[(index, sub)]}\n"
            if (index, sub) in values:
                text += f"ParameterValue={values[(index, sub)]}\n"
    return text


BUS = """
bus: {device: can1, driver_plugin: "can::SocketCANInterface", \
master_allocator: "canopen::SimpleMaster::Allocator"}
sync: {interval_ms: 10, overflow: 0}
heartbeat: {rate: 20, msg: "77f#05"}
"""
NODES = """
nodes:
  shoulder: {id: 3}
  elbow: {id: 4}
"""
DEFAULTS = """
defaults: {eds_file: servo.eds}
"""


class Converted:
    """What the script has said and written."""

    def __init__(self, ended):
        self.status, self.text, self.report = ended.returncode, ended.stdout, ended.stderr
        self.robot = yaml.safe_load(ended.stdout) if "\naxes:" in ended.stdout else None

    def axis(self, name="shoulder"):
        return self.robot["axes"][name]

    def lines(self, kind):
        """Of the report: "converted", "approximated", "no counterpart"."""
        found, inside = [], False
        for line in self.report.splitlines():
            if not line.startswith(" "):
                inside = line.startswith(kind + " (")
            elif inside:
                found.append(line.strip())
        return found


class Case(unittest.TestCase):
    """A folder with servo.eds, in which the script is run."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name).resolve()
        self.write("servo.eds", eds())

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(text, bytes):
            path.write_bytes(text)
        else:
            path.write_text(text, encoding="utf-8")
        return path

    def run_script(self, *arguments):
        ended = subprocess.run([sys.executable, SCRIPT, *arguments], cwd=self.folder,
                               stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, timeout=60, check=False)
        self.assertNotIn("Traceback", ended.stderr)
        return Converted(ended)

    def convert(self, text=BUS + DEFAULTS + NODES, *options):
        """Converts one file. @return Converted, which must not be a refusal"""
        self.write("driver.yaml", text)
        converted = self.run_script(*options, "driver.yaml")
        self.assertIn(converted.status, (0, 1), converted.report)
        return converted

    def with_defaults(self, defaults, *options, more=""):
        """The axis `shoulder`, by keys in `defaults`."""
        return self.convert(BUS + "defaults:\n  eds_file: "
                                  "servo.eds\n" + defaults + NODES + more, *options)

    def refused(self, text, *wanted, options=()):
        """The sentence has all of `wanted`, and nothing is written."""
        self.write("driver.yaml", text)
        converted = self.run_script(*options, "driver.yaml")
        self.assertEqual((converted.status, converted.text), (2, ""), converted.report)
        self.assertEqual(converted.report.count("\n"), 1)
        for part in wanted:
            self.assertIn(part, converted.report)

    def told(self, converted, kind, *parts):
        """One line of the report of this kind has all parts."""
        lines = converted.lines(kind)
        self.assertTrue(any(all(part in line for part in parts) for line in lines),
                        f"no line with {parts} in: {converted.report}")
