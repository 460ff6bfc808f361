"""Time, and tables of it."""

import time
from collections.abc import Callable, Iterable, Sequence

NOTHING = "-"


def turns(runners: dict[str, Callable[[], object]], repeats: int) -> dict[str, float]:
    """The best CPU time of each in milliseconds; they take turns, so that all see the same machine."""
    best = dict.fromkeys(runners, float("inf"))
    for _ in range(repeats):
        for name, run in runners.items():
            start = time.process_time()
            own = run()
            took = (time.process_time() - start) * 1e3
            # What runs elsewhere says itself how long it took.
            best[name] = min(best[name], own if isinstance(own, float) else took)
    return best


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Prints a table in Markdown."""
    print(f"\n{title}\n")
    print("| " + " | ".join(head) + " |")
    print("| " + " | ".join(["---", *["---:"] * (len(head) - 1)]) + " |")
    for row in rows:
        print("| " + " | ".join(f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row) + " |", flush=True)
