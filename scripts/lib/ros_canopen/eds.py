# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""EDS and DCF files (CiA 306) as far as a conversion needs them."""
import re

from .refusal import Refusal

LISTS = ("mandatoryobjects", "optionalobjects", "manufacturerobjects")
KEY = re.compile(r"^([0-9a-f]{1,4})(?:sub([0-9a-f]{1,2}))?$", re.IGNORECASE)
NUMBER = re.compile(r"^([+-]?)(0x[0-9a-f]+|\d+)", re.IGNORECASE)

# DataType: the name that a configuration gives it
TYPES = {1: "boolean", 2: "int8", 3: "int16", 4: "int32", 5: "uint8", 6: "uint16", 7: "uint32",
         8: "real32", 0x10: "int24", 0x11: "real64", 0x12: "int40", 0x13: "int48", 0x14: "int56",
         0x15: "int64", 0x16: "uint24", 0x18: "uint40", 0x19: "uint48", 0x1A: "uint56", 0x1B: "uint64"}
VARIABLES, COMPOUNDS = (2, 7), (8, 9)


def object_key(text):
    """(index, sub-index) of "6099sub1" or "6098", or None."""
    match = KEY.match(text.strip())
    return (int(match[1], 16), int(match[2] or "0", 16)) if match else None


def shown(key):
    """"6099:01" """
    return f"{key[0]:04X}:{key[1]:02X}"


def whole(text):
    """(the number that C's strtol reads, whether something stands behind it), or None."""
    match = NUMBER.match(text.strip())
    if match is None:
        return None
    digits = match[2].lower()
    octal = digits.startswith("0") and len(digits) > 1 and digits[1] != "x"
    if octal:
        digits = re.match("[0-7]*", digits)[0]
    number = int(digits, 8 if octal else 16 if digits.startswith("0x") else 10)
    rest = text.strip()[len(match[1]) + len(digits):]
    return (-number if match[1] == "-" else number), rest != ""


class Entry:
    """One object of a file, or one sub-index."""

    def __init__(self, key, name, values, place, type_number):
        self.key, self.name, self.place, self.type_number = key, name, place, type_number
        self.access = values.get("accesstype", "").lower()
        self.default = values.get("defaultvalue", "") or None
        self.value = values.get("parametervalue", "") or None

    def writable(self):
        return self.access in ("rw", "wo", "rwr", "rww")

    def type_name(self):
        return TYPES.get(self.type_number)


class Eds:
    """What a file says. Objects count that its three lists name, as ros_canopen takes them."""

    def __init__(self, path, name):
        self.path, self.name = path, name
        self.notes = []
        self._sections = {}  # lower-case name: (line, {lower-case key: (text, line)})
        self._read(self._text())
        self.entries = {}
        for section in LISTS:
            self._read_list(section)

    def _text(self):
        try:
            data = self.path.read_bytes()
        except OSError as error:
            raise Refusal(f"{self.name}: cannot be read: {error.strerror}; check `eds_pkg` and "
                          "`eds_file`") from None
        try:
            return data.decode("utf-8-sig")
        except UnicodeDecodeError:
            return data.decode("latin-1")

    def _read(self, text):
        section = None
        for number, line in enumerate(text.splitlines(), 1):
            line = line.strip()
            if not line or line[0] in ";#":
                continue
            if line.startswith("[") and line.endswith("]"):
                name = line[1:-1].strip().lower()
                if name in self._sections:
                    self.notes.append(f"{self.name}:{number}: the section [{name}] is there twice; "
                                      "both count")
                section = self._sections.setdefault(name, (number, {}))[1]
            elif section is None or "=" not in line:
                self.notes.append(f"{self.name}:{number}: `{line[:40]}` is neither section nor key; "
                                  "left out")
            else:
                key, value = line.split("=", 1)
                section[key.strip().lower()] = (value.strip(), number)
        if "deviceinfo" not in self._sections:
            raise Refusal(f"{self.name}: has no section [DeviceInfo]; it is no EDS or DCF, or damaged: "
                          "get the file from the maker of the drive")

    def has(self, section):
        return section.lower() in self._sections

    def text(self, section, key):
        """The value, or None where it is missing or empty."""
        values = self._sections.get(section.lower(), (0, {}))[1]
        return values.get(key.lower(), ("", 0))[0] or None

    def place(self, section, key=""):
        line, values = self._sections[section.lower()]
        return f"{self.name}:{values.get(key.lower(), ('', line))[1]}"

    def whole(self, section, key, default=None):
        """A whole number; a Refusal where it is none, or missing without a default."""
        text = self.text(section, key)
        if text is None:
            if default is not None:
                return default
            raise Refusal(f"{self.place(section)}: [{section}] has no {key}; the file is damaged: get "
                          "the file from the maker of the drive")
        found = whole(text)
        if found is None:
            raise Refusal(f"{self.place(section, key)}: [{section}] {key}: `{text}` is no number; mend "
                          "the file")
        return found[0]

    def _read_list(self, section):
        if not self.has(section):
            return
        for i in range(1, self.whole(section, "SupportedObjects") + 1):
            text = self.text(section, str(i))
            if text is None:
                raise Refusal(f"{self.place(section)}: [{section}] announces more objects than it "
                              f"lists: {i} is missing; mend SupportedObjects")
            number = self.whole(section, str(i))
            if not 0 <= number <= 0xFFFF:
                raise Refusal(f"{self.place(section, str(i))}: [{section}] {i}: `{text}` is no index; "
                              "mend the file")
            self._read_object(f"{number:04x}", number)

    def _read_object(self, section, index):
        section = section if self.has(section) else section.upper()
        if not self.has(section):
            return  # listed, but not described: ros_canopen passes it over, too
        kind = self.whole(section, "ObjectType", 7)
        if kind in VARIABLES:
            self._add(section, (index, 0))
            return
        if kind not in COMPOUNDS:
            self.notes.append(f"{self.place(section)}: [{section}] is of an ObjectType {kind} that "
                              "drives do not have; left out")
            return
        compact = self.whole(section, "CompactSubObj", 0)
        if compact:
            for sub in range(1, min(compact, 254) + 1):
                self._add(section, (index, sub), self.text(f"{section}value", str(sub)))
            return
        self.whole(section, "SubNumber")
        for sub in range(255):
            if self.has(f"{section}sub{sub:x}"):
                self._add(f"{section}sub{sub:x}", (index, sub))

    def _add(self, section, key, value=None):
        values = {name: text for name, (text, _) in self._sections[section.lower()][1].items()}
        if value is not None:
            values["parametervalue"] = value
        name = values.get("denotation") or values.get("parametername") or section
        self.entries[key] = Entry(key, name, values, self.place(section),
                                  self.whole(section, "DataType"))

    # What the drive is

    def find(self, index, sub=0):
        """An object; a plain variable may be listed as sub-index 0 of an array, too."""
        return self.entries.get((index, sub))

    def number_of(self, index, sub=0):
        """What the file says that the object holds, or None."""
        entry = self.find(index, sub)
        text = (entry.value or entry.default) if entry is not None else None
        found = whole(text) if text is not None else None
        return found[0] if found else None

    def vendor(self):
        """(number, from where), or None: of [DeviceInfo], else of 1018h."""
        for text, where in ((self.text("DeviceInfo", "VendorNumber"), "VendorNumber"),
                            (str(self.number_of(0x1018, 1)), "1018:01")):
            found = whole(text) if text else None
            if found and found[0]:
                return found[0], where
        return None

    def product(self):
        found = whole(self.text("DeviceInfo", "ProductNumber") or "")
        return found[0] if found else self.number_of(0x1018, 2)

    def names(self):
        """Maker and product in words."""
        return " ".join(filter(None, (self.text("DeviceInfo", "VendorName"),
                                      self.text("DeviceInfo", "ProductName"))))

    def supported_modes(self):
        """The bits of 6502h, or None where the file does not say them."""
        return self.number_of(0x6502) or None

    def commissioning(self, key):
        """Of a DCF; the section's name was misspelt in the standard."""
        for section in ("DeviceComissioning", "DeviceCommissioning"):
            if self.text(section, key) is not None:
                return self.whole(section, key)
        return None


def evaluated(text, node_id):
    """As whole(), of "$NODEID+0x200", "0x200+$NODEID" or "5"."""
    plain = text.replace(" ", "").upper()
    if "$NODEID" not in plain:
        return whole(text)
    rest = plain.replace("$NODEID", "", 1).strip("+")
    if not rest:
        return node_id, False
    found = whole(rest.lower())
    return (found[0] + node_id, found[1]) if found else None
