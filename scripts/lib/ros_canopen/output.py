# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""The robot's file: keys in their order, each with a comment that says where it comes from."""
import json
import re

PLAIN = re.compile(r"^[A-Za-z_/.][A-Za-z0-9_/.:+-]*$")
WORDS = {"true", "false", "yes", "no", "on", "off", "null", "y", "n", "none", ".nan", ".inf"}
WIDTH = 104


def number_text(number):
    """As PyYAML and yaml-cpp both take it for the same number; whole ones beyond 32 bits as floats."""
    text = f"{number:.12g}"
    if "e" in text:
        mantissa, exponent = text.split("e")
        return mantissa + ("" if "." in mantissa else ".0") + "e" + exponent
    if "." not in text and abs(number) >= 2 ** 31:
        return text + ".0"
    return "0" if text == "-0" else text


def raw_text(number):
    """A number of the drive: XML-RPC has 32 bits with sign, so larger ones are a text."""
    return str(number) if -2 ** 31 <= number < 2 ** 31 else f"\"0x{number & (2 ** 64 - 1):X}\""


def quoted(text):
    plain = PLAIN.match(text) and text.lower() not in WORDS and not text.endswith(":")
    return text if plain else json.dumps(text)


def flow(names):
    return "[" + ", ".join(quoted(name) for name in names) + "]"


def one_line(text):
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(str(text).split()))


class Section:
    """Keys in order; a value is a text that is YAML already, or a Section, or a list of such texts."""

    def __init__(self, comment=""):
        self.comment = comment
        self.rows = []  # (key or None, value, comment)

    def add(self, key, value, comment=""):
        self.rows.append((key, value, one_line(comment)))
        return value

    def note(self, text):
        self.rows.append((None, None, one_line(text)))

    def empty(self):
        return not self.rows

    def lines(self, indent=0):
        for key, value, comment in self.rows:
            pad = " " * indent
            if key is None:
                yield from _wrapped(pad, comment)
            elif isinstance(value, Section):
                yield from _row(pad, f"{key}:", value.comment)
                yield from value.lines(indent + 2)
            elif isinstance(value, list):
                yield from _row(pad, f"{key}:", comment)
                for item, why in value:
                    yield from _row(pad + "  ", f"- {item}", one_line(why))
            else:
                yield from _row(pad, f"{key}: {value}", comment)

    def text(self):
        return "".join(line + "\n" for line in self.lines())


def _row(pad, text, comment):
    line = pad + text
    if comment and len(line) + 3 + len(comment) > WIDTH:
        yield from _wrapped(pad, comment)
        yield line
    else:
        yield line + (f"  # {comment}" if comment else "")


def _wrapped(pad, text):
    """As a comment of several lines where one is too short."""
    line = ""
    for word in text.split():
        if line and len(pad) + 2 + len(line) + 1 + len(word) > WIDTH:
            yield f"{pad}# {line}"
            line = word
        else:
            line = f"{line} {word}" if line else word
    yield f"{pad}# {line}"
