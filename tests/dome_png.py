"""dome_png.py FILE.png HEIGHT: a range map of 16 bits, the cap of a ball in 200 steps a pixel; flat with HEIGHT 0."""

import struct
import sys
import zlib

SIZE, RADIUS, CAP, STEPS = 128, 70, 60, 200


def depth(x, y):
    squared = (x - SIZE // 2) ** 2 + (y - SIZE // 2) ** 2
    if squared > CAP**2:
        return 0
    return 1000 + round(float(sys.argv[2]) * STEPS * (RADIUS**2 - squared) ** 0.5)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


rows = b"".join(b"\0" + struct.pack(f">{SIZE}H", *(depth(x, y) for x in range(SIZE))) for y in range(SIZE))
with open(sys.argv[1], "wb") as file:
    header = struct.pack(">IIBBBBB", SIZE, SIZE, 16, 0, 0, 0, 0)
    file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
