# SPDX-License-Identifier: MIT
"""Submissions of students: folders, .zip, .tar and .tar.gz, as named by Moodle and Gradescope. Copies each into its own folder, and
refuses links and paths that lead out of it."""
import gzip
import hashlib
import os
import re
import shutil
import stat
import sys
import tarfile
import zipfile
import zlib
from dataclasses import dataclass

from plan import Wrong

kMostBytes = 256 << 20
kMostFiles = 10_000
kArchives = (".zip", ".tar", ".tar.gz", ".tgz")
kNotTheirs = ("__MACOSX", ".DS_Store", "Thumbs.db", ".git", "__pycache__")
kChunk = 1 << 20


class Refused(Exception):
    """A submission is refused; the text is a sentence for the student."""


@dataclass
class Candidate:
    """What may become a Submission: its path, and whose it is."""
    source: str
    name: str
    id: str
    file: str = ""  # for a single file: its name in the submission
    result: str = ""  # where the student's page looks for the result


class Submission:
    """`name`: of the student, and of the folder in OUT; `id`: of the school's system, or empty; `source`: the path of the submission. `file` and
    `result`: see Candidate."""

    def __init__(self, name, identity, source, file="", result=""):
        self.name, self.id, self.source, self.file, self.result = name, identity, source, file, result
        self.files = {}  # name: (executable, digest), once copied
        self.refused = None  # a sentence if the submission is refused
        self.folder = None

    @property
    def digest(self):
        text = "".join(f"{name}\0{executable:d}{content}\n" for name, (executable, content) in sorted(self.files.items()))
        return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:16]


def is_archive(path):
    return path.lower().endswith(kArchives)


def without_ending(name):
    for ending in sorted(kArchives, key=len, reverse=True):
        if name.lower().endswith(ending):
            return name[:-len(ending)]
    return name


def safe(name):
    """`name` as a safe name of a folder."""
    kept = re.sub(r"[^\w .@+-]", "_", name).strip(" .").lstrip("+-@")[:100]
    return kept if kept and kept != "hidden" else f"_{kept}"


def name_and_id(entry):
    """Name and id from a file's or folder's name: Moodle's Name_12345_assignsubmission_file_main.zip, Gradescope's submission_12345, or
    any other."""
    moodle = re.match(r"(.+?)_(\d+)_assignsubmission_\w*?file", entry)
    if moodle:
        return moodle[1], moodle[2]
    gradescope = re.fullmatch(r"submission_(\d+)", without_ending(entry))
    return without_ending(entry), gradescope[1] if gradescope else ""


def gradescope_names(folder):
    """{folder: (name, id)} from an export's submission_metadata.yml. Parses only these lines of it."""
    try:
        with open(os.path.join(folder, "submission_metadata.yml"), encoding="utf-8", errors="replace") as stream:
            text = stream.read(16 << 20)
    except OSError:
        return {}
    found = {}
    for block in re.split(r"(?m)^(?=\S)", text):
        head = re.match(r"[\"']?(submission_\d+)[\"']?:", block)
        people = [name.strip(" \"'") for name in re.findall(r"(?m)^[\s-]*:name:\s*(.+?)\s*$", block)]
        sid = re.search(r"(?m)^[\s-]*:sid:\s*[\"']?([\w.-]+)", block)
        if head and people:
            found[head[1]] = (" and ".join(people), sid[1] if sid else head[1].removeprefix("submission_"))
    return found


def candidates(sources, folders):
    """What is at the paths `sources`, and the entries of `folders`. Prints which entries are none."""
    entries = []
    for source in sources:
        if not os.path.lexists(source):
            raise Wrong(f"there is no submission {source}: name a folder, a .zip or a .tar, or --submissions FOLDER")
        beside, entry = os.path.split(os.path.abspath(source))
        entries.append(Candidate(source, *(gradescope_names(beside).get(without_ending(entry)) or name_and_id(entry))))
    for folder in folders:
        try:
            listed = sorted(os.listdir(folder))
        except OSError as error:
            raise Wrong(f"--submissions {folder} cannot be read: {error.strerror}") from None
        known, passed = gradescope_names(folder), []
        for entry in listed:
            path = os.path.join(folder, entry)
            if entry.startswith(".") or entry in (*kNotTheirs, "submission_metadata.yml"):
                continue
            if os.path.isdir(path) or is_archive(entry):
                entries.append(Candidate(path, *(known.get(without_ending(entry)) or name_and_id(entry))))
            else:
                passed.append(printable(entry))
        if passed:
            print(f"{folder}: passed over {', '.join(passed)}: a submission is a folder, a .zip, a .tar or a .tar.gz. Put a single file into a folder, "
                  "if it is one", file=sys.stderr, flush=True)
    return entries


def named(entries, known):
    """Submissions with names of their own. `known`: {name: id} of those in OUT, so that a student's later submission takes the place of the earlier
    one, and nobody else's."""
    found, taken, ids = [], set(), {name.lower(): identity for name, identity in known.items()}

    def is_free(name, identity):
        before = ids.get(name.lower())
        return name.lower() not in taken and (not before or not identity or before == identity)

    for entry in entries:
        own, number = safe(entry.name), 2
        before = [name for name, identity in known.items() if identity and identity == entry.id and name.lower() not in taken]
        if before and own not in before:
            own = before[0]
        while not is_free(own, entry.id):
            own, number = f"{safe(entry.name)} {number}", number + 1
        taken.add(own.lower())
        found.append(Submission(own, entry.id, entry.source, entry.file, entry.result))
    if not found:
        raise Wrong("there is nothing to grade: name a folder, a .zip or a .tar, --submissions FOLDER with some in it, or --class FOLDER in which somebody has "
                    "handed in")
    return found


def find(sources, folders):
    """The submissions at the paths `sources`, and the entries of `folders`."""
    return named(candidates(sources, folders), {})


class Store:
    """The destination of a submission's copy; counts its files and bytes."""

    def __init__(self, folder):
        self.folder, self.bytes, self.files = folder, 0, {}

    def add(self, name, executable, chunks):
        parts = self.parts_of(name)
        if any(part in kNotTheirs for part in parts):
            return
        if len(self.files) >= kMostFiles:
            raise Refused(f"It has more than {kMostFiles:,} files.")
        name = "/".join(parts)
        if name in self.files:
            raise Refused(f"It has {name} twice.")
        path = os.path.join(self.folder, *parts)
        content = hashlib.sha256()
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "xb") as stream:
                for chunk in chunks:
                    self.bytes += len(chunk)
                    if self.bytes > kMostBytes:
                        raise Refused(f"It has more than {kMostBytes >> 20} MiB.")
                    content.update(chunk)
                    stream.write(chunk)
        except (NotADirectoryError, FileExistsError, IsADirectoryError):
            raise Refused(f"It has a file and a folder of the same name: {name}.") from None
        os.chmod(path, 0o755 if executable else 0o644)
        self.files[name] = (executable, content.hexdigest())

    @staticmethod
    def parts_of(name):
        if "\0" in name or name.startswith(("/", "\\")) or re.match(r"[A-Za-z]:[\\/]", name):
            raise Refused(f"It has a file with an absolute path, {name!r}: write archives with paths from the submission's folder.")
        parts = [part for part in re.split(r"[/\\]", name) if part not in ("", ".")]
        if ".." in parts:
            raise Refused(f"It has a file outside its folder, {name!r}.")
        if not parts or len(parts) > 32 or any(len(part.encode("utf-8", "surrogateescape")) > 255 for part in parts):
            raise Refused(f"It has a file whose name cannot be used, {name[:80]!r}.")
        return parts


def chunks_of(stream):
    while chunk := stream.read(kChunk):
        yield chunk


def copy_folder(source, store):
    for root, folders, files in os.walk(source, onerror=lambda error: (_ for _ in ()).throw(error)):
        folders[:] = sorted(folder for folder in folders if folder not in kNotTheirs)
        for entry in [*folders, *sorted(files)]:
            path = os.path.join(root, entry)
            mode = os.lstat(path).st_mode
            name = os.path.relpath(path, source)
            if stat.S_ISLNK(mode):
                raise Refused(f"It has a link, {name}: put the file itself there.")
            if stat.S_ISDIR(mode):
                continue
            if not stat.S_ISREG(mode):
                raise Refused(f"It has {name}, which is no file.")
            with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW), "rb") as stream:
                store.add(name, bool(mode & 0o100), chunks_of(stream))


def copy_zip(source, store):
    with zipfile.ZipFile(source) as archive:
        for item in archive.infolist():
            mode = item.external_attr >> 16
            if stat.S_ISLNK(mode):
                raise Refused(f"It has a link, {item.filename}: put the file itself there.")
            if stat.S_IFMT(mode) not in (0, stat.S_IFREG, stat.S_IFDIR):
                raise Refused(f"It has {item.filename}, which is no file.")
            if item.flag_bits & 1:
                raise Refused("It has a password.")
            if item.is_dir():
                Store.parts_of(item.filename)
                continue
            with archive.open(item) as stream:
                store.add(item.filename, bool(mode & 0o100), chunks_of(stream))


class Limited:
    """Limits the bytes read from a tar, because its headers may be large, too."""

    def __init__(self, stream):
        self.stream, self.left = stream, 2 * kMostBytes

    def read(self, count):
        read = self.stream.read(count)
        self.left -= len(read)
        if self.left < 0:
            raise Refused(f"It has more than {kMostBytes >> 20} MiB.")
        return read


def opened_tar(source):
    with open(source, "rb") as stream:
        return gzip.open(source) if stream.read(2) == b"\x1f\x8b" else open(source, "rb")


def copy_tar(source, store):
    with opened_tar(source) as stream, tarfile.open(fileobj=Limited(stream), mode="r|") as archive:
        for count, item in enumerate(archive):
            if count > 2 * kMostFiles:
                raise Refused(f"It has more than {kMostFiles:,} files.")
            if item.issym() or item.islnk():
                raise Refused(f"It has a link, {item.name}: put the file itself there.")
            if item.isdir():
                continue
            if not item.isreg():
                raise Refused(f"It has {item.name}, which is no file.")
            store.add(item.name, bool(item.mode & 0o100), chunks_of(archive.extractfile(item)))


def copy_file(source, store, name):
    try:
        with open(os.open(source, os.O_RDONLY | os.O_NOFOLLOW), "rb") as stream:
            store.add(name, False, chunks_of(stream))
    except FileNotFoundError:
        raise Refused("There is no program in what was handed in: write one in the tab Program of the page, and hand in again.") from None


def copy(source, store):
    if os.path.islink(source):
        raise Refused("It is a link: name what it leads to.")
    if os.path.isdir(source):
        return copy_folder(source, store)
    if source.lower().endswith(".zip"):
        return copy_zip(source, store)
    if is_archive(source):
        return copy_tar(source, store)
    raise Refused("It is neither a folder nor a .zip or .tar archive.")


def printable(text):
    return "".join(c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in text)


def only_entry(folder):
    entries = [entry for entry in os.listdir(folder) if entry not in kNotTheirs]
    return entries[0] if len(entries) == 1 else None


def take(submission, folder, needed):
    """Copies a submission to `folder`. Bad content raises nothing: `refused` says what is wrong. Unpacks an archive that is alone in a
    folder, and descends into a folder that is alone, unless `needed` files are beside it."""
    os.mkdir(folder)
    try:
        source = submission.source
        if os.path.isdir(source) and not os.path.islink(source):
            entry = only_entry(source)
            if entry and is_archive(entry) and entry not in needed:
                source = os.path.join(source, entry)
        store = Store(folder)
        if submission.file:
            copy_file(source, store, submission.file)
        else:
            copy(source, store)
        files = store.files
        while (inner := only_entry(folder)) and os.path.isdir(os.path.join(folder, inner)) and not any(name in files for name in needed):
            folder = os.path.join(folder, inner)
            files = {name.partition("/")[2]: value for name, value in files.items()}
        submission.files, submission.folder = files, folder
        missing = [name for name in needed if name not in files]
        if missing:
            raise Refused(f"{', '.join(missing)} is missing." if len(missing) == 1 else f"{', '.join(missing)} are missing.")
    except Refused as refused:
        submission.refused = printable(str(refused))
    except (zipfile.BadZipFile, tarfile.TarError, zlib.error, EOFError, NotImplementedError, ValueError, RuntimeError) as error:
        submission.refused = printable(f"The archive cannot be read: {error}.")
    except OSError as error:
        submission.refused = f"It cannot be read: {error.strerror or error}."


def open_to_all(folder):
    """Makes `folder` readable for the sandbox's user, whatever the grader's umask; the enclosing folder keeps other users out."""
    for root, _, files in os.walk(folder):
        os.chmod(root, 0o755)
        for name in files:
            path = os.path.join(root, name)
            os.chmod(path, 0o755 if os.stat(path).st_mode & 0o100 else 0o644)


def keep(submission, path):
    """Writes a copy for appeals; the same files yield the same bytes."""
    part = path + ".part"
    with open(part, "wb") as stream, tarfile.open(fileobj=stream, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for name, (executable, _) in sorted(submission.files.items()):
            item = archive.gettarinfo(os.path.join(submission.folder, name), arcname=name)
            item.mode, item.mtime, item.uid, item.gid, item.uname, item.gname = 0o755 if executable else 0o644, 0, 0, 0, "", ""
            with open(os.path.join(submission.folder, name), "rb") as content:
                archive.addfile(item, content)
    os.replace(part, path)


def remove(folder):
    shutil.rmtree(folder, ignore_errors=True)
