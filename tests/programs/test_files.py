"""ofc_photo and ofc_integrate with files as they are on people's disks."""

import unittest
from pathlib import Path

import numpy as np
import pictures as p
from case import Case


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


if __name__ == "__main__":
    unittest.main()
