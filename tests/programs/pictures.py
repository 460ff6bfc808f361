"""Pictures as people bring them: an egg under three colored lights, and the files that cameras, scanners and other programs make of it."""

import io
import struct
import zlib

import numpy as np
from PIL import Image, ImageCms

WIDTH, HEIGHT = 200, 150
# Rows: the equivalent light of r, g, b in gray levels (x right, y up, z toward the camera).
LIGHTS = 170 * np.array([[0.66, 0.12, 0.76], [-0.42, 0.60, 0.70], [-0.30, -0.64, 0.72]])


def egg(width=WIDTH, height=HEIGHT):
    """Normals and mask of half an ellipsoid that ends within the picture."""
    y, x = np.mgrid[0:height, 0:width].astype(float)
    a, b, c = 0.42 * width, 0.42 * height, 0.21 * width
    u, v = (x - (width - 1) / 2) / a, ((height - 1) / 2 - y) / b
    square = u * u + v * v
    normals = np.dstack([u / a, v / b, np.sqrt(np.clip(1 - square, 1e-3, None)) / c])
    return normals / np.linalg.norm(normals, axis=2, keepdims=True), square < 0.96


def light_of(normals, mask, ambient=0.0, gain=1.0, noise=0.6, seed=1):
    """The light of every pixel in gray levels; outside the mask there is none."""
    light = gain * np.clip(normals @ LIGHTS.T, 0, None) + ambient
    light += np.random.default_rng(seed).normal(0, noise, light.shape)
    return np.where(mask[..., None], np.clip(light, 0, None), 0)


def bytes_of(light):
    return np.clip(np.rint(light), 0, 255).astype(np.uint8)


def srgb(light):
    share = np.clip(light / 255, 0, 1)
    return 255 * np.where(share <= 0.0031308, 12.92 * share, 1.055 * np.maximum(share, 1e-9) ** (1 / 2.4) - 0.055)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(path, pixels, extra=b""):
    """8 or 16 bits; gray, gray with alpha, color, or color with alpha. `extra`: chunks before the pixels."""
    pixels = pixels if pixels.ndim == 3 else pixels[..., None]
    height, width, channels = pixels.shape
    rows = b"".join(b"\0" + row.astype(pixels.dtype.newbyteorder(">")).tobytes() for row in pixels)
    kind = {1: 0, 2: 4, 3: 2, 4: 6}[channels]
    header = struct.pack(">IIBBBBB", width, height, 8 * pixels.itemsize, kind, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + extra + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def profile(name="sRGB"):
    return ImageCms.ImageCmsProfile(ImageCms.createProfile(name)).tobytes()


def jpeg(path, pixels, orientation=None, **options):
    exif = Image.Exif()
    if orientation:
        exif[0x0112] = orientation
    Image.fromarray(pixels).save(path, "JPEG", quality=98, subsampling=0, exif=exif, **options)


def tiff_page(pixels, at, orientation=1):
    """A page that begins `at` bytes after the file does, and where the offset of the next page goes."""
    pixels = pixels if pixels.ndim == 3 else pixels[..., None]
    height, width, channels = pixels.shape
    data = pixels.astype(pixels.dtype.newbyteorder("<")).tobytes()
    kind = 3 if pixels.dtype.kind == "f" else 1
    tags = {256: width, 257: height, 258: None, 259: 1, 262: 2 if channels >= 3 else 1, 273: None, 274: orientation, 277: channels}
    tags |= {278: height, 279: len(data), 339: None}
    if channels == 4:
        tags[338] = 2
    directory = 2 + 12 * len(tags) + 4
    bits, kinds, start = at + directory, at + directory + 2 * channels, at + directory + 4 * channels
    entries = struct.pack("<H", len(tags))
    for tag, value in sorted(tags.items()):
        if tag in (258, 339):
            words = struct.pack(f"<{channels}H", *[8 * pixels.itemsize if tag == 258 else kind] * channels)
            where = words.ljust(4, b"\0") if channels <= 2 else struct.pack("<I", bits if tag == 258 else kinds)
            entries += struct.pack("<HHI", tag, 3, channels) + where
        else:
            entries += struct.pack("<HHII", tag, 4, 1, start if tag == 273 else value)
    rest = struct.pack(f"<{channels}H", *[8 * pixels.itemsize] * channels) + struct.pack(f"<{channels}H", *[kind] * channels) + data
    return entries, rest


def tiff(path, *pages, orientation=1):
    content = b"II*\0" + struct.pack("<I", 8)
    for i, pixels in enumerate(pages):
        entries, rest = tiff_page(pixels, len(content), orientation)
        end = len(content) + len(entries) + 4 + len(rest)
        content += entries + struct.pack("<I", end if i + 1 < len(pages) else 0) + rest
    with open(path, "wb") as file:
        file.write(content)


def map_of(normals, mask, dtype, outside=0, y_sign=1, z_sign=1):
    """A normal map of 8 or 16 bits."""
    full = np.iinfo(dtype).max
    return np.where(mask[..., None], np.rint((normals * [1, y_sign, z_sign] + 1) / 2 * full), outside).astype(dtype)


def floats_of(path):
    """The pixels of a TIFF of 32-bit floats without compression."""
    with open(path, "rb") as file:
        data = file.read()
    (start,) = struct.unpack("<I", data[4:8])
    (count,) = struct.unpack("<H", data[start : start + 2])
    tags = {}
    for at in range(start + 2, start + 2 + 12 * count, 12):
        tag, kind, number = struct.unpack("<HHI", data[at : at + 8])
        size = {3: 2, 4: 4}.get(kind, 0) * number
        where = at + 8 if size <= 4 else struct.unpack("<I", data[at + 8 : at + 12])[0]
        tags[tag] = struct.unpack(f"<{number}{'H' if kind == 3 else 'I'}", data[where : where + size]) if size else ()
    raw = b"".join(data[at : at + size] for at, size in zip(tags[273], tags[279]))
    return np.frombuffer(raw, "<f4").reshape(tags[257][0], tags[256][0], tags[277][0])


def shape_of_png(path):
    with open(path, "rb") as file:
        width, height = struct.unpack(">II", file.read(24)[16:24])
    return width, height
