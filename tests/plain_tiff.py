"""Fails unless the TIFF is uncompressed: tag 259 is 1."""

import struct
import sys

data = open(sys.argv[1], "rb").read()
order = "<" if data[:2] == b"II" else ">"
(start,) = struct.unpack(order + "I", data[4:8])
(count,) = struct.unpack(order + "H", data[start : start + 2])
entries = [struct.unpack(order + "HHIHH", data[at : at + 12]) for at in range(start + 2, start + 2 + 12 * count, 12)]
sys.exit([value for tag, _, _, value, _ in entries if tag == 259] != [1])
