"""A folder with pictures of an egg, and the programs that are run in it."""

import json
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pictures as p

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
