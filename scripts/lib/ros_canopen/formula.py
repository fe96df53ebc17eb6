# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Conversion formulas of ros_canopen: what muParser takes, and whether it is a factor and an offset.

    Formula("rint(rad2deg(pos)*1000)").linear()     # factor 57295.78 of `pos`, offset 0

A formula is read, never run: there is no eval here.
"""
import math
import re

MOST_TOKENS, MOST_DEPTH = 300, 40

TOKEN = re.compile(r"""\s*(?:
    (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
  | (?P<name>[A-Za-z_][A-Za-z_0-9]*)
  | (?P<sign>&&|\|\||<=|>=|==|!=|[-+*/^()<>=?:,])
)""", re.VERBOSE)

# How tightly they bind; `^` and `=` group from the right.
BINDING = {"||": 2, "&&": 3, "==": 4, "!=": 4, "<": 4, ">": 4, "<=": 4, ">=": 4,
           "+": 5, "-": 5, "*": 6, "/": 6, "^": 8}
SIGN_BINDS = 7  # -2^2 is -4
CONSTANTS = {"pi": math.pi, "_pi": math.pi, "_e": math.e, "nan": math.nan}


def _norm(value, low, high):
    return low + (value - low) % (high - low)


def _smooth(value, old, share):
    return share * value + (1 - share) * old


# name: (how many arguments, or None: one or more, and what it makes of numbers)
FUNCTIONS = {
    "rad2deg": (1, math.degrees), "deg2rad": (1, math.radians), "norm": (3, _norm),
    "smooth": (3, _smooth), "avg": (None, lambda *a: sum(a) / (len(a) + 1)),
    "rint": (1, round), "abs": (1, abs), "sign": (1, lambda x: (x > 0) - (x < 0)),
    "sqrt": (1, math.sqrt), "exp": (1, math.exp), "ln": (1, math.log), "log": (1, math.log),
    "log2": (1, math.log2), "log10": (1, math.log10), "sin": (1, math.sin), "cos": (1, math.cos),
    "tan": (1, math.tan), "asin": (1, math.asin), "acos": (1, math.acos), "atan": (1, math.atan),
    "sinh": (1, math.sinh), "cosh": (1, math.cosh), "tanh": (1, math.tanh),
    "asinh": (1, math.asinh), "acosh": (1, math.acosh), "atanh": (1, math.atanh),
    "atan2": (2, math.atan2), "min": (None, min), "max": (None, max),
    "sum": (None, lambda *a: sum(a)),
}
WHY_NOT = {"norm": "`norm` wraps the number round", "smooth": "`smooth` filters over time",
           "avg": "`avg` takes the mean of several numbers", "abs": "`abs` loses the sign",
           "sign": "`sign` keeps nothing but the sign"}
COMPARISONS = {"==": lambda a, b: a == b, "!=": lambda a, b: a != b, "<": lambda a, b: a < b,
               ">": lambda a, b: a > b, "<=": lambda a, b: a <= b, ">=": lambda a, b: a >= b,
               "&&": lambda a, b: bool(a) and bool(b), "||": lambda a, b: bool(a) or bool(b)}


class FormulaError(Exception):
    """Not what muParser takes; says where."""


class NotLinear(Exception):
    """A formula that is more than a factor and an offset; says why."""


class Linear:
    """factor * variable + offset; `variable` is None where there is none."""

    def __init__(self, factor=0.0, variable=None, offset=0.0, rounded=False, notes=()):
        self.factor, self.variable, self.offset = factor, variable, offset
        self.rounded = rounded  # to whole numbers, as the last thing
        self.notes = list(notes)  # what is not taken over

    def constant(self):
        return self.variable is None

    def times(self, number):
        return Linear(self.factor * number, self.variable, self.offset * number,
                      notes=self._loses())

    def plus(self, other, sign):
        names = {name for name in (self.variable, other.variable) if name is not None}
        if len(names) > 1:
            raise NotLinear("it takes two numbers, " + " and ".join(sorted(names)))
        return Linear(self.factor + sign * other.factor, names.pop() if names else None,
                      self.offset + sign * other.offset,
                      notes=self._loses() + other._loses())  # pylint: disable=protected-access

    def _loses(self):
        """Rounding that something follows is left out, and told."""
        return self.notes + (["rounds on the way (`rint`), which is left out"] if self.rounded else [])


class Formula:
    """One formula; FormulaError where it is none."""

    def __init__(self, text):
        self.text = text
        self._tokens = self._split(text)
        self._next = 0
        self._depth = 0
        self._tree = self._list_of_values()
        if self._peek() is not None:
            self._fail(f"`{self._peek()}` stands where nothing more may follow")

    def linear(self):
        """@return Linear; NotLinear says why it is not."""
        first, others = self._tree[0], self._tree[1:]
        result = _linear(first)
        if not (math.isfinite(result.factor) and math.isfinite(result.offset)):
            raise NotLinear("it has no finite value")
        if others:
            result.notes.append("further formulas behind a comma are left out")
        return result

    # Reading

    def _split(self, text):
        tokens, at = [], 0
        text = text.rstrip()
        if not text:
            raise FormulaError("it is empty")
        while at < len(text):
            match = TOKEN.match(text, at)
            if match is None:
                raise FormulaError(f"`{text[at:].strip()[:20]}` (from character {at + 1} on) is no "
                                   "part of a formula")
            tokens.append((match.lastgroup, match[match.lastgroup], match.start(match.lastgroup)))
            at = match.end()
            if len(tokens) > MOST_TOKENS:
                raise FormulaError(f"it has more than {MOST_TOKENS} parts")
        return tokens

    def _fail(self, what):
        at = self._tokens[self._next][2] + 1 if self._next < len(self._tokens) else len(self.text)
        raise FormulaError(f"{what} (character {at})")

    def _peek(self):
        return self._tokens[self._next][1] if self._next < len(self._tokens) else None

    def _take(self, wanted):
        if self._peek() != wanted:
            self._fail(f"`{wanted}` is missing" if self._peek() is None
                       else f"`{wanted}` is missing before `{self._peek()}`")
        self._next += 1

    def _list_of_values(self):
        values = [self._choice()]
        while self._peek() == ",":
            self._next += 1
            values.append(self._choice())
        return values

    def _choice(self):
        """condition ? one : other, and name = value."""
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self._fail("it is nested too deep")
        left = self._binary(0)
        if self._peek() == "?":
            self._next += 1
            one = self._choice()
            self._take(":")
            left = ("choice", left, one, self._choice())
        elif self._peek() == "=":
            if left[0] != "name":
                self._fail("only a variable can be set by `=`")
            self._next += 1
            left = ("set", left[1], self._choice())
        self._depth -= 1
        return left

    def _binary(self, binds):
        left = self._operand()
        while BINDING.get(self._peek(), -1) > binds:
            sign = self._peek()
            self._next += 1
            right = self._binary(BINDING[sign] - (1 if sign == "^" else 0))
            left = ("sign", sign, left, right)
        return left

    def _operand(self):
        if self._next >= len(self._tokens):
            self._fail("it ends where a number or a name should stand")
        kind, text, _ = self._tokens[self._next]
        if kind == "sign" and text in "+-":
            return self._signed(text)
        if kind == "sign" and text != "(":
            self._fail(f"`{text}` stands where a number or a name should")
        self._next += 1
        if kind == "number":
            return ("number", float(text))
        if kind == "name":
            return self._call(text) if self._peek() == "(" else ("name", text)
        inner = self._choice()
        self._take(")")
        return inner

    def _signed(self, sign):
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self._fail("it is nested too deep")
        self._next += 1
        operand = self._binary(SIGN_BINDS - 1)
        self._depth -= 1
        return ("sign", "*", ("number", -1.0 if sign == "-" else 1.0), operand)

    def _call(self, name):
        if name not in FUNCTIONS:
            self._next -= 1
            self._fail(f"there is no function `{name}`")
        self._take("(")
        arguments = [] if self._peek() == ")" else self._list_of_values()
        self._take(")")
        wanted = FUNCTIONS[name][0]
        if len(arguments) != wanted and not (wanted is None and arguments):
            self._fail(f"`{name}` takes {wanted or 'at least 1'} argument(s), not {len(arguments)}")
        return ("call", name, arguments)


# What it is of its variable

def _linear(tree):
    return {"number": lambda: Linear(offset=tree[1]), "name": lambda: _name(tree[1]),
            "sign": lambda: _sign(*tree[1:]), "call": lambda: _call(*tree[1:]),
            "choice": lambda: _choice(*tree[1:]), "set": lambda: _set(tree[1])}[tree[0]]()


def _name(name):
    return Linear(offset=CONSTANTS[name]) if name in CONSTANTS else Linear(1.0, name)


def _set(name):
    raise NotLinear(f"it remembers a number from before (`{name} =`)")


def _choice(condition, one, other):
    known = _linear(condition)
    if not known.constant():
        raise NotLinear("it chooses between two formulas (`?`)")
    return _linear(one if known.offset else other)


def _sign(sign, left, right):
    one, other = _linear(left), _linear(right)
    if sign in COMPARISONS:
        if not (one.constant() and other.constant()):
            raise NotLinear(f"it compares (`{sign}`)")
        return Linear(offset=float(COMPARISONS[sign](one.offset, other.offset)))
    if sign in "+-":
        return one.plus(other, 1 if sign == "+" else -1)
    if sign == "*":
        if not (one.constant() or other.constant()):
            raise NotLinear(f"it multiplies {one.variable} by {other.variable}")
        return other.times(one.offset) if one.constant() else one.times(other.offset)
    if not other.constant():
        raise NotLinear(f"{other.variable} "
                        "stands " + ("in an exponent" if sign == "^" else "below a `/`"))
    if sign == "/":
        if other.offset == 0:
            raise NotLinear("it divides by 0")
        return one.times(1 / other.offset)
    return _power(one, other.offset)


def _power(base, exponent):
    if exponent == 1:
        return base
    if not base.constant():
        raise NotLinear(f"it takes {base.variable} to the power of {exponent:g}")
    return Linear(offset=_number(lambda: base.offset ** exponent, "^"))


def _call(name, arguments):
    values = [_linear(argument) for argument in arguments]
    function = FUNCTIONS[name][1]
    if all(value.constant() for value in values):
        return Linear(offset=_number(lambda: function(*[value.offset for value in values]), name))
    if name == "rint":
        return Linear(values[0].factor, values[0].variable, values[0].offset, True, values[0].notes)
    if name in ("rad2deg", "deg2rad"):
        return values[0].times(function(1.0))
    raise NotLinear(WHY_NOT.get(name, f"`{name}` is no factor"))


def _number(compute, name):
    try:
        value = compute()
    except (ArithmeticError, ValueError):
        raise NotLinear(f"`{name}` has no value here") from None
    if isinstance(value, complex) or not math.isfinite(value):
        raise NotLinear(f"`{name}` has no value here")
    return float(value)
