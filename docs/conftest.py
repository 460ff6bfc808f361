"""The guide's programs run: Python in one namespace a page, C through a compiler, commands of the shell in a folder with pictures."""

import os
import subprocess
import sys
from pathlib import Path

import cv2
import matplotlib
import numpy as np
import pytest
from sybil import Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser

import orientation_from_color as ofc

ROOT = Path(__file__).parents[1]
matplotlib.use("Agg")


def evaluate_c(example):
    """Strictly, but not linked: what the board has is the reader's."""
    command = ["gcc", "-xc", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{ROOT / 'include'}", "-c", "-o", os.devnull, "-"]
    subprocess.run(command, input=example.parsed.encode(), check=True)


def evaluate_sh(example):
    """With the python that runs this."""
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    subprocess.run(["bash", "-eu", "-c", example.parsed], env={**os.environ, "PATH": path}, check=True)


def evaluate_rust(example):
    """A program with the crates that its first line adds: it makes a normal map of photo.png."""
    project = ROOT / "target/docs/rust"
    (project / "src").mkdir(parents=True, exist_ok=True)
    (project / "src/main.rs").write_text(example.parsed)
    if not (project / "Cargo.toml").exists():
        (project / "Cargo.toml").write_text('[package]\nname = "normals"\nedition = "2024"\n\n[workspace]\n')
        add = ["cargo", "add", "--quiet", f"--manifest-path={project / 'Cargo.toml'}"]
        subprocess.run([*add, f"--path={ROOT / 'ofc-core'}"], check=True)
        subprocess.run([*add, "image", "--no-default-features", "--features=png"], check=True)
    cargo = ["cargo", "run", "--quiet", f"--manifest-path={project / 'Cargo.toml'}"]
    subprocess.run([*cargo, "photo.png", "rust.png"], check=True, env={**os.environ, "CARGO_TARGET_DIR": str(ROOT / "target/docs/cargo")})
    solution = ofc.solve(cv2.imread("photo.png"), channels="bgr")
    known = solution.inliers
    difference = ofc.normal_map(solution.normals())[known].astype(int) - cv2.imread("rust.png")[..., ::-1][known]
    assert np.abs(difference).max() <= 1


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """photo.png with its mask.png; press.png, press2.png, press3.png of a ball of 40 pixels, untouched.png: where the programs run."""
    folder = tmp_path_factory.mktemp("guide")
    lights = np.array([[-0.45, 0.4, 0.8], [0.5, 0.3, 0.81], [0.05, -0.6, 0.8]])
    lights /= np.linalg.norm(lights, axis=1, keepdims=True)
    colors = np.array([[1.0, 0.15, 0.1], [0.2, 0.9, 0.1], [0.1, 0.2, 1.0]])

    y, x = np.mgrid[0:300, 0:400]
    u, v = (x - 199.5) / 180, (y - 149.5) / 135
    shape = 110 * np.sqrt(np.maximum(1 - u * u - v * v, 0)) + 4 * np.cos(6 * u) * np.cos(5 * v)
    mask = u * u + v * v < 0.95
    scene = ofc.render(shape.astype(np.float32), lights, colors, mask, params=ofc.RenderParams(noise=0.5, peak=230))
    cv2.imwrite(str(folder / "photo.png"), scene.pixels[..., ::-1])
    cv2.imwrite(str(folder / "mask.png"), np.where(mask, 255, 0).astype(np.uint8))

    y, x = np.mgrid[0:180, 0:240]
    edge, skirt = 26.0, 12.0
    steepest = edge / np.sqrt(40**2 - edge**2)
    for name, (x0, y0) in {"press": (130.5, 80.5), "press2": (70.5, 110.5), "press3": (175.5, 60.5)}.items():
        d = np.hypot(x - x0, y - y0)
        inside = np.sqrt(np.maximum(40.0**2 - d**2, 0)) - np.sqrt(40**2 - edge**2) + steepest * skirt / 2
        outside = steepest * np.maximum(skirt - (d - edge), 0) ** 2 / (2 * skirt)
        gel = np.where(d < edge, inside, outside).astype(np.float32)
        press = ofc.render(gel, lights, colors, params=ofc.RenderParams(noise=0.7, peak=200, cast_shadows=False))
        cv2.imwrite(str(folder / f"{name}.png"), press.pixels[..., ::-1])
    peak = press.scale * ofc.render(0 * gel, lights, colors).largest_modulus
    untouched = ofc.render(0 * gel, lights, colors, params=ofc.RenderParams(noise=0.7, peak=peak, seed=1))
    cv2.imwrite(str(folder / "untouched.png"), untouched.pixels[..., ::-1])

    before = Path.cwd()
    os.chdir(folder)
    yield folder
    os.chdir(before)


pytest_collect_file = Sybil(
    parsers=[
        PythonCodeBlockParser(),
        CodeBlockParser(language="rust", evaluator=evaluate_rust),
        CodeBlockParser(language="c", evaluator=evaluate_c),
        CodeBlockParser(language="sh", evaluator=evaluate_sh),
    ],
    patterns=["guide/*.md", "reference/*.md"],
    fixtures=["pictures"],
).pytest()
