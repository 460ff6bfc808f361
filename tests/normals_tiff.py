"""Reads the normals that ofc_photo writes.

normals_tiff.py plain NORMALS.tiff             fails unless the file is uncompressed
normals_tiff.py light NORMALS.tiff FOLDER      r.tiff, g.tiff and b.tiff, each n . f for a light f of its own; that of blue is
                                               105 degrees from the camera, behind the surface, so that most values are negative
"""

import math
import struct
import sys

LIGHTS = {"r": (40, 20), "g": (40, 140), "b": (105, -100)}  # slant and tilt in degrees
WIDTH, HEIGHT, BITS, COMPRESSION, PHOTOMETRIC, STRIPS, SAMPLES, ROWS, BYTES, FORMAT = 256, 257, 258, 259, 262, 273, 277, 278, 279, 339


def entries_of(data):
    """Every tag with its values, short or long."""
    order = "<" if data[:2] == b"II" else ">"
    (start,) = struct.unpack(order + "I", data[4:8])
    (count,) = struct.unpack(order + "H", data[start : start + 2])
    entries = {}
    for at in range(start + 2, start + 2 + 12 * count, 12):
        tag, kind, number = struct.unpack(order + "HHI", data[at : at + 8])
        if kind in (3, 4):
            size = 2 * number if kind == 3 else 4 * number
            (there,) = struct.unpack(order + "I", data[at + 8 : at + 12]) if size > 4 else (at + 8,)
            entries[tag] = struct.unpack(order + str(number) + "_HI"[kind - 2], data[there : there + size])
    return order, entries


def write_plane(path, width, values):
    """A TIFF of one 32-bit float a pixel, in one strip behind its header."""
    tags = {WIDTH: width, HEIGHT: len(values) // width, BITS: 32, COMPRESSION: 1, PHOTOMETRIC: 1, STRIPS: 0, SAMPLES: 1}
    tags |= {ROWS: len(values) // width, BYTES: 4 * len(values), FORMAT: 3}
    tags[STRIPS] = 8 + 2 + 12 * len(tags) + 4
    header = struct.pack("<2sHIH", b"II", 42, 8, len(tags))
    header += b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags.items())
    with open(path, "wb") as file:
        file.write(header + struct.pack("<I", 0) + struct.pack(f"<{len(values)}f", *values))


data = open(sys.argv[2], "rb").read()
order, entries = entries_of(data)
if entries[COMPRESSION] != (1,):
    sys.exit(f"{sys.argv[2]} is compressed")
if sys.argv[1] == "light":
    raw = b"".join(data[at : at + size] for at, size in zip(entries[STRIPS], entries[BYTES]))
    normals = list(struct.iter_unpack(order + "3f", raw))
    for name, (slant, tilt) in LIGHTS.items():
        s, t = math.radians(slant), math.radians(tilt)
        f = [200 * a for a in (math.sin(s) * math.cos(t), math.sin(s) * math.sin(t), math.cos(s))]
        write_plane(f"{sys.argv[3]}/{name}.tiff", entries[WIDTH][0], [sum(a * b for a, b in zip(f, n)) for n in normals])
