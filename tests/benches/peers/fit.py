"""The least median of squares fit against robustbase's ltsReg, MASS's lqs and scikit-learn's RANSAC: time and objective."""

import itertools
import subprocess
from pathlib import Path

import numpy as np
from library import RGB32F, Library
from sklearn.linear_model import LinearRegression, RANSACRegressor
from turns import NOTHING, table, turns

CASES = ((307_200, 0), (307_200, 20), (307_200, 40), (1_000_000, 40))
# As it is called, and without what it computes besides.
LTS, BARE = "robustbase ltsReg", "ltsReg(mcd = FALSE)"


def regressors(colors: np.ndarray) -> np.ndarray:
    """What the coefficients c11, c22, c33, c12, c13, c23 are multiplied with."""
    r, g, b = colors.astype(float).T
    return np.stack([r * r, g * g, b * b, 2 * r * g, 2 * r * b, 2 * g * b], -1)


class R:
    """ltsReg and lqs, which keep their data."""

    def __init__(self, directory: Path) -> None:
        script = str(Path(__file__).with_name("fit.R"))
        self.file = directory / "points.f32"
        self.process = subprocess.Popen(["Rscript", "--vanilla", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def ask(self, *words: object) -> list[float]:
        """The numbers that R answers with."""
        print(*words, file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline().split()
        if not answer:
            raise RuntimeError("R ended")
        return [float(number) for number in answer]

    def load(self, colors: np.ndarray) -> None:
        """Gives R the points."""
        colors.tofile(self.file)
        self.ask("load", self.file)

    def end(self) -> None:
        """Ends R."""
        self.process.stdin.close()
        self.process.wait()


def report(ours: list[Library], repeats: int, directory: Path) -> None:
    """One table for every number of points and share of outliers."""
    other = R(directory)
    for count, share in CASES:
        colors = ours[0].points(count, share)
        x, y = regressors(colors), np.ones(count)
        other.load(colors)
        found: dict[str, list[tuple[float, float]]] = {}

        def objective(coefficients: object, x: np.ndarray = x) -> float:
            return float(np.median((x @ np.array(list(coefficients)) - 1) ** 2))

        def keep(name: str, robust: object, last: object, found: dict = found) -> None:
            found.setdefault(name, []).append((objective(robust), objective(last)))

        def fit(library: Library, colors: np.ndarray = colors) -> object:
            image = library.image(colors.reshape(1, -1, 3), RGB32F)
            params = library.params("lmeds")
            need = library.c.ofc_lmeds_workspace_size(image.width, 1, params)
            workspace = library.workspace(need)
            result, test = library.ffi.new("ofc_color_fit *"), library.ffi.new("ofc_inlier_test *")

            def run() -> None:
                library.check(
                    library.c.ofc_lmeds_fit(image, params, library.pointer(workspace, "void *"), need, result, test)
                )

            def kept() -> float:
                # The best of three: a fit is too short for one. Another seed each turn.
                params.seed += 1
                best = turns({"": run}, 3)[""]
                keep(library.name, result.robust, [estimate.value for estimate in result.coefficients])
                return best

            return kept

        def lts(name: str, word: str) -> object:
            seeds = itertools.count(1)

            def run() -> float:
                time, *both = other.ask(word, next(seeds))
                keep(name, both[:6], both[6:])
                return time

            return run

        runs = {library.name: fit(library) for library in ours}
        runs[LTS] = lts(LTS, "lts")
        runs[BARE] = lts(BARE, "bare")
        best = turns(runs, repeats)
        if (count, share) == CASES[2]:
            limit = 2.5 * 1.4826 * found[ours[0].name][0][0] ** 0.5
            linear = LinearRegression(fit_intercept=False)
            ransac = RANSACRegressor(
                linear, min_samples=6, residual_threshold=limit, stop_probability=0.9999, max_trials=500, random_state=1
            )

            def consensus(ransac: RANSACRegressor = ransac, x: np.ndarray = x, y: np.ndarray = y) -> None:
                ransac.fit(x * 255.0**-2, y)

            best.update(turns({"scikit-learn RANSAC": consensus}, 2))
            coefficients = ransac.estimator_.coef_ * 255.0**-2
            keep("scikit-learn RANSAC", coefficients, coefficients)
            best["MASS lqs"], *both = other.ask("lms", 1)
            keep("MASS lqs", both[:6], both[6:])
        rows = []
        for name, time in best.items():
            robust, last = np.array(found[name]).T * 1e3
            ratio = f"{best[LTS] / time:.1f}"
            span = f"{robust.min():.4f}-{robust.max():.4f}" if len(robust) > 1 else f"{robust[0]:.4f}"
            rows.append((name, f"{time:.1f}", ratio, span, f"{np.median(robust):.4f}", f"{np.median(last):.4f}" if name != "MASS lqs" else NOTHING))
        table(
            f"Fit of {count} points, {share} % outliers; the objective is the median squared residual over all points in 1e-3",
            ("", "ms", "times as fast as ltsReg", "objective over seeds", "median", "after least squares"),
            rows,
        )
    other.end()
