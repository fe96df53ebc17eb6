# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""YAML as roslaunch loads it onto the parameter server, each value with its place."""
import math
import re

import yaml

from .formula import Formula, FormulaError, NotLinear
from .refusal import Refusal

ANGLE = re.compile(r"^(deg|rad)\((.*)\)$")
MERGE = "tag:yaml.org,2002:merge"
ANGLE_TAGS = {"!degrees": "deg", "!radians": "rad"}


class Value:
    """A mapping (`entries`), a list (`items`) or a scalar (`text`, `value`)."""

    def __init__(self, place, path, text=None, value=None, entries=None, items=None):
        self.place, self.path = place, path  # "file:line", "defaults/eds_pkg"
        self.text, self.value, self.entries, self.items = text, value, entries, items
        self.told = False        # the report has said what becomes of it
        self.overridden = False  # another value counts in its place

    def is_map(self):
        return self.entries is not None

    def is_list(self):
        return self.items is not None

    def get(self, key):
        return self.entries.get(key) if self.is_map() else None

    def at(self, path):
        """The value below, or None: at("bus/device")."""
        found = self
        for key in path.split("/"):
            found = found.get(key) if found is not None else None
        return found

    def shown(self):
        """In words, for the report."""
        if self.is_map():
            return "{" + ", ".join(self.entries) + "}"
        if self.is_list():
            return "[" + ", ".join(item.shown() for item in self.items) + "]"
        return " ".join(self.text.split())

    def refuse(self, what):
        raise Refusal(f"{self.place}: {self.path}: `{self.shown()}` {what}")

    # Scalars of a kind, or a Refusal

    def string(self):
        if self.text is None:
            self.refuse("must be a text")
        if "$(" in self.text:
            self.refuse("has a part that roslaunch fills in; write there what it fills in")
        return self.text

    def number(self):
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)) or \
                not math.isfinite(self.value):
            self.refuse("must be a number")
        return float(self.value)

    def whole(self, low, high):
        number = self.number()
        if number != int(number) or not low <= number <= high:
            self.refuse(f"must be a whole number from {low} to {high}")
        return int(number)

    def flag(self):
        if not isinstance(self.value, bool):
            self.refuse("must be true or false")
        return self.value

    def map(self):
        if not self.is_map():
            self.refuse("must be a mapping (key: value)")
        return self.entries

    def texts(self):
        """Of a list of texts."""
        if not self.is_list():
            self.refuse("must be a list")
        return [item.string() for item in self.items]


def leaves(value):
    """All scalars and lists at or below a value; a list of mappings counts by its items."""
    if value.is_map():
        for entry in value.entries.values():
            yield from leaves(entry)
    elif value.is_list() and any(item.is_map() for item in value.items):
        for item in value.items:
            yield from leaves(item)
    else:
        yield value


def override(value):
    for leaf in leaves(value):
        leaf.overridden = True


def merged(base, over):
    """Mappings key by key, all else as a whole; `over` counts."""
    if not (base.is_map() and over.is_map()):
        override(base)
        return over
    if base is over:
        return base
    entries = dict(base.entries)
    for key, value in over.entries.items():
        entries[key] = merged(entries[key], value) if key in entries else value
    return Value(over.place, over.path, entries=entries)


class _Reader:
    def __init__(self, name):
        self.name = name
        self.known = {}       # of nodes: anchors are read once, and stay one value
        self.open = set()
        self.scalars = yaml.SafeLoader("")
        self.repeated = []    # values of keys that are given twice

    def place(self, node):
        return f"{self.name}:{node.start_mark.line + 1}"

    def value(self, node, path):
        if id(node) in self.known:
            return self.known[id(node)]
        if id(node) in self.open:
            raise Refusal(f"{self.place(node)}: {path}: an anchor holds itself; write its content out")
        self.open.add(id(node))
        if isinstance(node, yaml.MappingNode):
            result = self.mapping(node, path)
        elif isinstance(node, yaml.SequenceNode):
            items = [self.value(item, f"{path}[{i}]") for i, item in enumerate(node.value)]
            result = Value(self.place(node), path, items=items)
        else:
            result = self.scalar(node, path)
        self.open.discard(id(node))
        self.known[id(node)] = result
        return result

    def mapping(self, node, path):
        entries, inherited = {}, {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise Refusal(f"{self.place(key_node)}: {path}: a key must be a text")
            if key_node.tag == MERGE:
                for source in self.sources(value_node, path):
                    for key, value in source.entries.items():
                        inherited.setdefault(key, value)
                continue
            self.add(entries, key_node.value, value_node, path)
        for key, value in inherited.items():
            if key in entries:
                override(value)
            entries.setdefault(key, value)
        return Value(self.place(node), path, entries=entries)

    def add(self, entries, key, node, path):
        """`a/b: 1` is `a: {b: 1}` on the parameter server."""
        first, *rest = [part for part in key.split("/") if part] or [key]
        value = self.value(node, "/".join(part for part in (path, first, *rest) if part))
        for part in reversed(rest):
            value = Value(value.place, value.path, entries={part: value})
        if first in entries and rest:
            value = merged(entries[first], value)
        elif first in entries:
            override(entries[first])
            self.repeated.append(entries[first])
        entries[first] = value

    def sources(self, node, path):
        """Of a merge key (<<), what counts most first."""
        nodes = node.value if isinstance(node, yaml.SequenceNode) else [node]
        sources = [self.value(source, path) for source in nodes]
        for source in sources:
            if not source.is_map():
                raise Refusal(f"{self.place(node)}: {path}: `<<` takes a mapping, not "
                              f"`{source.shown()}`")
        return sources

    def scalar(self, node, path):
        text, tag = node.value, node.tag
        match = ANGLE.match(text) if node.style is None else None
        if tag in ANGLE_TAGS or match:
            unit, inner = match.groups() if match else (ANGLE_TAGS[tag], text)
            return Value(self.place(node), path, text, self.angle(unit, inner, node, path))
        if not tag.startswith("tag:yaml.org,2002:"):
            raise Refusal(f"{self.place(node)}: {path}: `{text}` has the tag `{tag}`, which rosparam "
                          "does not know; leave it out")
        try:
            value = self.scalars.construct_object(node)
        except (yaml.YAMLError, ValueError, OverflowError):
            value = text  # a date that is none, a number that is none
        return Value(self.place(node), path, text, value)

    def angle(self, unit, text, node, path):
        try:
            found = Formula(text).linear()
            if not found.constant():
                raise NotLinear(f"`{found.variable}` has no value")
        except (FormulaError, NotLinear) as error:
            raise Refusal(f"{self.place(node)}: {path}: `{node.value}` is no angle: {error}") from None
        return math.radians(found.offset) if unit == "deg" else found.offset


def load(path, name):
    """@return (the mapping in a file, values that were given twice); `name` is told in messages."""
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise Refusal(f"{name}: cannot be read: {error.strerror}; check the path") from None
    except UnicodeDecodeError as error:
        raise Refusal(f"{name}: is no text (byte {error.start + 1} is not UTF-8); give the YAML file "
                      "that roslaunch loads") from None
    reader = _Reader(name)
    try:
        node = yaml.compose(text, Loader=yaml.SafeLoader)
        if node is None:
            return Value(f"{name}:1", "", entries={}), []
        value = reader.value(node, "")
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f":{mark.line + 1}" if mark is not None else ""
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        raise Refusal(f"{name}{line}: is no YAML: {problem}; mend that line") from None
    except RecursionError:
        raise Refusal(f"{name}: is nested too deep") from None
    if not value.is_map():
        raise Refusal(f"{value.place}: `{value.shown()[:40]}` must be a mapping with `bus`, `nodes` "
                      "and so on")
    return value, reader.repeated
