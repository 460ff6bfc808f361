"""How the time of a solution grows with the picture."""

from pathlib import Path

from library import RGB8, Library
from turns import table, turns


def report(ours: list[Library], repeats: int, directory: Path) -> None:
    """Milliseconds, and nanoseconds a pixel."""
    del directory
    rows = []
    for scene in ("dome", "egg"):
        for width, height in ((256, 256), (640, 480), (1920, 1080), (4000, 3000)):
            pixels, _ = ours[0].scene(scene, width, height)
            runs = {library.name: library.solve(library.image(pixels, RGB8))[1] for library in ours}
            best = turns(runs, repeats)
            rows.append((
                f"{scene} {width} x {height}",
                *(f"{best[name]:.1f} ({best[name] * 1e6 / (width * height):.0f})" for name in runs),
            ))  # fmt: skip
    table("Solution of a picture, milliseconds (nanoseconds a pixel)", ("", *(library.name for library in ours)), rows)
