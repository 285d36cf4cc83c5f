"""docs/reference equals the output of `coopdyn describe`; `python3 reference_test.py --write` updates it. docs/protocol.md names
every key of get_status.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from guide_test import Reader

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "reference"
BINARY = os.path.abspath(os.environ["COOPDYN_BINARY"])


def describe(*words):
    env = {name: value for name, value in os.environ.items() if name != "COOPDYN_PATH"}
    return subprocess.run([BINARY, "describe", *words], cwd="/", env=env, stdout=subprocess.PIPE, check=True, timeout=100,
                          text=True).stdout


def pages():
    """The text of each page, by its file."""
    index = describe()
    texts = {FOLDER / "README.md": index}
    for file, kind, name in re.findall(r"\((([a-z]+)s/([^/)]+)\.md)\)", index):
        texts[FOLDER / file] = describe(kind, name)
    return texts


def keys(value):
    """All keys of a JSON value, including nested objects."""
    if isinstance(value, dict):
        return set(value) | keys(list(value.values()))
    return set().union(*map(keys, value)) if isinstance(value, list) else set()


class ReferenceTest(unittest.TestCase):
    def test_the_pages_are_what_describe_prints(self):
        expected = pages()
        self.assertGreater(len(expected), 25)
        for file, text in expected.items():
            self.assertEqual(file.read_text(), text, f"{file}: run python3 tests/guide/reference_test.py --write")
        self.assertEqual(set(FOLDER.rglob("*.md")), set(expected))

    def test_links_lead_somewhere(self):
        for file in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md"), *(ROOT / "robots").rglob("*.md")]:
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", re.sub(r"```.*?```", "", file.read_text(), flags=re.S)):
                self.assertTrue((file.parent / link).exists(), f"{file}: {link}")

    def test_names_that_do_not_exist_are_refused(self):
        for words, code in ((["module", "moters"], 1), (["robot", "r2d2"], 1), (["scenario", "nowhere"], 1), (["robot"], 2),
                            (["planet", "earth"], 2)):
            done = subprocess.run([BINARY, "describe", *words], cwd="/", capture_output=True, text=True, timeout=100)
            self.assertEqual((done.returncode, done.stdout), (code, ""), words)
            self.assertTrue(done.stderr, words)

    def test_protocol_md_names_every_key_of_get_status(self):
        section = (ROOT / "docs" / "protocol.md").read_text().split("<!-- status -->")[1].split("\n### ")[0]
        named = set(re.findall(r"`([a-z_]+)`", section))
        told = set()
        with tempfile.TemporaryDirectory() as folder:
            reader = Reader(Path(folder))
            self.addCleanup(reader.close)
            for command in ("coopdyn serve classroom --mode lockstep --record a.run", "coopdyn play a.run"):
                reader.serve(command)
                program = "import coopdyn, json; sim = coopdyn.connect(watch=True); print(json.dumps(sim.status()))"
                told |= keys(json.loads(reader.run([sys.executable, "-c", program])))
                reader.close()
        self.assertLessEqual({"still_moving", "cure", "peer", "begin_step", "level"}, told)
        self.assertEqual(told - named, set())


if __name__ == "__main__":
    if "--write" in sys.argv:
        for page, content in pages().items():
            page.parent.mkdir(parents=True, exist_ok=True)
            page.write_text(content)
    else:
        unittest.main()
