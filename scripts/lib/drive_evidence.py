# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""What is said of the drive families, and which tests have shown it: for drive_table.py."""
import fnmatch
import re

import yaml

STATES = ("done", "not possible", "open")
SHORT = {"profile_position": "pp", "velocity": "vl", "profile_velocity": "pv", "profile_torque": "pt",
         "homing": "hm", "interpolated_position": "ip", "cyclic_position": "csp",
         "cyclic_velocity": "csv", "cyclic_torque": "cst"}

# `Suite.Case`, `Suite.Case/parameter` or with * for anything, in backticks.
TEST_NAME = re.compile(r"`([A-Z][\w*]*(?:/[\w*]+)?\.[A-Za-z*][\w*/]*)`")
# A case of GoogleTest in the results of scripts/test, under a sanitizer or not.
RESULT = re.compile(r"(?:under \w+ sanitizer: )?test_\w+: (?:[^/.]+/)?(\w+(?:/\w+)?\.\S+)$")
COUNT = re.compile(r"\[checklist\]\(#checklist\) has (\d+) items")
ROW = re.compile(r"\|(.*)\|\s*$")


class Results:
    """Tests that have run, by name; a test that ran more than once must have passed each time."""

    def __init__(self, file):
        self._reasons = {}  # name: why it failed, or None
        for line in file.read_text(encoding="utf-8").splitlines():
            outcome, name, _, reason = (line + "\t\t\t").split("\t")[:4]
            case = RESULT.match(name)
            if case is not None:
                why = None if outcome == "passed" else reason or outcome
                self._reasons[case[1]] = self._reasons.get(case[1]) or why

    def __len__(self):
        return len(self._reasons)

    def matching(self, pattern):
        """Names that fit; a pattern without a parameter stands for all parameters."""
        return sorted({*fnmatch.filter(self._reasons, pattern),
                       *fnmatch.filter(self._reasons, pattern + "/*")})

    def problem(self, pattern):
        """Why this shows nothing, or None."""
        names = self.matching(pattern)
        if not names:
            return "no test of that name has run"
        failed = [name for name in names if self._reasons[name]]
        if not failed:
            return None
        more = f", as {len(failed) - 1} more" if len(failed) > 1 else ""
        return f"{failed[0]} failed: {self._reasons[failed[0]]}{more}"


class Checklist:
    """The table under `## Checklist` of a family's document; what is wrong goes to problems."""

    def __init__(self, file, results, problems):
        self.counts = dict.fromkeys(STATES, 0)
        text = file.read_text(encoding="utf-8")
        self.title = text.partition("\n")[0].lstrip("# ")
        said = COUNT.search(text)
        if said is None:
            problems.append(f"{file.name}: does not say `[checklist](#checklist) has N items`")
            return
        numbers = []
        for line in text.partition("\n## Checklist\n")[2].splitlines():
            if ROW.match(line) is None:
                continue
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", ROW.match(line)[1])]
            if cells[0] == "item" or set(cells[0]) == {"-"}:
                continue
            where = f"{file.name}, item {cells[0]}"
            if len(cells) != 4 or not cells[0].isdigit() or cells[2] not in STATES:
                problems.append(f"{where}: a row is number, what, one of {', '.join(STATES)}, why")
                continue
            numbers.append(int(cells[0]))
            self.counts[cells[2]] += 1
            problems += [f"{where}: {problem}" for problem in problems_of(cells[2], cells[3], results)]
        for number in range(1, int(said[1]) + 1):
            if numbers.count(number) != 1:
                problems.append(f"{file.name}, item {number}: stands there {numbers.count(number)} times")
        for number in sorted(set(numbers) - set(range(1, int(said[1]) + 1))):
            problems.append(f"{file.name}, item {number}: the document says {said[1]} items")


def problems_of(state, shown_by, results):
    """What is wrong with the last cell of an item."""
    tests = TEST_NAME.findall(shown_by)
    if state == "done" and not tests:
        yield "is done, and names no test"
    if state != "done" and not TEST_NAME.sub("", shown_by).strip(" ,;:"):
        yield f"is {state}, and does not say why"
    for test in tests:
        problem = results.problem(test)
        if problem is not None:
            yield f"`{test}`: {problem}"


class Family:
    """A profile with its modes and homing methods, and which tests show each."""

    def __init__(self, file):
        profile = yaml.safe_load(file.read_text(encoding="utf-8"))
        self.name = profile["name"]
        self.description = profile.get("description", self.name)
        self.modes = {name: mode["value"] for name, mode in profile["modes"].items()
                      if mode["control"] != "homing"}
        homing = profile.get("homing") or {}
        self.methods = list(homing.get("methods") or ([homing["kind"]] if homing else []))
        self.shown = {item: set() for item in (*self.modes, *self.methods)}  # by which tests
        self.starts = {method: set() for method in self.methods}  # the same, a name for each start

    def find(self, rules, results, used):
        """Looks for the tests of a section of tests.yaml; adds the patterns that fit to used."""
        for kind, items in (("modes", self.modes), ("methods", self.methods)):
            for pattern in rules.get(kind, ()):
                for item in items:
                    for name in {item, SHORT.get(item, item)}:
                        self._show(item, pattern, results, used, **{kind[:-1]: name})
        for pattern, items in rules.get("named", {}).items():
            for item in items:
                if item in self.shown:
                    self._show(item, pattern, results, used)

    def _show(self, item, pattern, results, used, **names):
        full = pattern.format(family=self.name, mode=names.get("mode"), method=names.get("method"))
        if results.matching(full):
            used.add(pattern)
            if results.problem(full) is None:
                self.shown[item].add(full.partition("/")[0])
                if item in self.starts:
                    self.starts[item].update(results.matching(full))

    def missing_starts(self, rules):
        """What is wrong with the number of starts of the homing methods, by `starts` of tests.yaml."""
        for number, methods in rules.get("starts", {}).items():
            for method in methods:
                if method not in self.starts:
                    yield f"the profile has no `{method}`"
                elif len(self.starts[method]) < number:
                    yield f"`{method}` is shown from {len(self.starts[method])} of {number} starts"


def families(folder, rules, results, problems):
    """The families of a folder of profiles, with the tests that show them, by name."""
    known = [Family(file) for file in sorted(folder.glob("*.yaml"))]
    used = set()
    for family in known:
        for section in ("all", family.name):
            family.find(rules.get(section) or {}, results, used)
    for section, rule in rules.items():
        patterns = [*rule.get("modes", ()), *rule.get("methods", ()), *rule.get("named", {})]
        problems += [f"tests.yaml, {section}: `{pattern}` fits no test that has run"
                     for pattern in patterns if pattern not in used]
        family = next((family for family in known if family.name == section), None)
        if family is not None:
            named = {item for items in rule.get("named", {}).values() for item in items}
            problems += [f"tests.yaml, {section}: the profile has no `{item}`"
                         for item in sorted(named - set(family.shown), key=str)]
            problems += [f"tests.yaml, {section}: {problem}" for problem in family.missing_starts(rule)]
        elif section != "all":
            problems.append(f"tests.yaml, {section}: there is no such profile")
    return known
