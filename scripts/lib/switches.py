# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""Many mistakes in one build, each behind a switch that is set at run time (docs/mutation.md)."""
import concurrent.futures
import json
import pathlib
import random
import re
import shlex
import subprocess

import mutations

# The number of the mistake that is made; none by default.
HEADER = """#pragma once
#include <cstdlib>
inline const int cia402_mistake = [] {
  const char* number = std::getenv("CIA402_MISTAKE");
  return number != nullptr ? std::atoi(number) : 0;
}();
"""
VARIABLE = "CIA402_MISTAKE"
CONDITION = re.compile(r"(\s*(?:\} else )?(?:if|while) )\(")
LOOP = re.compile(r"(\s*for \([^;]*;)([^;]*)(;.*)$")
INITIAL = re.compile(r"(\s*(?:const )?[\w:]+(?:<[^=]*>)?(?:\*|\* const)? \w+ = )(.*);$")
INLINE = re.compile(r"(.*\{ return )([^;{}]*)(; ?\}.*)$")


def balanced(text):
    return text.count("(") == text.count(")") and text.count("{") == text.count("}")


def between(text, head, tail):
    """What stands between two ends of a text, or None if it has not those ends."""
    if len(text) < len(head) + len(tail) or not (text.startswith(head) and text.endswith(tail)):
        return None
    return text[len(head):len(text) - len(tail)]


def expression(head, before, tail, after, number, kind="{}"):
    """A line with one of two expressions, or None where the mistake is not in the expression."""
    changed = between(after, head, tail)
    if changed is None:
        return None
    made = f"cia402_mistake == {number} ? {kind.format(f'({changed})')} : {kind.format(f'({before})')}"
    return head + made + tail


def switched(line, code, mutation, begins, following, number):
    """The line with a switch for its mistake, or None where that cannot be written on one line.

    @param code the line without comments and literals. @param begins a statement begins with it.
    @param following the next line of code.
    """
    end = len(code.rstrip())
    comment, line, code = line[end:], line[:end], code[:end]
    after = mutation.after
    if comment.strip() and after:
        after = between(after, "", comment)
        if after is None:
            return None
    words = code.strip()
    if "constexpr" in code or words.startswith(("case ", "static", "using ")):
        return None
    if mutation.kind == "returns early":
        return f"{line} if (cia402_mistake == {number}) {after[len(line):].strip()}"
    indent = line[:len(line) - len(line.lstrip())]
    line, after = line.strip(), after.strip()
    guard = begins and mutations.GUARD.match(words) and not following.startswith("else")
    ends = begins and re.match(r"return .*;$", words)
    plain = (begins and mutations.STATEMENT.match(words) and not mutations.NO_STATEMENT.match(words)
             and words.count("(") == words.count(")"))
    if guard or plain or (ends and balanced(words)):
        both = f"if (cia402_mistake == {number}) {{ {after} }} else {{ {line} }}"
        return f"{indent}do {{ {both} }} while (false);" if plain else f"{indent}{{ {both} }}"
    condition = CONDITION.match(code)
    if condition:
        close = mutations.closing(code, condition.end() - 1) - len(indent)
        inside, head = line[condition.end() - len(indent):close], condition.group(1).strip() + " ("
        if close < 0 or ";" in inside or re.match(r"(const|auto)\b", inside):
            return None
        made = expression(head, inside, line[close:], after, number, "bool{}")
        return made and indent + made
    for shape, kind in ((LOOP, "bool{}"), (INITIAL, "{}"), (INLINE, "{}")):
        found = shape.match(line)
        if found and (shape is not INITIAL or (begins and balanced(words))):
            tail = found.group(3) if shape is not INITIAL else ";"
            made = expression(found.group(1), found.group(2), tail, after, number, kind)
            return made and indent + made
    return None


def with_switches(file, text, first, generator):
    """@return the text with a switch in each line that can have one, {number: mutation} from `first`."""
    lines, codes = text.split("\n"), mutations.masked(text).split("\n")
    of_line = {}
    for mutation in mutations.mutations_of(file, text):
        of_line.setdefault(mutation.line, []).append(mutation)
    made, before, out = {}, ";", list(lines)
    for number, (line, code) in enumerate(zip(lines, codes), 1):
        choices = of_line.get(number, [])
        generator.shuffle(choices)
        following = codes[number].strip() if number < len(codes) else ""
        for mutation in choices:
            new = switched(line, code, mutation, before in ";{}:", following, first + len(made))
            if new:
                out[number - 1] = new
                made[first + len(made)] = mutation
                break
        before = code.strip()[-1:] or ";"
    if out[0].startswith("//"):
        out[0] = mutations.TOLERANT
    return "\n".join(out), made


class Switches:
    """Puts switches into a copy of the sources and takes those away that do not compile."""

    def __init__(self, repository, build):
        self._repository, self._build = repository, build
        self.mutations = {}

    def put(self, folders, seed):
        (self._build.tree / "mistake.h").write_text(HEADER, encoding="utf-8")
        generator, first = random.Random(seed), 1
        for folder in folders:
            for path in mutations.sources(self._repository / folder):
                file = str(path.relative_to(self._repository))
                text, made = with_switches(file, path.read_text(encoding="utf-8"), first, generator)
                (self._build.tree / file).write_text(text, encoding="utf-8")
                self.mutations.update(made)
                first += len(made)

    def take_away_malformed(self, jobs):
        """@return a problem, or None."""
        database = json.loads((self._build.build / "compile_commands.json").read_text(encoding="utf-8"))
        files = {mutation.file for mutation in self.mutations.values()}
        commands = {}
        for entry in database:
            file = str(pathlib.Path(entry["file"]).relative_to(self._build.tree))
            if file in files:
                commands[file] = shlex.split(entry["command"])
        while commands:
            with concurrent.futures.ThreadPoolExecutor(jobs) as crew:
                errors = dict(zip(commands, crew.map(self._errors, commands.values())))
            left = {file: said for file, said in errors.items() if said}
            taken = sum(self._take_away(said) for said in left.values())
            if left and taken == 0:
                return next(iter(left.values()))
            commands = {file: commands[file] for file in left}
        return None

    def _errors(self, command):
        at = command.index("-o")
        done = subprocess.run(command[:at] + command[at + 2:] + ["-w", "-fsyntax-only"],
                              cwd=self._build.build, stdin=subprocess.DEVNULL, text=True,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        return done.stderr if done.returncode else ""

    def _take_away(self, said):
        places = {(file, int(line)) for file, line in
                  re.findall(r"\b(src/[\w./]+):(\d+):\d+: (?:fatal )?error", said)}
        bad = [number for number, mutation in self.mutations.items()
               if (mutation.file, mutation.line) in places]
        for number in bad:
            mutation = self.mutations.pop(number)
            path = self._build.tree / mutation.file
            lines = path.read_text(encoding="utf-8").split("\n")
            lines[mutation.line - 1] = mutation.before
            path.write_text("\n".join(lines), encoding="utf-8")
        return len(bad)
