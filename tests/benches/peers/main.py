"""What run.sh runs: DIRECTORY NAME=LIBRARY... -- [fit] [normals] [depth] [solve] [--repeats N]."""

import argparse
import importlib
import os
import sys
from pathlib import Path

from library import Library

TOPICS = ("fit", "normals", "depth", "solve")


def main() -> None:
    """Prints the tables of the topics that were asked for."""
    split = sys.argv.index("--")
    directory, libraries = Path(sys.argv[1]), sys.argv[2:split]
    parser = argparse.ArgumentParser(prog="tests/benches/peers/run.sh")
    parser.add_argument("topics", nargs="*", metavar="|".join(TOPICS))
    parser.add_argument("--repeats", type=int, default=5, help="turns of each, of which the best counts")
    arguments = parser.parse_args(sys.argv[split + 1 :])
    if unknown := set(arguments.topics) - set(TOPICS):
        parser.error(f"no such topic: {', '.join(sorted(unknown))}")
    ours = [Library(name, path, directory) for name, path in (pair.split("=") for pair in libraries)]
    with Path("/proc/cpuinfo").open() as lines:
        model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "unknown processor")
    print(f"{model}, load {os.getloadavg()[0]:.1f} of {os.cpu_count()}; CPU time, the best of {arguments.repeats} turns")
    for topic in arguments.topics or TOPICS:
        importlib.import_module(topic).report(ours, arguments.repeats, directory)


if __name__ == "__main__":
    main()
