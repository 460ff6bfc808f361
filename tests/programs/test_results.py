"""What the programs leave in the folder of their results: all of it, or nothing, and nothing of others."""

import csv
import json
import os
import pty
import resource
import shutil
import signal
import subprocess
import time
import unittest
from pathlib import Path

import numpy as np
import pictures as p
from case import BIN, QUICK, Case
from PIL import Image


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
