"""Throughput of a sweep over two Dask workers beside two threads here, in turn.

``python bench/workers.py [CASES] [ROUNDS]``; needs ``distributed`` from PyPI.
"""

import sys
import time

import distributed
import numpy as np

import springpot as sp

SLIDE = """
[robot]
gravity = [0, 0, 0]
[[robot.body]]
name = "mass"
joint = { name = "x", kind = "prismatic", axis = [1, 0, 0] }
mass = 2
[[element]]
name = "pad"
joint = "x"
law = "fractional-zener"
parameters = { k_e = 100, k_m = 300, c = 20, alpha = 0.6 }
[motion]
kind = "forward"
torque = { x = "5*sin(3*t)" }
[time]
end = 5
output_step = 0.05
[output]
columns = ["t", "q.*", "pad.force"]
"""


def main(cases=10_000, rounds=3):
    grid = {"element.pad.alpha": np.linspace(0.3, 0.9, cases).round(9)}
    rates = {"threads": [], "workers": []}
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            sp.sweep(SLIDE, sweep={"element.pad.alpha": [0.3, 0.4]}, client=client, chunk=1)
            for _ in range(rounds):
                begun = time.perf_counter()
                here = sp.run(SLIDE, sweep=grid, jobs=2)
                rates["threads"].append(cases / (time.perf_counter() - begun))
                begun = time.perf_counter()
                there = sp.sweep(SLIDE, sweep=grid, client=client)
                rates["workers"].append(cases / (time.perf_counter() - begun))
                for k in np.linspace(0, cases - 1, 20, dtype=int):
                    assert np.array_equal(here.case(k)["pad.force"], there.case(k)["pad.force"])
    medians = {name: np.median(found) for name, found in rates.items()}
    for name, median in medians.items():
        print(f"{name}: {median:.0f} cases/s")
    print(f"workers/threads: {medians['workers'] / medians['threads']:.3f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
