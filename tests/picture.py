"""picture.py FILE.png WIDTH HEIGHT [COLOR:LEAST ...]: fails unless the picture has that size, is not blank, and has at least
LEAST pixels of each COLOR (rrggbb). With colors, which plots have, the outermost pixels must all be alike: no text is cut off."""

import struct
import sys
import zlib
from collections import Counter


def paeth(left, up, corner):
    distances = abs(up - corner), abs(left - corner), abs(left + up - 2 * corner)
    return (left, up, corner)[distances.index(min(distances))]


def rows_of(data, width, samples):
    """The rows of an 8-bit PNG without interlacing, their filters undone."""
    packed, at = b"", 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if data[at + 4 : at + 8] == b"IDAT":
            packed += data[at + 8 : at + 8 + length]
        at += length + 12
    raw, size = zlib.decompress(packed), width * samples
    above = bytes(size)
    for start in range(0, len(raw), size + 1):
        kind, row = raw[start], bytearray(raw[start + 1 : start + 1 + size])
        for i in range(size if kind else 0):
            left, up = (row[i - samples] if i >= samples else 0), above[i]
            corner = above[i - samples] if i >= samples else 0
            row[i] = (row[i] + (0, left, up, (left + up) // 2, kind == 4 and paeth(left, up, corner))[kind]) & 255
        yield bytes(row)
        above = row


path, width, height, *wanted = sys.argv[1:]
data = open(path, "rb").read()
size, (depth, color, _, _, interlaced) = struct.unpack(">II", data[16:24]), data[24:29]
if size != (int(width), int(height)):
    sys.exit(f"{path} is {size[0]} x {size[1]}, not {width} x {height}")
if depth != 8 or interlaced or color not in (0, 2):
    sys.exit(f"{path} is no plain PNG of gray or RGB bytes")
samples = 3 if color == 2 else 1
pixels = [[row[i : i + samples] for i in range(0, len(row), samples)] for row in rows_of(data, size[0], samples)]
counts = Counter(pixel for row in pixels for pixel in row)
if counts.most_common(1)[0][1] > 0.99 * size[0] * size[1]:
    sys.exit(f"{path} is blank")
for entry in wanted:
    name, least = entry.split(":")
    if counts[bytes.fromhex(name)] < int(least):
        sys.exit(f"{path} has {counts[bytes.fromhex(name)]} pixels of {name}, not {least}")
if wanted and len({*pixels[0], *pixels[-1], *(row[0] for row in pixels), *(row[-1] for row in pixels)}) > 1:
    sys.exit(f"{path} goes on beyond its border")
