# SPDX-License-Identifier: MIT
"""Submissions: names, folders, archives, and harmful ones."""
import gzip
import io
import os
import stat
import tarfile
import tempfile
import unittest
import zipfile

import grade_case  # noqa: F401  (finds the modules)
import submissions
from plan import Wrong


class SubmissionsTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def make(self, name, text="print(1)\n"):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as stream:
            stream.write(text)

    def zip(self, entries, name="a.zip"):
        with zipfile.ZipFile(self.path(name), "w", zipfile.ZIP_DEFLATED) as archive:
            for entry, content in entries.items():
                archive.writestr(entry, content)
        return self.path(name)

    def tar(self, items, name="a.tar"):
        with tarfile.open(self.path(name), "w:gz" if name.endswith("gz") else "w") as archive:
            for entry, kind, content in items:
                item = tarfile.TarInfo(entry)
                item.type = kind
                if kind == tarfile.REGTYPE:
                    item.size = len(content)
                    archive.addfile(item, io.BytesIO(content))
                else:
                    item.linkname = content
                    archive.addfile(item)
        return self.path(name)

    def take(self, source, needed=("main.py",)):
        [one] = submissions.find([source], [])
        submissions.take(one, self.path("taken"), list(needed))
        return one

    def refused(self, source, words):
        one = self.take(source)
        self.assertIsNotNone(one.refused)
        self.assertRegex(one.refused, words)
        submissions.remove(self.path("taken"))

    def names(self, *entries):
        for entry in entries:
            if entry.endswith(submissions.kArchives):
                self.make("handed/" + entry)
            else:
                self.make(f"handed/{entry}/main.py")
        return [(one.name, one.id) for one in submissions.find([], [self.path("handed")])]

    def test_a_folder_a_zip_and_a_tar_give_the_same(self):
        self.make("ana/main.py")
        self.make("ana/lib/help.py", "x = 1\n")
        files = {"main.py": "print(1)\n", "lib/help.py": "x = 1\n"}
        sources = [self.path("ana"), self.zip(files), self.zip({"work/" + name: text for name, text in files.items()}, "b.zip"),
                   self.tar([(name, tarfile.REGTYPE, text.encode()) for name, text in files.items()]),
                   self.tar([("./" + name, tarfile.REGTYPE, text.encode()) for name, text in files.items()], "a.tar.gz")]
        digests = set()
        for source in sources:
            one = self.take(source)
            self.assertIsNone(one.refused, source)
            digests.add(one.digest)
            with open(os.path.join(one.folder, "lib/help.py"), encoding="utf-8") as stream:
                self.assertEqual(stream.read(), "x = 1\n")
            submissions.remove(self.path("taken"))
        self.assertEqual(len(digests), 1)

    def test_an_archive_alone_in_a_folder_is_unpacked(self):
        os.mkdir(self.path("ana"))
        self.zip({"main.py": "print(1)\n"}, "ana/solution.zip")
        self.assertIsNone(self.take(self.path("ana")).refused)

    def test_a_missing_file_is_named(self):
        self.make("ana/other.py")
        self.refused(self.path("ana"), "^main.py is missing.$")

    def test_names_of_moodle(self):
        self.assertEqual(self.names("Ana Lovelace_12345_assignsubmission_file", "Bob_7_assignsubmission_file_main.zip"),
                         [("Ana Lovelace", "12345"), ("Bob", "7")])

    def test_names_of_gradescope(self):
        self.make("handed/submission_metadata.yml", "submission_11:\n  :submitters:\n  - :name: Ana Lovelace\n    :sid: 'a77'\n    :email: a@b.c\n  :created_at: 2026\n"
                  "submission_12:\n  :submitters:\n  - :name: Bob\n  - :name: Cem\n")
        self.assertEqual(self.names("submission_11", "submission_12", "submission_13"), [("Ana Lovelace", "a77"), ("Bob and Cem", "12"), ("submission_13", "13")])

    def test_equal_names_and_those_that_lead_elsewhere_get_folders_of_their_own(self):
        self.make("one/ana/main.py")
        self.make("two/Ana/main.py")
        self.make("two/hidden/main.py")
        self.assertEqual([one.name for one in submissions.find([], [self.path("one"), self.path("two")])], ["ana", "Ana 2", "_hidden"])
        for name in ("..", ".", "a/b", "a\nb", "   "):
            self.assertNotIn("/", submissions.safe(name))
            self.assertNotIn(submissions.safe(name), ("", ".", ".."))

    def test_nothing_to_grade_is_a_mistake(self):
        os.mkdir(self.path("handed"))
        for sources, folders in (([self.path("nobody")], []), ([], [self.path("handed")]), ([], [self.path("nowhere")])):
            with self.assertRaises(Wrong):
                submissions.find(sources, folders)

    def test_paths_that_lead_out_are_refused(self):
        for name in ("../evil.py", "lib/../../evil.py", "..\\evil.py"):
            self.refused(self.zip({"main.py": "", name: "x"}), "outside its folder")
            self.refused(self.tar([("main.py", tarfile.REGTYPE, b""), (name, tarfile.REGTYPE, b"x")]), "outside its folder")
        for name in ("/tmp/evil.py", "C:\\evil.py"):
            self.refused(self.zip({"main.py": "", name: "x"}), "absolute path")
        self.assertFalse(os.path.exists(self.path("evil.py")))

    def test_links_are_refused(self):
        self.make("ana/main.py")
        os.symlink("/etc/passwd", self.path("ana/data"))
        self.refused(self.path("ana"), "a link, data")
        for kind in (tarfile.SYMTYPE, tarfile.LNKTYPE):
            self.refused(self.tar([("main.py", tarfile.REGTYPE, b""), ("data", kind, "/etc/passwd")]), "a link, data")
        item = zipfile.ZipInfo("data")
        item.external_attr = (stat.S_IFLNK | 0o777) << 16
        self.refused(self.zip({item: "/etc/passwd"}), "a link, data")
        os.symlink(self.path("ana"), self.path("eva"))
        self.refused(self.path("eva"), "It is a link")

    def test_devices_and_pipes_are_refused(self):
        self.make("ana/main.py")
        os.mkfifo(self.path("ana/pipe"))
        self.refused(self.path("ana"), "pipe, which is no file")
        for kind in (tarfile.FIFOTYPE, tarfile.CHRTYPE, tarfile.BLKTYPE):
            self.refused(self.tar([("main.py", tarfile.REGTYPE, b""), ("thing", kind, "")]), "thing, which is no file")

    def test_bombs_are_refused_before_they_fill_the_disk(self):
        class Zeros(io.RawIOBase):
            left = 1 << 30

            def readable(self):
                return True

            def readinto(self, buffer):
                count = min(len(buffer), self.left)
                buffer[:count] = bytes(count)
                self.left -= count
                return count

        with zipfile.ZipFile(self.path("bomb.zip"), "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive, archive.open("main.py", "w", force_zip64=True) as stream:
            for _ in range(300):
                stream.write(bytes(1 << 20))
        item = tarfile.TarInfo("main.py")
        item.size = 300 << 20
        with gzip.open(self.path("bomb.tar.gz"), "wb", compresslevel=1) as stream, tarfile.open(fileobj=stream, mode="w|") as archive:
            archive.addfile(item, io.BufferedReader(Zeros()))
        for name in ("bomb.zip", "bomb.tar.gz"):
            one = self.take(self.path(name))
            self.assertEqual(one.refused, "It has more than 256 MiB.")
            taken = sum(os.path.getsize(os.path.join(root, file)) for root, _, files in os.walk(self.path("taken")) for file in files)
            self.assertLessEqual(taken, submissions.kMostBytes)
            submissions.remove(self.path("taken"))

    def test_a_tar_whose_header_is_a_bomb_is_refused(self):
        item = tarfile.TarInfo("x")
        item.type, item.size = tarfile.XHDTYPE, 2 << 30
        with gzip.open(self.path("bomb.tar.gz"), "wb", compresslevel=1) as stream:
            stream.write(item.tobuf())
            for _ in range(520):
                stream.write(bytes(1 << 20))
        self.refused(self.path("bomb.tar.gz"), "more than 256 MiB")

    def test_too_many_files_are_refused(self):
        self.refused(self.zip({f"{k}.py": "" for k in range(submissions.kMostFiles + 1)}), "more than 10,000 files")

    def test_what_is_broken_or_locked_is_refused_in_words(self):
        self.make("bad.zip", "PK no")
        self.make("bad.tar.gz", "no tar")
        self.refused(self.path("bad.zip"), "cannot be read")
        self.refused(self.path("bad.tar.gz"), "cannot be read|is missing")
        self.make("notes.txt")
        self.refused(self.path("notes.txt"), "neither a folder nor")

    def test_a_kept_copy_has_the_same_digest_and_bytes(self):
        self.make("ana/main.py")
        one = self.take(self.path("ana"))
        submissions.keep(one, self.path("one.tar"))
        os.utime(os.path.join(one.folder, "main.py"), (1, 1))
        submissions.keep(one, self.path("two.tar"))
        with open(self.path("one.tar"), "rb") as first, open(self.path("two.tar"), "rb") as second:
            self.assertEqual(first.read(), second.read())
        submissions.remove(self.path("taken"))
        self.assertEqual(self.take(self.path("one.tar")).digest, one.digest)


if __name__ == "__main__":
    unittest.main()
