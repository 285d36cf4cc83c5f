# SPDX-License-Identifier: MIT
"""The tests that docs/yars.md names for the claims of the YARS paper exist; a figure is the same wherever it appears."""
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).parents[2]


class ClaimsTest(unittest.TestCase):
    def test_each_claim_names_tests_that_are_there(self):
        section = (ROOT / "docs/yars.md").read_text().split("## The claims of the YARS paper")[1]
        claims = re.findall(r"^\| (\d+) \|(.*)\|$", section, re.M)
        self.assertEqual([int(number) for number, _ in claims], list(range(1, 54)))
        sources = "".join(path.read_text() for pattern in ("*_test.cc", "*_test.py")
                          for path in (ROOT / "tests").rglob(pattern))
        for number, cells in claims:
            names = re.findall(r"`(\w+)`", cells.split("|")[-1])
            self.assertTrue(names, f"claim {number} names no test")
            for name in names:
                found = re.search(rf"\b(def {name}\(|TEST(_F|_P)?\(\w+, {name}\))", sources)
                self.assertTrue(found, f"claim {number}: there is no test {name}")

    def test_what_a_step_of_a_robot_takes_is_as_in_the_benchmarks(self):
        rows = re.findall(r"^\| (humanoid|hexapod|lwa) \|[^|]*\|[^|]*\| ([\d.]+) \|", (ROOT / "docs/benchmarks.md").read_text(), re.M)
        measured = {robot: f"{float(us):.0f}" for robot, us in rows}
        told = re.search(r"a humanoid's step took \d+ µs, now (\d+); a hexapod's \d+, now (\d+); an arm's \d+, now (\d+)",
                         (ROOT / "docs/decisions.md").read_text())
        self.assertEqual(told.groups(), (measured["humanoid"], measured["hexapod"], measured["lwa"]))


if __name__ == "__main__":
    unittest.main()
