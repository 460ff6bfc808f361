"""gel_png.py FILE.png HEIGHT [X Y]: a ball of radius 40 pixels pressed HEIGHT pixels out of a gel, under lights that fall off; flat with HEIGHT 0.
X Y is its center in pixels."""

import math
import random
import struct
import sys
import zlib

WIDTH, DEPTH, RADIUS, SKIRT = 240, 180, 40.0, 12.0
LIGHTS = ((110, 20, 140), (-80, 100, 130), (-40, -110, 120))
HEIGHT = float(sys.argv[2])
X, Y = map(float, sys.argv[3:5]) if len(sys.argv) > 3 else (130.5, 80.5)

# The gel comes up in a parabola over the skirt, from zero to the slope of the ball at its contact.
edge = math.sqrt(max(0.0, RADIUS**2 - (RADIUS - HEIGHT * 0.75) ** 2))
steepest = edge / math.sqrt(RADIUS**2 - edge**2)


def slope(d):
    if d < edge:
        return d / math.sqrt(RADIUS**2 - d * d)
    return steepest * max(0.0, 1 - (d - edge) / SKIRT)


def color(x, y):
    u, v = x - X, Y - y
    d = math.hypot(u, v)
    p, q = (-slope(d) * u / d, -slope(d) * v / d) if d > 0 else (0.0, 0.0)
    length = math.sqrt(1 + p * p + q * q)
    gains = (1 + 0.2 * (x / WIDTH - 0.5), 1 - 0.25 * (y / DEPTH - 0.5), 1 - 0.2 * (x / WIDTH - 0.5))
    lit = (gain * (z - a * p - b * q) / length for gain, (a, b, z) in zip(gains, LIGHTS))
    return (min(255, max(0, round(value + random.gauss(0, 0.7)))) for value in lit)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


random.seed(1)
rows = b"".join(b"\0" + bytes(c for x in range(WIDTH) for c in color(x, y)) for y in range(DEPTH))
with open(sys.argv[1], "wb") as file:
    header = struct.pack(">IIBBBBB", WIDTH, DEPTH, 8, 2, 0, 0, 0)
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
# How high the ball stands above the plane.
print(HEIGHT * 0.75 + steepest * SKIRT / 2)
