"""ofc_photo and ofc_integrate with files as they are on people's disks."""

import csv
import json
import os
import pty
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np
import pictures as p
from PIL import Image

BIN = Path(__file__).resolve().parents[2] / "target/c_examples"
# Results that are quick to write.
QUICK = ["--outputs", "normals,inliers"]


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.normals, cls.mask = p.egg()
        cls.light = p.light_of(cls.normals, cls.mask)
        cls.truth = cls.folder / "truth.tiff"
        p.tiff(cls.truth, np.where(cls.mask[..., None], cls.normals, 0).astype(np.float32))

    def run_program(self, program, *arguments, status=0, **options):
        """Runs it in the folder of the case and returns what it said."""
        done = subprocess.run([BIN / program, *map(str, arguments)], cwd=self.folder, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
        self.assertEqual(done.returncode, status, done.stdout)
        # Long lines are wrapped.
        return done.stdout.replace("\n           ", " ")

    def photo(self, *arguments, status=0, quick=True):
        """What it said, and its report where there is one."""
        out = self.folder / "out"
        said = self.run_program("ofc_photo", *arguments, *(QUICK if quick else []), "--out", out, status=status)
        report = out / "report.json"
        return said, json.loads(report.read_text()) if report.exists() else None

    def integrate(self, *arguments, status=0):
        out = self.folder / "out"
        said = self.run_program("ofc_integrate", *arguments, "--out", out, status=status)
        report = out / "report.json"
        return said, json.loads(report.read_text()) if report.exists() else None

    def assertHonest(self, report):
        """What is said of the error is at least two thirds of it."""
        self.assertGreaterEqual(report["uncertainty"]["median_deg"], report["median_error_deg"] / 1.5)


class Radiometry(Case):
    def test_srgb_is_undone_where_it_is_told_and_doubted_where_not(self):
        p.png(self.folder / "linear.png", p.bytes_of(self.light))
        p.png(self.folder / "srgb.png", p.bytes_of(p.srgb(self.light)))
        p.png(self.folder / "said.png", p.bytes_of(p.srgb(self.light)), p.chunk(b"sRGB", b"\0"))
        _, linear = self.photo("linear.png", "--truth", self.truth)
        self.assertEqual(linear["confidence"]["doubts"], [])
        self.assertLess(linear["median_error_deg"], 0.8)
        said, undone = self.photo("srgb.png", "--transfer", "srgb", "--truth", self.truth)
        self.assertIn("sRGB undone", said)
        self.assertLess(abs(undone["median_error_deg"] - linear["median_error_deg"]), 0.3)
        said, doubted = self.photo("srgb.png", "--truth", self.truth)
        self.assertHonest(doubted)
        said, doubted = self.photo("said.png", "--truth", self.truth)
        self.assertIn("its chunk sRGB says that it holds sRGB, and it was taken for linear", said)
        self.assertEqual(doubted["input"]["transfer"]["file_says"], "sRGB")
        self.assertHonest(doubted)
        _, undone = self.photo("said.png", "--transfer", "file", "--truth", self.truth)
        self.assertLess(abs(undone["median_error_deg"] - linear["median_error_deg"]), 0.3)
        _, sure = self.photo("said.png", "--transfer", "linear", "--truth", self.truth)
        self.assertEqual(sure["confidence"]["doubts"], [])

    def test_what_a_file_says_is_found_wherever_it_says_so(self):
        stored = p.bytes_of(p.srgb(self.light))
        chunks = {"icc.png": p.chunk(b"iCCP", b"x\0\0" + p.zlib.compress(p.profile())), "gamma.png": p.chunk(b"gAMA", p.struct.pack(">I", 45455)),
                  "linear.png": p.chunk(b"gAMA", p.struct.pack(">I", 100000)), "silent.png": b""}
        for name, extra in chunks.items():
            p.png(self.folder / name, stored, extra)
        p.jpeg(self.folder / "icc.jpg", stored, icc_profile=p.profile())
        p.jpeg(self.folder / "plain.jpg", stored)
        expected = {"icc.png": ("sRGB", "its ICC profile"), "gamma.png": ("a curve", "its chunk gAMA"), "linear.png": ("linear", "its chunk gAMA"),
                    "silent.png": ("nothing", ""), "icc.jpg": ("sRGB", "its ICC profile"), "plain.jpg": ("sRGB", "its format")}
        for name, (says, source) in expected.items():
            _, report = self.photo(name)
            self.assertEqual(report["input"]["transfer"]["file_says"], says, name)
            self.assertIn(source, report["input"]["transfer"]["source"], name)
            self.assertIsNone(report["input"]["transfer"]["undone"])

    def test_a_gamma_and_words_that_are_none(self):
        p.png(self.folder / "gamma.png", p.bytes_of(255 * (self.light / 255) ** (1 / 1.8)))
        _, report = self.photo("gamma.png", "--transfer", "gamma:1.8", "--truth", self.truth)
        self.assertLess(report["median_error_deg"], 0.8)
        p.png(self.folder / "gamma16.png", np.rint(65535 * (self.light / 255) ** (1 / 1.8)).astype(np.uint16))
        _, report = self.photo("gamma16.png", "--transfer", "gamma:1.8", "--truth", self.truth)
        self.assertLess(report["median_error_deg"], 0.8)
        for word in "gamma", "gamma:", "gamma:0", "gamma:nan", "gamma:99", "gamma:2x", "rec709":
            self.photo("gamma.png", "--transfer", word, status=2)
        self.photo("gamma.png", "--transfer", "file", status=2)

    def test_room_light_is_found_and_doubted(self):
        for ambient in 20, 60:
            name = f"ambient{ambient}.png"
            p.png(self.folder / name, p.bytes_of(p.light_of(self.normals, self.mask, ambient=float(ambient), gain=0.9)))
            said, doubted = self.photo(name, "--truth", self.truth)
            self.assertIn("an offset of about", said)
            self.assertHonest(doubted)
            said, fitted = self.photo(name, "--ambient", "fit", "--truth", self.truth)
            self.assertLess(fitted["median_error_deg"], 0.8, said)
            found = fitted["input"]["ambient"]
            for offset, sigma in zip(found["offset"], found["sigma"]):
                self.assertLess(abs(offset - ambient), max(3, 3 * sigma), said)
        p.png(self.folder / "none.png", p.bytes_of(self.light))
        said, report = self.photo("none.png", "--truth", self.truth)
        self.assertNotIn("offset", said)
        self.photo("none.png", "--ambient", "fit", "--background", "none.png", status=2)

    def test_a_dark_frame_is_subtracted(self):
        room = np.linspace(20, 60, p.WIDTH)[None, :, None] * np.ones((p.HEIGHT, 1, 3))
        p.png(self.folder / "lit.png", p.bytes_of(self.light * 0.8 + room))
        p.png(self.folder / "dark.png", p.bytes_of(room))
        p.png(self.folder / "mask.png", self.mask.astype(np.uint8))
        said, report = self.photo("lit.png", "--dark", "dark.png", "--mask", "mask.png", "--truth", self.truth)
        self.assertIn("dark frame", said)
        self.assertLess(report["median_error_deg"], 0.8)
        p.png(self.folder / "small.png", p.bytes_of(room)[1:])
        self.assertIn("no dark frame", self.photo("lit.png", "--dark", "small.png", status=2)[0])

    def test_clipping_below_full_scale(self):
        bright = p.light_of(self.normals, self.mask, gain=1.8)
        clipped = np.clip(bright, 0, 255)
        count = int((clipped >= 255).any(axis=2).sum())
        p.png(self.folder / "twelve.png", np.rint(clipped / 255 * 4095).astype(np.uint16))
        p.png(self.folder / "video.png", np.rint(clipped / 255 * 235).astype(np.uint8))
        p.tiff(self.folder / "floats.tiff", (clipped / 255).astype(np.float32))
        for name, level in ("twelve.png", 4095), ("video.png", 235), ("floats.tiff", 1):
            said, report = self.photo(name, "--truth", self.truth, "--model", "ellipsoid")
            self.assertEqual(report["input"]["saturation"]["level"], level, name)
            self.assertAlmostEqual(report["pixels"]["saturated"], count, delta=0.05 * count)
            self.assertIn("pile up there", said)
        p.png(self.folder / "dim.png", np.rint(self.light / 255 * 4095).astype(np.uint16))
        self.assertIsNone(self.photo("dim.png")[1]["input"]["saturation"])


class Files(Case):
    def test_every_orientation_stands_upright(self):
        stored = p.bytes_of(self.light)
        as_meant = {1: stored, 2: stored[:, ::-1], 3: stored[::-1, ::-1], 4: stored[::-1], 5: stored.swapaxes(0, 1),
                    6: np.rot90(stored, -1), 7: np.rot90(stored, 2).swapaxes(0, 1), 8: np.rot90(stored)}
        for orientation, upright in as_meant.items():
            p.jpeg(self.folder / "turned.jpg", stored, orientation)
            p.png(self.folder / "mask.png", (upright.max(axis=2) > 0).astype(np.uint8))
            p.jpeg(self.folder / "upright.jpg", np.ascontiguousarray(upright))
            _, report = self.photo("turned.jpg", "--mask", "mask.png", "--model", "ellipsoid")
            self.assertEqual(report["input"]["orientation"], orientation)
            self.assertEqual(report["input"]["size"], [upright.shape[1], upright.shape[0]])
            turned = p.floats_of(self.folder / "out/normals.tiff")
            self.photo("upright.jpg", "--mask", "mask.png", "--model", "ellipsoid")
            expected = p.floats_of(self.folder / "out/normals.tiff")
            self.assertLess(np.quantile(np.abs(turned - expected), 0.9), 0.05, orientation)
        p.tiff(self.folder / "turned.tiff", stored, orientation=6)
        said, report = self.photo("turned.tiff")
        self.assertEqual(report["input"]["size"], [p.HEIGHT, p.WIDTH])
        self.assertIn("turned by 90 degrees clockwise", said)

    def test_a_mask_as_the_picture_is_stored_is_turned_with_it(self):
        p.jpeg(self.folder / "turned.jpg", p.bytes_of(self.light), 6)
        p.png(self.folder / "mask.png", self.mask.astype(np.uint8))
        _, report = self.photo("turned.jpg", "--mask", "mask.png")
        self.assertEqual(report["pixels"]["masked_out"], int((~self.mask).sum()))

    def test_alpha_is_the_mask(self):
        table = np.where(self.mask[..., None], self.light, [150, 140, 128])
        p.png(self.folder / "alpha.png", np.dstack([p.bytes_of(table), np.where(self.mask, 255, 0).astype(np.uint8)]))
        said, report = self.photo("alpha.png", "--truth", self.truth)
        self.assertIn("alpha channel is the mask", said)
        self.assertEqual(report["pixels"]["masked_out"], int((~self.mask).sum()))
        self.assertLess(report["median_error_deg"], 0.8)
        p.png(self.folder / "opaque.png", np.dstack([p.bytes_of(self.light), np.full(self.mask.shape, 255, np.uint8)]))
        self.assertNotIn("alpha", self.photo("opaque.png")[0])
        p.png(self.folder / "clear.png", np.dstack([p.bytes_of(self.light), np.zeros(self.mask.shape, np.uint8)]))
        self.assertIn("transparent everywhere", self.photo("clear.png", status=2)[0])

    def test_masks_of_any_depth_and_color(self):
        p.png(self.folder / "egg.png", p.bytes_of(np.where(self.mask[..., None], self.light, [150, 140, 128])))
        inside = self.mask.astype(np.uint8)
        p.png(self.folder / "labels.png", inside)
        p.png(self.folder / "labels16.png", inside.astype(np.uint16))
        p.png(self.folder / "red.png", np.dstack([inside * 128, inside * 0, inside * 0]))
        p.png(self.folder / "blue16.png", np.dstack([inside * 0, inside * 0, inside]).astype(np.uint16))
        p.png(self.folder / "drawn.png", np.dstack([inside * 0, inside * 0, inside * 0, inside * 255]))
        p.jpeg(self.folder / "mask.jpg", np.where(self.mask, 255, 0).astype(np.uint8))
        p.tiff(self.folder / "mask.tiff", self.mask.astype(np.float32))
        outside = int((~self.mask).sum())
        for name in "labels.png", "labels16.png", "red.png", "blue16.png", "drawn.png", "mask.jpg", "mask.tiff":
            _, report = self.photo("egg.png", "--mask", name)
            self.assertAlmostEqual(report["pixels"]["masked_out"], outside, delta=100 if name == "mask.jpg" else 0, msg=name)
        p.png(self.folder / "empty.png", inside * 0)
        self.assertIn("the mask empty.png is empty", self.photo("egg.png", "--mask", "empty.png", status=2)[0])
        p.png(self.folder / "half.png", inside[::2, ::2])
        self.assertIn("the mask is 100 x 75, the picture 200 x 150", self.photo("egg.png", "--mask", "half.png", status=2)[0])

    def test_the_largest_page_is_taken(self):
        stored = p.bytes_of(self.light)
        p.tiff(self.folder / "pages.tiff", stored[::4, ::4].copy(), stored, stored[::2, ::2].copy())
        said, report = self.photo("pages.tiff")
        self.assertEqual(report["input"]["size"], [p.WIDTH, p.HEIGHT])
        self.assertIn("3 pages, of which the first is 50 x 38: took page 2", said)

    def test_what_is_cut_is_an_error(self):
        stored = p.bytes_of(self.light)
        p.png(self.folder / "whole.png", stored)
        p.jpeg(self.folder / "whole.jpg", stored)
        p.tiff(self.folder / "whole.tiff", stored)
        for name in "whole.png", "whole.jpg", "whole.tiff":
            content = (self.folder / name).read_bytes()
            for share in 0.02, 0.5, 0.95:
                cut = "cut" + Path(name).suffix
                (self.folder / cut).write_bytes(content[: int(share * len(content))])
                said, _ = self.photo(cut, status=2)
                self.assertIn(cut, said)
                self.assertNotIn("OpenCV", said)
        header = p.struct.pack(">IIBBBBB", 60000, 60000, 8, 2, 0, 0, 0)
        (self.folder / "huge.png").write_bytes(b"\x89PNG\r\n\x1a\n" + p.chunk(b"IHDR", header) + p.chunk(b"IDAT", b"") + p.chunk(b"IEND", b""))
        said, _ = self.photo("huge.png", status=2)
        self.assertNotIn("OpenCV", said)

    def test_it_is_said_that_the_whole_surface_is_left_out(self):
        # Three paints that hardly differ: the lit pixels are not those of one ellipsoid.
        paint = np.random.default_rng(1).choice([0.95, 1, 1.05], (p.HEIGHT, p.WIDTH, 1), p=[0.2, 0.6, 0.2])
        p.png(self.folder / "paints.png", p.bytes_of(self.light * paint))
        one_paint = ["paints.png", "--model", "ellipsoid", "--paint", "even"]
        said, report = self.photo(*one_paint)
        self.assertIn("the whole surface is left out: the lit pixels do not have the colors of the solution", said)
        self.assertEqual(list(report["surface"]), ["left_out"])
        said, report = self.photo(*one_paint, "--lit-only")
        self.assertNotIn("whole surface", said)
        self.assertNotIn("surface", report)

    def test_the_size_is_printed(self):
        p.png(self.folder / "egg.png", p.bytes_of(self.light))
        self.assertIn("200 x 150, 8 bits in 3 channels", self.photo("egg.png")[0])

    def test_outputs_are_those_that_are_asked_for(self):
        p.png(self.folder / "egg.png", p.bytes_of(self.light))
        out = self.folder / "out"
        self.photo("egg.png", quick=False)
        self.assertTrue((out / "mesh.ply").exists())
        self.photo("egg.png", "--outputs", "depth", quick=False)
        self.assertEqual({f.name for f in out.iterdir()}, {"report.json", "depth.tiff", "depth.png"})
        self.photo("egg.png", "--outputs", "mesh", "--mesh-faces", "2000", quick=False)
        faces = int((out / "mesh.ply").read_bytes().split(b"element face ")[1].split(b"\n")[0])
        self.assertTrue(1000 < faces <= 2000, faces)
        self.photo("egg.png", "--outputs", "pixels", status=2, quick=False)


class NormalMaps(Case):
    def test_maps_of_other_programs(self):
        height = 0.42 * p.HEIGHT
        with_alpha = np.dstack([p.map_of(self.normals, self.mask, np.uint8), np.where(self.mask, 255, 0).astype(np.uint8)])
        maps = {"16.png": p.map_of(self.normals, self.mask, np.uint16), "8.png": p.map_of(self.normals, self.mask, np.uint8),
                "gray.png": p.map_of(self.normals, self.mask, np.uint8, outside=128), "rgba.png": with_alpha}
        span = {}
        for name, pixels in maps.items():
            p.png(self.folder / name, pixels)
            said, report = self.integrate(name)
            self.assertEqual(report["doubts"], [], name)
            self.assertIn("200 x 150", said)
            span[name] = report["range"][1] - report["range"][0]
            self.assertAlmostEqual(span[name], span["16.png"], delta=0.05 * span["16.png"], msg=name)
        self.assertGreater(span["16.png"], 0.5 * height)

    def test_what_is_turned_around_is_said_with_the_option_that_mends_it(self):
        for name, signs, option in ("down.png", (-1, 1), "--y-down"), ("inward.png", (1, -1), "--z-inward"):
            p.png(self.folder / name, p.map_of(self.normals, self.mask, np.uint16, 0, *signs))
            # No depth comes of a surface that turns its back.
            said, _ = self.integrate(name, status=1 if option == "--z-inward" else 0)
            self.assertEqual(said.count("doubt: "), 1, said)
            self.assertIn("give " + option, said)
            self.assertEqual(self.integrate(name, option)[1]["doubts"], [])
        p.png(self.folder / "good.png", p.map_of(self.normals, self.mask, np.uint16))
        self.assertIn("give no --y-down", self.integrate("good.png", "--y-down")[0])
        stored = np.rint(p.srgb(255.0 * p.map_of(self.normals, self.mask, np.uint16) / 65535)).astype(np.uint8)
        p.png(self.folder / "gamma.png", stored)
        self.assertIn("give --transfer srgb", self.integrate("gamma.png")[0])
        self.assertEqual(self.integrate("gamma.png", "--transfer", "srgb")[1]["doubts"], [])

    def test_a_photograph_is_none(self):
        p.png(self.folder / "egg.png", p.bytes_of(self.light))
        p.jpeg(self.folder / "egg.jpg", p.bytes_of(p.srgb(self.light)))
        p.tiff(self.folder / "egg.tiff", (self.light / 255).astype(np.float32))
        for name in "egg.png", "egg.jpg", "egg.tiff":
            self.assertIn("is not a normal map", self.integrate(name, status=2)[0])

    def test_known_depths_of_zero_are_doubted(self):
        p.png(self.folder / "map.png", p.map_of(self.normals, self.mask, np.uint16))
        rim = self.mask & ~(np.roll(self.mask, 3, 0) & np.roll(self.mask, -3, 0) & np.roll(self.mask, 3, 1) & np.roll(self.mask, -3, 1))
        p.tiff(self.folder / "zero.tiff", np.where(rim, 100, 0).astype(np.float32))
        p.tiff(self.folder / "nan.tiff", np.where(rim, 100, np.nan).astype(np.float32))
        self.assertIn("must be NaN", self.integrate("map.png", "--known", "zero.tiff")[0])
        self.assertEqual(self.integrate("map.png", "--known", "nan.tiff")[1]["doubts"], [])


class Results(Case):
    def setUp(self):
        p.png(self.folder / "egg.png", p.bytes_of(self.light))
        p.png(self.folder / "map.png", p.map_of(self.normals, self.mask, np.uint16))
        self.out = self.folder / "out"
        shutil.rmtree(self.out, ignore_errors=True)

    def left(self):
        return sorted(f.name for f in self.out.iterdir()) if self.out.exists() else []

    def test_old_results_do_not_survive_a_failed_run(self):
        for program, good in ("ofc_photo", "egg.png"), ("ofc_integrate", "map.png"):
            for bad in "no-such-file.png", "truth.tiff.gz":
                self.run_program(program, good, "--out", self.out)
                self.assertIn("report.json", self.left())
                (self.folder / "truth.tiff.gz").write_bytes(b"nothing")
                self.run_program(program, bad, "--out", self.out, status=2)
                self.assertEqual(self.left(), [])

    def test_inputs_are_not_overwritten(self):
        self.out.mkdir(exist_ok=True)
        for name in "normals.png", "albedo.png":
            shutil.copy(self.folder / "egg.png", self.out / name)
            before = (self.out / name).read_bytes()
            for arguments in [self.out / name], ["egg.png", "--mask", self.out / name], ["egg.png", "--dark", self.out / name]:
                said = self.run_program("ofc_photo", *arguments, "--out", self.out, status=2)
                self.assertIn("is an input", said)
                self.assertEqual((self.out / name).read_bytes(), before)
            (self.out / name).unlink()
        shutil.copy(self.folder / "map.png", self.out / "depth.png")
        self.run_program("ofc_integrate", self.out / "depth.png", "--out", self.out, status=2)

    def test_files_of_others_stay(self):
        self.out.mkdir()
        own = b"a picture of my own"
        (self.out / "depth.png").write_bytes(own)
        for program, good in ("ofc_photo", "egg.png"), ("ofc_integrate", "map.png"):
            self.assertIn("depth.png is there", self.run_program(program, good, "--out", self.out, status=2))
            self.assertEqual(self.left(), ["depth.png"])
        for _ in range(2):
            self.run_program("ofc_photo", "egg.png", "--outputs", "normals", "--out", self.out)
        self.run_program("ofc_photo", "no-such-file.png", "--outputs", "normals", "--out", self.out, status=2)
        self.assertEqual((self.out / "depth.png").read_bytes(), own)
        self.assertEqual(self.left(), ["depth.png"])
        for report in b"{}", b"[1]", b'{"program": "of others", "files": ["depth.png"]}', b"not JSON":
            (self.out / "report.json").write_bytes(report)
            self.run_program("ofc_photo", "egg.png", *QUICK, "--out", self.out, status=2)
            self.assertEqual((self.out / "report.json").read_bytes(), report)
        self.assertEqual((self.out / "depth.png").read_bytes(), own)

    def test_one_program_removes_what_another_left_and_reads_it_before(self):
        self.photo("egg.png", "--outputs", "normals,inliers,depth", quick=False)
        self.integrate(self.out / "normals.tiff")
        self.assertEqual(self.left(), ["depth.png", "depth.tiff", "mesh.ply", "mesh.png", "normals.tiff", "report.json"])
        self.photo("egg.png")
        self.assertEqual(self.left(), ["inliers.png", "normals.png", "normals.tiff", "report.json"])

    def test_several_pictures_have_a_folder_each_and_a_table(self):
        several = self.folder / "several"
        several.mkdir()
        for name in "one.png", "two.png":
            shutil.copy(self.folder / "egg.png", several / name)
        (several / "notes.txt").write_text("no picture")
        said = self.run_program("ofc_photo", "several", "egg.png", *QUICK, "--out", self.out)
        self.assertIn("egg.png: solved", said)
        self.assertEqual(self.left(), ["egg", "one", "report.json", "summary.csv", "two"])
        self.photo("egg.png")
        alone = (self.out / "normals.tiff").read_bytes()
        shutil.rmtree(self.out)
        p.png(several / "two.png", np.full((p.HEIGHT, p.WIDTH, 3), 90, np.uint8))
        (several / "cut.png").write_bytes((several / "one.png").read_bytes()[:1000])
        self.run_program("ofc_photo", "several", *QUICK, "--out", self.out, status=1)
        with open(self.out / "summary.csv", newline="") as file:
            rows = {Path(row["picture"]).name: row for row in csv.DictReader(file)}
        self.assertEqual({name: row["status"] for name, row in rows.items()}, {"cut.png": "2", "one.png": "0", "two.png": "1"})
        self.assertIn("cut", rows["cut.png"]["in_words"])
        self.assertGreater(float(rows["one.png"]["expected_error_deg"]), 0)
        self.assertEqual((self.out / "one/normals.tiff").read_bytes(), alone)
        self.assertFalse((self.out / "cut").exists())

    def table(self):
        with open(self.out / "summary.csv", newline="") as file:
            return {Path(row["picture"]).name: row for row in csv.DictReader(file)}

    def test_many_pictures_need_few_files_at_a_time(self):
        many = self.folder / "many"
        many.mkdir(exist_ok=True)
        names = [f"{i}.png" for i in range(30)]
        for name in names:
            (many / name).write_bytes(b"no picture")
        # With four there is none for a second process at a time, nor for what the first one reads.
        for most in 24, 4:
            limit = lambda most=most: resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
            self.run_program("ofc_photo", "many", *QUICK, "--out", self.out, status=1, preexec_fn=limit)
            self.assertEqual(sorted(self.table()), sorted(names))
            for row in self.table().values():
                self.assertNotEqual(row["status"], "0")
                self.assertNotEqual(row["in_words"], "")

    def test_a_table_has_no_numbers_of_an_earlier_run(self):
        several = self.folder / "again"
        several.mkdir(exist_ok=True)
        for name in "one.png", "two.png", "three.png":
            shutil.copy(self.folder / "egg.png", several / name)
        self.run_program("ofc_photo", "again", "--outputs", "normals", "--out", self.out)
        self.assertTrue(all(row["expected_error_deg"] for row in self.table().values()))
        (self.out / "two/inliers.png").write_bytes(b"my own")
        large = np.random.default_rng(1).integers(1, 255, (4000, 5000, 3)).astype(np.uint8)
        Image.fromarray(large).save(several / "three.png", compress_level=0)

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (1, 1))

        self.run_program("ofc_photo", "again", *QUICK, "--out", self.out, status=1, preexec_fn=limit)
        rows = self.table()
        self.assertEqual({name: row["status"] for name, row in rows.items()}, {"one.png": "0", "two.png": "2", "three.png": "1"})
        for name, words in ("two.png", "inliers.png is there"), ("three.png", "ended by a signal"):
            self.assertIn(words, rows[name]["in_words"])
            self.assertEqual([rows[name][field] for field in ("model", "expected_error_deg", "median_sigma_deg", "inliers")], [""] * 4, name)

    def test_what_a_failed_run_read_is_not_forgotten(self):
        self.photo("egg.png")
        self.integrate(self.out / "normals.tiff", "--known", "nope.tiff", status=2)
        self.assertEqual(self.left(), ["normals.tiff", "report.json"])
        self.assertEqual(json.loads((self.out / "report.json").read_text())["files"], ["normals.tiff"])
        self.photo("egg.png")
        self.assertEqual(self.left(), ["inliers.png", "normals.png", "normals.tiff", "report.json"])

    def test_a_report_names_files_in_its_folder_alone(self):
        self.out.mkdir(exist_ok=True)
        (self.out / "report.json").write_text(json.dumps({"program": "ofc", "files": ["", ".", "..", "../egg.png", "normals.png"]}))
        self.photo("egg.png")
        self.assertTrue((self.folder / "egg.png").exists())

    def test_a_folder_of_pictures_has_all_that_are_read(self):
        kinds = self.folder / "kinds"
        kinds.mkdir(exist_ok=True)
        for name in "a.pgm", "b.pbm", "c.exr", "d.hdr", "e.avif", "f.PFM":
            (kinds / name).write_bytes(b"no picture")
        self.run_program("ofc_photo", "kinds", *QUICK, "--out", self.out, status=1)
        self.assertEqual(len(self.table()), 6)

    def test_what_is_printed(self):
        for arguments in [], ["egg.png"]:
            self.assertEqual(self.run_program("ofc_photo", *arguments, "--quiet", *QUICK, "--out", self.out), "")
        report = json.loads(self.run_program("ofc_photo", "egg.png", "--json", "-", *QUICK, "--out", self.out))
        self.assertEqual(report, json.loads((self.out / "report.json").read_text()))
        with open("/dev/full", "w") as full:
            done = subprocess.run([BIN / "ofc_photo", "egg.png", "--json", "-", *QUICK, "--out", self.out], cwd=self.folder, stdout=full, stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 1)

    def test_frames_are_read_as_pictures_are(self):
        frames = self.folder / "frames"
        frames.mkdir()
        gray = np.full((60, 80, 3), 120, np.uint8)
        p.jpeg(frames / "0.jpg", gray, 6)
        p.png(frames / "1.png", np.full((80, 60, 4), [120, 120, 120, 255], np.uint8))
        self.run_program("ofc_live", "frames", "--out", self.out, status=1)
        self.assertEqual(self.left(), ["contacts.csv", "live.avi", "report.json"])
        own = self.folder / "..part"
        own.write_bytes(b"my own")
        self.run_program("ofc_live", "frames", "--out", self.out, status=1)
        self.assertTrue(own.exists())
        p.png(frames / "2.png", gray)
        self.assertIn("frame 2 is 80 x 60, the first one 60 x 80", self.run_program("ofc_live", "frames", "--out", self.out, status=2))
        self.assertEqual(self.left(), [])
        p.png(frames / "2.png", gray.astype(np.uint16))
        self.assertIn("8 bits", self.run_program("ofc_live", "frames", "--out", self.out, status=2))
        (frames / "2.png").write_bytes((frames / "1.png").read_bytes()[:60])
        self.assertIn("2.png", self.run_program("ofc_live", "frames", "--out", self.out, status=2))

    def test_an_interrupt_before_the_first_frame_ends_as_after_the_last(self):
        frames = self.folder / "slow"
        frames.mkdir()
        p.png(self.folder / "frame.png", np.full((60, 80, 3), 120, np.uint8))
        os.mkfifo(frames / "0.png")
        child = subprocess.Popen([BIN / "ofc_live", "slow", "--out", self.out], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        with open(frames / "0.png", "wb") as file:  # when it is read
            child.send_signal(signal.SIGINT)
            file.write((self.folder / "frame.png").read_bytes())
        said, _ = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 1, said)
        self.assertIn("look at report.json", said)
        self.assertEqual(self.left(), ["contacts.csv", "report.json"])
        self.assertEqual(json.loads((self.out / "report.json").read_text())["frames"], 0)

    def test_a_file_that_cannot_be_written_leaves_nothing(self):
        # As on a full disk: no file may be longer than so many bytes.
        def limit(size):
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        for program, good in ("ofc_photo", "egg.png"), ("ofc_integrate", "map.png"):
            self.run_program(program, good, "--out", self.out)
            files = [f.stat().st_size for f in self.out.iterdir()]
            for size in sorted({0, min(files) - 1, max(files) - 1, sorted(files)[len(files) // 2] - 1}):
                said = self.run_program(program, good, "--out", self.out, status=1, preexec_fn=lambda size=size: limit(size))
                self.assertIn("cannot", said)
                self.assertEqual(self.left(), [], f"{program}, {size} bytes")

    def test_a_video_that_is_cut_is_an_error(self):
        def limit(size):
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        frames = self.folder / "video"
        frames.mkdir()
        for i in range(3):
            p.png(frames / f"{i}.png", np.full((60, 80, 3), 120, np.uint8))
        self.run_program("ofc_live", "video", "--out", self.out, status=1)
        size = (self.out / "live.avi").stat().st_size
        # The rate that is drawn into the frames moves the size by some bytes.
        for most in size // 3, size - 200:
            said = self.run_program("ofc_live", "video", "--out", self.out, status=1, preexec_fn=lambda most=most: limit(most))
            self.assertIn("cannot write all frames", said)
            self.assertEqual(self.left(), [])

    def test_output_that_no_one_takes_is_an_error(self):
        for arguments in ["egg.png", *QUICK], ["--help"], ["--version"]:
            with open("/dev/full", "w") as full:
                done = subprocess.run([BIN / "ofc_photo", *arguments], cwd=self.folder, stdout=full, stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, 1)
            read, write = os.pipe()
            os.close(read)
            done = subprocess.run([BIN / "ofc_photo", *arguments], cwd=self.folder, stdout=write, stderr=subprocess.PIPE)
            os.close(write)
            self.assertEqual(done.returncode, 1)

    def test_a_killed_run_leaves_whole_files_alone(self):
        for delay in 0.05, 0.15, 0.3:
            shutil.rmtree(self.out, ignore_errors=True)
            child = subprocess.Popen([BIN / "ofc_photo", "egg.png", "--out", self.out], cwd=self.folder, stdout=subprocess.DEVNULL)
            time.sleep(delay)
            child.kill()
            child.wait()
            for name in self.left():
                content = (self.out / name).read_bytes()
                if name.endswith(".png"):
                    self.assertTrue(content.endswith(p.chunk(b"IEND", b"")), name)
                elif name.endswith(".tiff"):
                    p.floats_of(self.out / name)
                elif name.endswith(".json"):
                    json.loads(content)

    def test_numbers_that_are_none_are_refused(self):
        for option, values in {"--pixel-pitch": ["nan", "inf", "-1", "0", "1x", ""], "--seed": ["-1", "1" * 23, "1.5", ""],
                               "--ball-radius": ["nan", "0"], "--mesh-faces": ["-1"], "--out": [""]}.items():
            for value in values:
                self.run_program("ofc_photo", "egg.png", f"{option}={value}" if value else option, *([] if value else [""]), status=2)
        self.run_program("ofc_photo", "", status=2)
        self.run_program("ofc_integrate", "", status=2)
        self.run_program("ofc_integrate", "map.png", "--tolerance", "nan", status=2)
        self.run_program("ofc_table1", "--noise", "nan", status=2)

    def test_progress_is_for_terminals(self):
        leader, follower = pty.openpty()
        subprocess.run([BIN / "ofc_photo", "egg.png", *QUICK, "--out", self.out], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=follower)
        os.close(follower)
        said = os.read(leader, 65536).decode()
        os.close(leader)
        self.assertIn("reading", said)
        self.assertIn("solving", said)
        done = subprocess.run([BIN / "ofc_photo", "egg.png", *QUICK, "--out", self.out], cwd=self.folder, capture_output=True)
        self.assertEqual(done.stderr, b"")


if __name__ == "__main__":
    unittest.main()
