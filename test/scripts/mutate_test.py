#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/mutations.py and mutate.py: which lines are broken how, and that they are put back."""
import pathlib
import sys
import tempfile
import time
import unittest

LIB = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "lib"
sys.path.insert(0, str(LIB))
import mutate  # noqa: E402
import mutations  # noqa: E402

HEAD = "// Copyright\n"
FUNCTION = HEAD + """
bool Axis::late(Time now) {
  if (now < due_ && !done_) return false;
  count_ += 2;
  report(now);
  return true;
}
"""


def changes(line, inside=True):
    """{(kind, line afterwards)} of one line, in a function or not."""
    text = f"{HEAD}\nvoid f() {{\n{line}\n}}\n" if inside else f"{HEAD}\n{line}\n"
    number = 4 if inside else 3
    return {(found.kind, found.after.strip()) for found in mutations.mutations_of("a.cpp", text)
            if found.line == number}


class Mutations(unittest.TestCase):
    def test_what_is_in_comments_and_literals_is_no_code(self):
        text = ("a = 1;  // b == 2\n/* c < 3\n d */ e = \"f && \\\" 4\" + '\\'' + R\"(g\n > 5)\";\n"
                "h = 0xFF'FF + 1'000;\n")
        masked = mutations.masked(text)
        self.assertEqual(len(masked), len(text))
        self.assertEqual([i for i, c in enumerate(masked) if c == "\n"],
                         [i for i, c in enumerate(text) if c == "\n"])
        self.assertEqual(masked.split(), ["a", "=", "1;", "e", "=", "+", "+", ";", "h", "=",
                                          "0xFF'FF", "+", "1'000;"])

    def test_a_condition_can_be_negated_and_its_parts_be_mistaken(self):
        self.assertEqual(changes("  if (now < due_ && !done_) return false;"), {
            ("condition negated", "if (!(now < due_ && !done_)) return false;"),
            ("comparison", "if (now <= due_ && !done_) return false;"),
            ("logic", "if (now < due_ || !done_) return false;"),
            ("truth", "if (now < due_ && !done_) return true;"),
            ("statement deleted", "")})

    def test_every_comparison_has_its_neighbour(self):
        for one, other in (("<", "<="), (">", ">="), ("==", "!=")):
            for operator, instead in ((one, other), (other, one)):
                self.assertIn(("comparison", f"return a {instead} b;"),
                              changes(f"  return a {operator} b;"))

    def test_numbers_are_off_by_one(self):
        for number, instead in (("9", "10"), ("0x0F", "0x10"), ("0xFFU", "0x100U"), ("0.5", "1.5"),
                                ("1'000", "1001"), ("2.0F", "3.0F")):
            self.assertIn(("constant off by one", f"use({instead});"), changes(f"  use({number});"))
        self.assertNotIn("constant off by one", {kind for kind, _ in changes("  use(int32_t{}, a2);")})

    def test_signs_are_mistaken_but_texts_are_joined(self):
        self.assertIn(("arithmetic", "return a - b * c;"), changes("  return a + b * c;"))
        self.assertIn(("arithmetic", "return a + b / c;"), changes("  return a + b * c;"))
        self.assertEqual(changes('  return a + "b";'), set())

    def test_templates_pointers_and_references_are_no_operators(self):
        self.assertEqual(changes("  std::vector<const Axis*> a(Axis&& b, Axis& c);"), set())

    def test_calls_and_assignments_can_be_forgotten_declarations_cannot(self):
        for line in ("report(now);", "a_.b->c(d);", "a = b;", "a[i].b += c;", "++count_;", "*a = b;"):
            self.assertIn(("statement deleted", ""), changes("  " + line), line)
        for line in ("int a = b;", "return a(b);", "const auto a = b(c);", "Time a(b);", "break;",
                     "using A = B;"):
            self.assertNotIn(("statement deleted", ""), changes("  " + line), line)

    def test_what_goes_on_from_the_line_before_is_no_statement(self):
        text = f"{HEAD}\nvoid f() {{\n  const int a =\n      b(c);\n}}\n"
        self.assertEqual([found.kind for found in mutations.mutations_of("a.cpp", text)],
                         ["returns early"])

    def test_functions_return_early(self):
        for line, instead in (("void f(int a) {", "return;"), ("int* A::f() const {", "return {};"),
                              ("static Result<int> f() {", "return {};")):
            self.assertEqual(changes(line, inside=False),
                             {("returns early", f"{line} {instead}")}, line)
        for line in ("A::A(int a) {", "if (a) {", "namespace a {", "const auto f = [](int a) {"):
            self.assertNotIn("returns early", {kind for kind, _ in changes(line, inside=False)}, line)

    def test_a_signature_of_two_lines_is_read_as_a_whole(self):
        text = f"{HEAD}\nvoid f(int a,\n       int b) {{\n}}\n"
        self.assertEqual([found.after for found in mutations.mutations_of("a.cpp", text)],
                         ["       int b) { return;"])

    def test_mistakes_are_made_in_all_folders_of_a_module_but_that_of_programs(self):
        with tempfile.TemporaryDirectory() as directory:
            module = pathlib.Path(directory)
            for file in ("a.cpp", "axis/b.h", "axis/steps/c.cpp", "main/d.cpp", "axis/e.yaml"):
                (module / file).parent.mkdir(parents=True, exist_ok=True)
                (module / file).write_text("", encoding="utf-8")
            found = [str(path.relative_to(module)) for path in mutations.sources(module)]
            self.assertEqual(found, ["a.cpp", "axis/b.h", "axis/steps/c.cpp"])

    def test_a_seed_draws_the_same_lines_again_and_each_once(self):
        found = [one for file in ("a.cpp", "b.cpp") for one in mutations.mutations_of(file, FUNCTION)]
        draw = [str(one) for one in mutations.drawn(found, 7)]
        self.assertEqual(draw, [str(one) for one in mutations.drawn(reversed(list(reversed(found))), 7)])
        self.assertNotEqual(draw, [str(one) for one in mutations.drawn(found, 8)])
        self.assertEqual(len(draw), 10)
        self.assertEqual({place.split()[0] for place in draw},
                         {f"{file}:{line}" for file in ("a.cpp", "b.cpp") for line in (3, 4, 5, 6, 7)})

    def test_only_the_line_is_changed_and_none_moves(self):
        for mutation in mutations.mutations_of("a.cpp", FUNCTION):
            after = mutations.broken(FUNCTION, mutation).split("\n")
            before = FUNCTION.split("\n")
            self.assertEqual(len(after), len(before))
            self.assertEqual([i + 1 for i in range(1, len(before)) if after[i] != before[i]],
                             [mutation.line])
            self.assertTrue(after[0].startswith("_Pragma("))

    def test_another_text_than_the_mutation_was_made_for_is_refused(self):
        mutation = next(mutations.mutations_of("a.cpp", FUNCTION))
        with self.assertRaises(ValueError):
            mutations.broken("\n" + FUNCTION, mutation)


class FakeBuild:
    """Stands in for a build: its tests are scripts, but for test_apart different programs once the
    line is broken."""

    def __init__(self, directory, tests, compiles=True):
        self.directory = self.build = self.tree = directory
        self._tests, self._compiles = tests, compiles
        self.text_when_built = []
        for name, script in tests.items():
            (self.build / name).write_text("#!/bin/bash\n" + script, encoding="utf-8")
            (self.build / name).chmod(0o755)

    def _text(self):
        return (self.tree / "src/drive/a.cpp").read_text(encoding="utf-8")

    def configure(self):
        return True

    def tests(self):
        return list(self._tests)

    def digest(self, test):
        return test if test == "test_apart" else self._text()

    def make(self, _):
        self.text_when_built.append(self._text())
        return self._compiles or self.text_when_built[-1] == FUNCTION


# Fails once the line is broken.
SEES = """grep -q 'count_ += 2;' ../src/drive/a.cpp && exit 0
echo '[  FAILED  ] Axis.IsLate, where TypeParam = int (0 ms)'; exit 1"""


class Judging(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.path = pathlib.Path(directory.name)
        self.file = self.path / "src/drive/a.cpp"
        self.file.parent.mkdir(parents=True)
        self.file.write_text(FUNCTION, encoding="utf-8")
        self.mutation = next(found for found in mutations.mutations_of("src/drive/a.cpp", FUNCTION)
                             if found.after == "  count_ -= 2;")

    def judge(self, tests, compiles=True):
        self.build = FakeBuild(self.path, tests, compiles)
        trial = mutate.Trial(self.build, lambda text: None)
        self.assertIsNone(trial.prepare())
        self.build.text_when_built.clear()
        verdict = trial.judge(self.mutation)
        self.assertEqual(self.file.read_text(encoding="utf-8"), FUNCTION, "put back")
        self.assertTrue(all("  count_ -= 2;" in text for text in self.build.text_when_built))
        return verdict

    def test_the_test_that_fails_has_seen_it(self):
        self.assertEqual(self.judge({"test_bus": "exit 0", "test_drive": SEES}),
                         "seen by test_drive: Axis.IsLate")
        self.assertEqual(len(self.build.text_when_built), 1, "the module's own is the first")

    def test_all_others_are_asked_then(self):
        self.assertEqual(self.judge({"test_drive": "exit 0", "test_bus": SEES}),
                         "seen by test_bus: Axis.IsLate")

    def test_what_no_test_sees_survives(self):
        self.assertEqual(self.judge({"test_drive": "exit 0", "test_bus": "exit 0"}), "survived")

    def test_a_test_without_the_line_in_it_is_not_run(self):
        self.assertEqual(self.judge({"test_drive": "exit 0", "test_apart": SEES}), "survived")

    def test_a_crash_is_seen(self):
        crash = "grep -q 'count_ += 2;' ../src/drive/a.cpp || kill -SEGV $$"
        self.assertEqual(self.judge({"test_drive": crash}), "seen by test_drive: status -11")

    def test_a_test_that_does_not_end_has_seen_it(self):
        script = self.path / "hangs"
        script.write_text("#!/bin/bash\nsleep 1000", encoding="utf-8")
        script.chmod(0o755)
        self.assertEqual(mutate.run_test(script, self.path / "log", 0.1), "not ended after 0 s")

    def test_what_a_program_has_started_ends_with_it(self):
        script = self.path / "starts"
        script.write_text("#!/bin/bash\nsleep 1000 & echo $!; exit 7", encoding="utf-8")
        script.chmod(0o755)
        self.assertEqual(mutate.run([script], self.path / "log", None), 7)
        child = int((self.path / "log").read_text(encoding="utf-8"))
        end = time.monotonic() + 60.0
        while pathlib.Path(f"/proc/{child}/stat").exists() and time.monotonic() < end:
            state = pathlib.Path(f"/proc/{child}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1]
            if state.split()[0] == "Z":
                break  # dead; nobody has asked how
            time.sleep(0.01)
        self.assertLess(time.monotonic(), end, "it goes on")

    def test_what_changes_no_program_is_told(self):
        self.assertEqual(self.judge({"test_apart": SEES}), mutate.SAME)

    def test_what_does_not_compile_is_told(self):
        self.assertEqual(self.judge({"test_drive": SEES}, compiles=False), mutate.MALFORMED)

    def test_the_file_is_put_back_when_judging_is_interrupted(self):
        trial = mutate.Trial(FakeBuild(self.path, {"test_drive": SEES}), lambda text: None)
        trial.prepare()

        def interrupted(_):
            raise KeyboardInterrupt
        trial._build.make = interrupted  # pylint: disable=protected-access
        with self.assertRaises(KeyboardInterrupt):
            trial.judge(self.mutation)
        self.assertEqual(self.file.read_text(encoding="utf-8"), FUNCTION)

    def test_tests_that_fail_unbroken_are_a_problem(self):
        trial = mutate.Trial(FakeBuild(self.path, {"test_drive": "exit 3"}), lambda text: None)
        self.assertEqual(trial.prepare(), "test_drive fails though nothing is broken: status 3")


class FakeTrial:
    """Knows the verdicts of five mutations."""

    VERDICTS = {"a": "survived", "b": mutate.MALFORMED, "c": mutate.SAME,
                "d": "seen by test_x: T.t", "e": "survived"}

    def judge(self, letter):
        return self.VERDICTS[letter]


class Run(unittest.TestCase):
    def test_what_breaks_nothing_is_drawn_anew(self):
        tried = list(mutate.judged("abcde", [FakeTrial(), FakeTrial()], 2))
        self.assertEqual([mutation for mutation, _ in tried], list("abcd"))
        self.assertEqual(mutate.summary([verdict for _, verdict in tried]),
                         "2 lines broken, 1 seen, 1 survived; drawn anew: 1 that did not compile, "
                         "1 of which the compiler made the same program")

    def test_verdicts_are_told_in_the_order_of_drawing(self):
        queue = []

        def latest():
            number, letter = queue.pop()
            return number, FakeTrial.VERDICTS[letter]
        tried = list(mutate.in_order("edcbad", queue.append, latest, 3, 9))
        self.assertEqual(tried, [(letter, FakeTrial.VERDICTS[letter]) for letter in "edcbad"])

    def test_no_more_are_begun_than_may_be_needed(self):
        queue = []
        tried = mutate.in_order("deadeadea", queue.append,
                                lambda: (queue.pop(0)[0], "survived"), 3, 2)
        self.assertEqual(len(list(tried)), 2)
        self.assertEqual([letter for _, letter in queue], list("ad"))

    def test_what_keeps_one_from_judging_ends_the_run(self):
        with self.assertRaises(KeyError):
            list(mutate.judged("ax", [FakeTrial()], 2))

    def test_the_copy_becomes_what_the_repository_is(self):
        with tempfile.TemporaryDirectory() as directory:
            repository, tree = pathlib.Path(directory, "a"), pathlib.Path(directory, "b")
            for folder in mutate.COPIED:
                (repository / folder).mkdir(parents=True)
            for file in mutate.FILES:
                (repository / file).write_text("1", encoding="utf-8")
            same, changed = repository / "src/same.cpp", repository / "src/deep/changed.cpp"
            changed.parent.mkdir()
            same.write_text("1", encoding="utf-8")
            changed.write_text("2", encoding="utf-8")
            mutate.synchronise(repository, tree)
            built = (tree / "src/same.cpp").stat().st_mtime_ns
            (tree / "src/deep/changed.cpp").write_text("broken", encoding="utf-8")
            (tree / "src/gone.cpp").write_text("3", encoding="utf-8")
            mutate.synchronise(repository, tree)
            self.assertEqual((tree / "src/same.cpp").stat().st_mtime_ns, built, "is not built anew")
            self.assertEqual((tree / "src/deep/changed.cpp").read_text(encoding="utf-8"), "2")
            self.assertEqual(sorted(str(path) for path in mutate.files_in(tree / "src")),
                             ["deep/changed.cpp", "same.cpp"])


if __name__ == "__main__":
    unittest.main()
