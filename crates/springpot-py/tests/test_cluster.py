"""Sweeps on workers: the same files as here, whoever dies on the way."""

import concurrent.futures
import json
import multiprocessing
import os
import signal
import threading
import time

import numpy as np
import pytest

import springpot as sp
from springpot import _cluster
from test_run import GRID, SLIDE, files

MANY = {"element.pad.alpha": list(np.linspace(0.2, 0.9, 40).round(6))}
SPAWN = multiprocessing.get_context("spawn")


def test_executors_give_the_same_files(tmp_path):
    sp.run(SLIDE, sweep=GRID, out=tmp_path / "here")
    with concurrent.futures.ProcessPoolExecutor(2, mp_context=SPAWN) as client:
        run = sp.sweep(SLIDE, sweep=GRID, client=client, out=tmp_path / "there", chunk=2)
        again = sp.sweep(SLIDE, sweep=GRID, client=client)
    assert files(tmp_path / "there") == files(tmp_path / "here")
    for k in range(6):
        assert np.array_equal(run.case(k)["pad.force"], again.case(k)["pad.force"])


def test_dask_loses_nothing_with_a_worker_that_is_killed(tmp_path):
    distributed = pytest.importorskip("distributed")
    sp.run(SLIDE, sweep=MANY, out=tmp_path / "here")
    shares = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs="CRITICAL"
    ) as cluster, distributed.Client(cluster) as client:
        pids = list(client.run(os.getpid).values())

        def progress(share):
            shares.append(share)
            if share > 0.2 and len(pids) == 2:
                os.kill(pids.pop(), signal.SIGKILL)

        run = sp.sweep(SLIDE, sweep=MANY, client=client, out=tmp_path / "there", chunk=1, progress=progress)
    assert len(pids) == 1 and len(run) == 40 and not run.failures
    assert files(tmp_path / "there") == files(tmp_path / "here")


class Failing:
    """A client whose tasks fail on the way, and that breaks after so many."""

    def __init__(self, failing, most=10**9):
        self.failing, self.most, self.sent = failing, most, 0
        self.inner = concurrent.futures.ThreadPoolExecutor(2)

    def submit(self, work, payload, indices):
        self.sent += 1
        if self.sent > self.most:
            raise RuntimeError("out of order")
        if self.sent in self.failing:
            return self.inner.submit(self.fail)
        return self.inner.submit(work, payload, indices)

    @staticmethod
    def fail():
        raise MemoryError("too little")


def test_tasks_that_fail_are_sent_again_so_often():
    run = sp.sweep(SLIDE, sweep=GRID, client=Failing({1, 3, 7}), chunk=1)
    assert len(run) == 6 and not run.failures
    with pytest.raises(sp.RunError, match="cases 0 to 0 failed 3 times: too little"):
        sp.sweep(SLIDE, sweep=GRID, client=Failing(range(1, 99)), chunk=1, retries=2)


def test_a_sweep_goes_on_where_its_client_broke(tmp_path):
    sp.run(SLIDE, sweep=MANY, out=tmp_path / "here")
    with pytest.raises(sp.RunError, match="takes no more work: out of order"):
        sp.sweep(SLIDE, sweep=MANY, client=Failing((), most=23), out=tmp_path / "there", chunk=1)
    assert json.loads((tmp_path / "there/run.json").read_text())["status"] == "interrupted"
    asked = []
    whole = _cluster.work

    def counted(payload, indices):
        asked.extend(indices)
        return whole(payload, indices)

    client = Failing(())
    client.submit = lambda work, payload, indices: client.inner.submit(counted, payload, indices)
    run = sp.sweep(SLIDE, sweep=MANY, client=client, out=tmp_path / "there", chunk=1, resume=True)
    assert len(run) == 40 and min(asked) > 5
    assert files(tmp_path / "there") == files(tmp_path / "here")
    other = {"element.pad.alpha": [0.3]}
    with pytest.raises(sp.RunError):
        sp.sweep(SLIDE, sweep=MANY, client=Failing((), most=3), out=tmp_path / "other", chunk=1)
    with pytest.raises(sp.SpringpotError, match="another run"):
        sp.sweep(SLIDE, sweep=other, client=Failing(()), out=tmp_path / "other", resume=True)


def test_ctrl_c_ends_a_sweep_of_workers(tmp_path):
    class Never:
        def submit(self, work, payload, indices):
            return concurrent.futures.Future()

    for words in [{}, {"out": tmp_path / "never"}]:
        timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
        timer.start()
        begun = time.monotonic()
        try:
            with pytest.raises(KeyboardInterrupt):
                sp.sweep(SLIDE, sweep=GRID, client=Never(), **words)
        finally:
            timer.cancel()
        assert time.monotonic() - begun < 5


@pytest.mark.parametrize(
    ("words", "error"),
    [
        ({"client": 3}, TypeError),
        ({"client": Failing(()), "chunk": 0}, ValueError),
        ({"client": Failing(()), "resume": True}, ValueError),
    ],
)
def test_bad_clients_are_clean_exceptions(words, error):
    with pytest.raises(error):
        sp.sweep(SLIDE, sweep=GRID, **words)
