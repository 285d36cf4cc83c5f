# SPDX-License-Identifier: MIT
"""Films of recordings: joins pictures of `coopdyn export` to an animated PNG, which every browser shows."""
import glob
import os
import struct
import subprocess
import tempfile
import zlib

kPictures = 48
kFps = 8
kSize = "320x240"
kSignature = b"\x89PNG\r\n\x1a\n"


def chunks_of(png):
    """[(type, data), …] of a PNG."""
    found, at = [], len(kSignature)
    while at + 12 <= len(png):
        size = struct.unpack(">I", png[at:at + 4])[0]
        found.append((png[at + 4:at + 8], png[at + 8:at + 8 + size]))
        at += 12 + size
    return found


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def animated(pictures, fps, last_s=2):
    """Joins PNGs of one size to an animated PNG (https://www.w3.org/TR/png-3), which loops; the last picture stays for last_s."""
    out, number = [kSignature], 0
    for index, picture in enumerate(map(chunks_of, pictures)):
        head = next(data for kind, data in picture if kind == b"IHDR")
        if index == 0:
            out += [chunk(b"IHDR", head), chunk(b"acTL", struct.pack(">II", len(pictures), 0))]
            out += [chunk(kind, data) for kind, data in picture if kind == b"PLTE"]
        delay = (last_s, 1) if index == len(pictures) - 1 else (1, fps)
        out.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, *struct.unpack(">II", head[:8]), 0, 0, *delay, 0, 0)))
        number += 1
        for kind, data in picture:
            if kind == b"IDAT" and index == 0:
                out.append(chunk(b"IDAT", data))
            elif kind == b"IDAT":
                out.append(chunk(b"fdAT", struct.pack(">I", number) + data))
                number += 1
    return b"".join(out + [chunk(b"IEND", b"")])


def of_run(program, recording, duration_s):
    """The film of a recording; None if no pictures can be made of it."""
    with tempfile.TemporaryDirectory(prefix="coopdyn-film-") as folder:
        speed = max(1.0, duration_s * kFps / kPictures)
        words = [program, "export", recording, "--to", "png", "--out", os.path.join(folder, "film"), "--fps", str(kFps), "--speed", f"{speed:g}",
                 "--size", kSize, "--force"]
        if subprocess.run(words, capture_output=True, check=False).returncode != 0:
            return None
        pictures = []
        for name in sorted(glob.glob(os.path.join(folder, "film*", "*.png"))):
            with open(name, "rb") as stream:
                pictures.append(stream.read())
        return animated(pictures, kFps) if pictures else None
