"""D^alpha of 0.7 sin 8t + 0.1 t by the PyPI packages pycaputo and differint, each method that gives a whole series.

Writes a line of JSON: {"versions": {PACKAGE: VERSION}, "missing": [PACKAGE, …], "methods": [NAME, …]}. Then answers
requests: a line {"method": NAME, "end": T, "alpha": ALPHA, "rows": R, "repeats": K, "checks": [ROW, …]} and R numbers
of 8 bytes, little endian: the samples, equally spaced from 0 to T. The answer is a line {"seconds": MEDIAN, "values":
[D^alpha x at the rows asked for]}, or {"error": TEXT}. Times are those of the one call that takes the samples and gives
the series; grids are built before. Methods that take functions instead of samples are given x (and x') exactly. Needs
numpy, scipy and one of the packages.
"""

import importlib
import importlib.metadata
import json
import math
import statistics
import sys
import time
import warnings

import numpy as np

warnings.simplefilter("ignore")


class Signal:
    """x and, where asked for, x'."""

    def __call__(self, t, d=0):
        return 5.6 * np.cos(8 * t) + 0.1 if d == 1 else 0.7 * np.sin(8 * t) + 0.1 * t


def of_pycaputo():
    from pycaputo.differentiation import caputo, diff, grunwald_letnikov
    from pycaputo.grid import make_uniform_points

    def method(make, of_samples):
        def prepare(end, alpha, x):
            points, scheme = make_uniform_points(len(x), 0.0, end), make(alpha)
            given = x if of_samples else Signal()
            return lambda: diff(scheme, given, points)

        return prepare

    return {
        "pycaputo L1": method(caputo.L1, True),
        "pycaputo GL": method(grunwald_letnikov.GrunwaldLetnikov, True),
        "pycaputo shifted GL, x as a function": method(
            lambda a: grunwald_letnikov.ShiftedGrunwaldLetnikov(a, a / 2), False
        ),
        "pycaputo Diethelm 80, x′ as a function": method(lambda a: caputo.Diethelm(a, "Radau", 80), False),
    }


def of_differint():
    from differint import differint

    def method(function):
        return lambda end, alpha, x: lambda: function(alpha, x, 0.0, end, len(x))

    def transform(end, alpha, x):
        # Of an odd number of samples it gives one less than it got, and others: it is given one more.
        step = end / (len(x) - 1)
        x = np.append(x, Signal()(end + step))
        return lambda: differint.GL(alpha, x, 0.0, end + step, len(x))

    def matrix(end, alpha, x):
        gigabytes = 2 * 8 * len(x) ** 2 / 1e9
        if gigabytes > 4:
            raise MemoryError(f"its two matrices would take {gigabytes:.0f} GB")
        return method(differint.RL)(end, alpha, x)

    return {
        "differint GL": transform,
        "differint GLI": method(differint.GLI),
        "differint RL": matrix,
    }


def main():
    versions, missing, methods = {}, [], {}
    for package, find in {"pycaputo": of_pycaputo, "differint": of_differint}.items():
        try:
            importlib.import_module(package)
            methods.update(find())
            versions[package] = importlib.metadata.version(package)
        except ImportError as error:
            missing.append(f"{package} ({error})")
    print(json.dumps({"versions": versions, "missing": missing, "methods": list(methods)}), flush=True)
    while line := sys.stdin.buffer.readline():
        request = json.loads(line)
        x = np.frombuffer(sys.stdin.buffer.read(8 * request["rows"]), dtype="<f8")
        try:
            call = methods[request["method"]](request["end"], request["alpha"], x)
            seconds = []
            for _ in range(request["repeats"]):
                start = time.perf_counter()
                y = call()
                seconds.append(time.perf_counter() - start)
            values = [float(y[row]) for row in request["checks"]]
            values = [value if math.isfinite(value) else None for value in values]
            answer = {"seconds": statistics.median(seconds), "values": values}
        except (MemoryError, ValueError, IndexError, AssertionError) as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    main()
