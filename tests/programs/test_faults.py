"""What ofc_photo, ofc_integrate and ofc_live leave where a call of the system fails, or where they are killed at one.

FAULTS=all in the environment lets each call of each function fail, which takes minutes.
"""

import json
import os
import shutil
import signal
import subprocess
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pictures as p

BIN = Path(__file__).resolve().parents[2] / "target/c_examples"
FUNCTIONS = ["open", "read", "fopen", "fread", "write", "fsync", "linkat", "rename", "unlink", "malloc"]
# Which each program calls.
CALLED = ["fopen", "fread", "write", "fsync", "rename", "unlink", "malloc"]
# Where being killed is not the same as at the call before.
DEADLY = ["write", "fsync", "linkat", "rename", "unlink"]
WIDTH, HEIGHT = 64, 48


def some(count, function):
    """Which calls of so many fail: the first, the last and some between."""
    few = 4 if function == "malloc" else 2
    if os.environ.get("FAULTS") == "all":
        few = 400 if function == "malloc" else count
    return sorted({round(1 + i * (count - 1) / max(few - 1, 1)) for i in range(few)}) if count else []


def has_files_without_names(folder):
    """Whether the file system has them, which then are linked to their names."""
    try:
        os.close(os.open(folder, os.O_TMPFILE | os.O_RDWR))
    except OSError:
        return False
    return True


def contents(folder):
    """The bytes of each file; of a report what is the same in each run."""
    found = {}
    for path in folder.iterdir() if folder.exists() else []:
        # A video shows how many frames there were a second.
        found[path.name] = path.read_bytes()[: 4 if path.suffix == ".avi" else None]
        if path.suffix == ".json":
            report = json.loads(found[path.name])
            for key in "ms", "frames_per_second":
                report.pop(key, None)
            report.get("depth", {}).pop("ms", None) if isinstance(report.get("depth"), dict) else None
            found[path.name] = json.dumps(report).encode()
    return found


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.library = cls.folder / "faults.so"
        source = Path(__file__).with_name("faults.c")
        subprocess.run(["cc", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-o", cls.library, source, "-ldl"], check=True)
        normals, mask = p.egg(WIDTH, HEIGHT)
        for seed in 1, 2:
            p.png(cls.folder / f"egg{seed}.png", p.bytes_of(p.light_of(normals, mask, seed=seed)), p.chunk(b"gAMA", p.struct.pack(">I", 100000)))
            p.png(cls.folder / f"map{seed}.png", p.map_of((normals * [1, 1, seed]) / np.linalg.norm(normals * [1, 1, seed], axis=2)[..., None], mask, np.uint16))
            frames = cls.folder / f"frames{seed}"
            frames.mkdir()
            for i in range(2):
                p.png(frames / f"{i}.png", np.full((HEIGHT, WIDTH, 3), 120 + 10 * seed, np.uint8))

    def run_program(self, program, arguments, out, fault=None, count=None):
        environment = dict(os.environ, LD_PRELOAD=str(self.library), OPENCV_FOR_THREADS_NUM="1")
        if fault:
            environment["FAULT"] = fault
        if count:
            environment["FAULT_COUNT"] = str(count)
        return subprocess.run([BIN / program, *arguments, "--out", out], cwd=self.folder, env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")

    def check(self, program, arguments, olds, status):
        """`olds` are the arguments of a run before, whose results must not be taken for those of this one."""
        good, before = self.folder / f"{program}_good", self.folder / f"{program}_before"
        counted = self.folder / f"{program}_count"
        self.assertEqual(self.run_program(program, arguments, good, count=counted).returncode, status)
        counts = {function: int(count) for function, count in map(str.split, counted.read_text().splitlines())}
        for function in CALLED + ["linkat"] * has_files_without_names(self.folder):
            self.assertGreater(counts[function], 0, f"{program} calls {function}, and that is not seen")
        self.assertEqual(self.run_program(program, olds, before).returncode, status)
        good, old = contents(good), contents(before)
        faults = []
        for function in FUNCTIONS:
            calls = some(counts[function], function)
            faults += [(function, n, False) for n in calls] + [(function, n, True) for n in calls if function in DEADLY]

        def one(fault):
            function, n, kills = fault
            name = f"{program}, call {n} of {function}" + (", killed" if kills else "")
            out = self.folder / name.replace(" ", "_")
            shutil.copytree(before, out)
            done = self.run_program(program, arguments, out, f"{function} {n}{' kill' if kills else ''}")
            left = contents(out)
            shutil.rmtree(out, ignore_errors=True)
            return name, done, left, kills

        with ThreadPoolExecutor(2) as pool:
            for name, done, left, kills in pool.map(one, faults):
                name = f"{name}: status {done.returncode}, left {sorted(left)}\n{done.stderr}"
                # GDAL, by which OpenCV knows more kinds of files, ends a program that gets no memory: as if it were killed.
                is_ended = "malloc" in name and done.returncode in (-signal.SIGABRT, -signal.SIGSEGV)
                if kills or is_ended:
                    self.assertTrue(is_ended or done.returncode == -signal.SIGKILL, name)
                    self.assertNotIn("terminate called", done.stderr, name)
                    if {file: left[file] for file in left if not file.startswith(".")} == old:
                        continue  # nothing was begun
                    for file, content in left.items():
                        if file == "report.json":
                            self.assertTrue(content == good[file] or json.loads(content)["status"] == "not finished", name)
                        elif not file.startswith("."):
                            finished = b"not finished" not in left["report.json"]
                            self.assertTrue(content == good[file] or (content == old[file] and not finished), f"{file} after {name}")
                elif done.returncode == status and left == good:
                    continue  # the call did not matter
                else:
                    self.assertIn(done.returncode, (1, 2), name)
                    self.assertNotEqual(done.stderr, "", name)
                    self.assertNotIn("terminate", done.stderr, name)
                    self.assertTrue(left in ({}, old) or "cannot remove" in done.stderr, name)

    def test_photo(self):
        self.check("ofc_photo", ["egg1.png", "--outputs", "normals,depth"], ["egg2.png", "--outputs", "normals,depth"], 0)

    def test_integrate(self):
        self.check("ofc_integrate", ["map1.png"], ["map2.png"], 0)

    def test_live(self):
        self.check("ofc_live", ["frames1"], ["frames2"], 1)


if __name__ == "__main__":
    unittest.main()
