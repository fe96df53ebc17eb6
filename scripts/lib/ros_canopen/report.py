# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What became of each key."""
from .tree import leaves

CONVERTED, APPROXIMATED, NONE = "converted", "approximated", "no counterpart"


class Report:
    def __init__(self):
        self.entries = []  # (kind, place, path, text), each once, in their order
        self._known = set()

    def _tell(self, kind, value, text, path=None):
        """@param value a Value, or (place, path) of what is not in the YAML."""
        if isinstance(value, tuple):
            place, path = value
        else:
            for leaf in leaves(value):
                leaf.told = True
            place, path = value.place, f"{path or value.path}: `{value.shown()}`"
        entry = (kind, place, path, text)
        if entry not in self._known:
            self._known.add(entry)
            self.entries.append(entry)

    def done(self, value, text):
        self._tell(CONVERTED, value, text)

    def about(self, value, text):
        self._tell(APPROXIMATED, value, text)

    def none(self, value, why, instead=""):
        self._tell(NONE, value, why + (f"; {instead}" if instead else ""))

    def count(self, kind):
        return sum(entry[0] == kind for entry in self.entries)

    def lines(self, kind):
        return [f"{place}: {path}: {text}" if place else f"{path}: {text}"
                for found, place, path, text in self.entries if found == kind]

    def text(self):
        parts = []
        for kind in (CONVERTED, APPROXIMATED, NONE):
            lines = self.lines(kind)
            parts.append(f"{kind} ({len(lines)}):\n" + "".join(f"  {line}\n" for line in lines))
        return "".join(parts)


def _untold(value):
    """The highest values of which nothing was told."""
    below = list(leaves(value))
    if below and not any(leaf.told or leaf.overridden for leaf in below):
        yield value
        return
    for entry in (value.entries or {}).values():
        yield from _untold(entry)
    for item in value.items or []:
        if item.is_map():
            yield from _untold(item)
    if not value.is_map() and not value.told and value.overridden:
        yield value


def contents(value):
    """All that is below, in one line."""
    def below(leaf):
        inside = leaf.path.startswith(value.path + "/")  # else it comes from an anchor elsewhere
        return leaf.path[len(value.path) + 1:] if inside else leaf.path
    return ", ".join(f"{below(leaf)}={leaf.shown()}" for leaf in leaves(value) if not leaf.told)


def sweep(report, root, hints):
    """Names all that nothing has told yet. @param hints key: (why, what to do instead)"""
    for value in list(_untold(root)):
        if all(leaf.told for leaf in leaves(value)):
            continue  # by another name: an anchor
        if value.overridden:
            report.done(value, "counts for nothing: another value is given in its place")
            continue
        name = value.path.rsplit("/", 1)[-1].split("[")[0]
        why, instead = hints.get(name, ("ros_canopen does not read it, and nothing here is like it",
                                        ""))
        if value.is_map():
            inside = contents(value)
            report.none((value.place, value.path or "the file"),
                        f"{why} (in it: {inside or 'nothing'})", instead)
            for leaf in leaves(value):
                leaf.told = True
        else:
            report.none(value, why, instead)
