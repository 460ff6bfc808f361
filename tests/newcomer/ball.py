"""A picture whose normals are known, for programs that a newcomer writes.

ball.py make FOLDER: ball.png, and ball.rgb with the same 640 x 480 pixels of three bytes.
ball.py check NORMALS.f32: the float32 x, y, z of each pixel must be those of the ball.
"""

import math
import struct
import sys
import zlib

WIDTH, HEIGHT, RADIUS = 640, 480, 320
LIGHTS = ((110, 15, 95), (-65, 90, 100), (-40, -95, 90))


def normal(x, y):
    n = ((x - WIDTH / 2 + 0.5) / RADIUS, (HEIGHT / 2 - y - 0.5) / RADIUS)
    square = n[0] ** 2 + n[1] ** 2
    return (*n, math.sqrt(1 - square)) if square < 1 else (0, 0, 0)


def dot(a, b):
    return sum(u * v for u, v in zip(a, b))


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def make(folder):
    rows = []
    for y in range(HEIGHT):
        normals = (normal(x, y) for x in range(WIDTH))
        rows.append(bytes(round(max(0, dot(light, n))) for n in normals for light in LIGHTS))
    with open(folder + "/ball.rgb", "wb") as file:
        file.write(b"".join(rows))
    with open(folder + "/ball.png", "wb") as file:
        pixels = zlib.compress(b"".join(b"\0" + row for row in rows), 1)
        header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", pixels) + chunk(b"IEND", b""))


def check(path):
    with open(path, "rb") as file:
        values = struct.unpack(f"<{3 * WIDTH * HEIGHT}f", file.read())
    angles = []
    for i in range(0, len(values), 3):
        found, true = values[i : i + 3], normal(i // 3 % WIDTH, i // 3 // WIDTH)
        if any(found):
            angles.append(math.degrees(math.acos(min(1, dot(found, true)))))
    mean = sum(angles) / max(1, len(angles))
    print(f"{path}: {len(angles)} normals, {mean:.2f} degrees off on average")
    if len(angles) < 150_000 or mean > 1:
        sys.exit(f"{path}: these are not the normals of the ball")


{"make": make, "check": check}[sys.argv[1]](sys.argv[2])
