#!/usr/bin/python3
# Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
"""scripts/lib/check_families.py finds the names of drive families in C++, and no C++ here has any."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
CHECK = REPOSITORY / "scripts/lib/check_families.py"


def check(repository):
    """@return what is said of a repository."""
    ended = subprocess.run([sys.executable, CHECK, repository], stdout=subprocess.PIPE, text=True,
                           timeout=60, check=False)
    assert ended.returncode == (1 if ended.stdout else 0), ended
    return ended.stdout


class CheckFamilies(unittest.TestCase):
    def said_of(self, path, text, profiles=("acme_x1", "generic_cia402")):
        with tempfile.TemporaryDirectory() as repository:
            files = {f"config/drives/{name}.yaml": f"name: {name}\n" for name in profiles}
            for place, content in {**files, path: text}.items():
                file = pathlib.Path(repository, place)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(content, encoding="utf-8")
            return check(repository)

    def test_the_program_names_none(self):
        self.assertEqual(check(REPOSITORY), "")

    def test_a_name_in_code_or_text_is_told_with_its_place(self):
        for line in ('if (profile.name == "acme_x1") return;', "bool isAcme();", "ACME_X1"):
            said = self.said_of("src/drive/a.cpp", f"// first line\n{line}\n")
            self.assertRegex(said, r"^src/drive/a\.cpp:2: names a drive family: (?i:acme)")

    def test_comments_and_the_generic_profile_are_left_alone(self):
        text = '// as Acme has it\n/* acme_x1\n acme */ const char* a = "e.g. generic_cia402";\n'
        self.assertEqual(self.said_of("include/a.h", text), "")

    def test_the_campaign_writes_robots_of_given_profiles(self):
        self.assertEqual(self.said_of("src/campaign/plan.cpp", '"acme_x1"'), "")

    def test_a_repository_without_profiles_proves_nothing(self):
        self.assertIn("no profiles", self.said_of("src/a.cpp", "", profiles=()))


if __name__ == "__main__":
    unittest.main()
