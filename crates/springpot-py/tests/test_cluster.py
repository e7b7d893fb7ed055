"""Sweeps on workers: the same files as here, whoever dies on the way."""

import concurrent.futures
import json
import multiprocessing
import os
import pickle
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


def quiet(distributed, **words):
    return distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, silence_logs="CRITICAL", **words)


def test_dask_brings_tasks_that_take_long_to_fetch(monkeypatch):
    distributed = pytest.importorskip("distributed")
    # Every look ends long before 60 MB are here, however fast the machine is.
    monkeypatch.setattr(_cluster, "PATIENCE", 1e-3)
    wide = {"time.output_step": 2.5e-5}
    alphas = {"element.pad.alpha": [0.3, 0.4] + 9 * [0.5] + [0.6]}
    with quiet(distributed, processes=True) as cluster, distributed.Client(cluster) as client:
        run = sp.sweep(SLIDE, set=wide, sweep=alphas, client=client, chunk=12)
    table = run.table()
    assert len(run) == 12 and sum(column.nbytes for column in table.values()) > 50e6
    assert run.case(11) == sp.run(SLIDE, set=wide, sweep=alphas, jobs=2).case(11)


def test_a_scheduler_that_goes_away_ends_the_sweep(tmp_path):
    distributed = pytest.importorskip("distributed")
    sp.run(SLIDE, sweep=MANY, out=tmp_path / "here")
    with quiet(distributed, processes=False) as cluster, distributed.Client(cluster, timeout="1s") as client:

        def progress(share):
            if share > 0.2:
                cluster.close()

        with pytest.raises(sp.RunError, match="the scheduler of the client has gone|takes no more work"):
            sp.sweep(SLIDE, sweep=MANY, client=client, out=tmp_path / "there", chunk=1, progress=progress)
        with pytest.raises(sp.RunError, match="does not say how many workers|takes no more work"):
            sp.sweep(SLIDE, sweep=MANY, client=client)
    assert json.loads((tmp_path / "there/run.json").read_text())["status"] == "interrupted"
    run = sp.sweep(SLIDE, sweep=MANY, out=tmp_path / "there", resume=True)
    assert len(run) == 40 and files(tmp_path / "there") == files(tmp_path / "here")


class Answering:
    """A client that answers something of its own."""

    def __init__(self, answer):
        self.answer = answer

    def submit(self, work, payload, indices):
        future = concurrent.futures.Future()
        future.set_result(self.answer(work(payload, indices)))
        return future


def flipped(cases):
    torn = bytearray(cases[0])
    torn[len(torn) // 2] ^= 4
    return [bytes(torn), *cases[1:]]


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda cases: b"rubbish", "cases 0 to 1: the client gave bytes in place"),
        (lambda cases: None, "gave NoneType in place"),
        (lambda cases: [], "gave list of 0 in place"),
        (lambda cases: cases[:1], "gave list of 1 in place"),
        (lambda cases: [None, None], "something else than what work"),
        (lambda cases: [b"rubbish", b"rubbish"], "something else than what work"),
        (lambda cases: cases[::-1], "gave case 1 in place of case 0"),
        (flipped, "a case that was handed over is damaged"),
    ],
)
def test_rubbish_is_a_run_error(answer, message):
    with pytest.raises(sp.RunError, match=message):
        sp.sweep(SLIDE, sweep=GRID, client=Answering(answer), chunk=2)


def test_other_futures_will_do():
    class Future:
        def __init__(self, value, has_done):
            self.value, self.looks = value, 0
            if has_done:
                self.done = lambda: self.looked() > 2

        def looked(self):
            self.looks += 1
            return self.looks

        def result(self, timeout=None):
            if timeout is not None and self.looked() < 3:
                raise TimeoutError
            return self.value

    class Client:
        def submit(self, work, payload, indices):
            return Future(work(payload, indices), indices[0] % 2 == 0)

    class Nothing:
        def submit(self, work, payload, indices):
            return 3

    run = sp.sweep(SLIDE, sweep=GRID, client=Client(), chunk=1)
    assert run == sp.run(SLIDE, sweep=GRID)
    with pytest.raises(sp.RunError, match="submit gave int, which is no future"):
        sp.sweep(SLIDE, sweep=GRID, client=Nothing())


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
    with pytest.raises(sp.RunError, match="case 0 failed 3 times: too little"):
        sp.sweep(SLIDE, sweep=GRID, client=Failing(range(1, 99)), chunk=1, retries=2)
    # What a task raises is no time-out of a look at it.
    late = Failing(range(1, 99))
    late.fail = lambda: (_ for _ in ()).throw(TimeoutError("too late"))
    with pytest.raises(sp.RunError, match="cases 0 to 1 failed 2 times: too late"):
        sp.sweep(SLIDE, sweep=GRID, client=late, chunk=2, retries=1)


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
            # It comes when the sweep is under way; a sweep that does not hear it does not end.
            if not timers:
                timers.append(threading.Timer(0.1, signal.raise_signal, [signal.SIGINT]))
                timers[0].start()
            return concurrent.futures.Future()

    for words in [{}, {"out": tmp_path / "never"}]:
        timers = []
        begun = time.process_time()
        with pytest.raises(KeyboardInterrupt):
            sp.sweep(SLIDE, sweep=GRID, client=Never(), **words)
        assert timers and time.process_time() - begun < 5


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


class Process:
    """A future of Ray's kind: a reference to what a task gave or raised."""

    def __init__(self, future):
        self.future = future


class StandIn:
    """What the module ray has, as far as sweeps ask for it."""

    def __init__(self):
        self.pool, self.begun, self.puts, self.options = None, 0, 0, []

    def is_initialized(self):
        return self.pool is not None

    def init(self):
        self.pool = concurrent.futures.ThreadPoolExecutor(2)

    def cluster_resources(self):
        return {"CPU": 2.0}

    def put(self, value):
        self.puts += 1
        return Process(self.pool.submit(lambda: value))

    def remote(self, **options):
        self.options.append(options)
        ray = self

        class Task:
            def __init__(self, work):
                self.work = work

            def remote(self, payload, *others):
                ray.begun += 1
                fails = ray.begun in (1, 4)
                return Process(ray.pool.submit(lambda: 1 / 0 if fails else self.work(ray.get(payload), *others)))

        return Task

    def wait(self, references, timeout):
        return [one for one in references if one.future.done()], [one for one in references if not one.future.done()]

    def get(self, reference, timeout=None):
        return reference.future.result(timeout)

    def cancel(self, reference):
        reference.future.cancel()


def test_ray_is_a_client():
    ray = StandIn()
    run = sp.sweep(SLIDE, sweep=GRID, client=ray, chunk=1)
    # Two tasks failed, and were sent again; what all share was sent once.
    assert run == sp.run(SLIDE, sweep=GRID) and ray.begun == 8 and ray.puts == 1 and ray.options[0] == {"max_retries": 0}


@pytest.mark.parametrize("has_client", [False, True])
def test_chosen_columns_come_back_alone(tmp_path, has_client):
    whole = sp.run(SLIDE, sweep=GRID)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        client = {"client": pool} if has_client else {}
        some = sp.sweep(SLIDE, sweep=GRID, columns=["t", "pad.f*"], **client)
        none = sp.sweep(SLIDE, sweep=GRID, rows=False, **client)
        with pytest.raises(KeyError, match="no column 'pad.strok'; did you mean 'pad.stroke'"):
            sp.sweep(SLIDE, sweep=GRID, columns="pad.strok", **client)
    assert some.columns == ["t", "pad.force"] == list(some.case(3)) and len(some.table()) == 4 and "q.x" not in some
    assert [np.array_equal(one["pad.force"], other["pad.force"]) for one, other in zip(some, whole)] == 6 * [True]
    for run in (some, none):
        assert run.metrics == whole.metrics and run.events == whole.events and run.summary == whole.summary
        assert run != whole and run == pickle.loads(pickle.dumps(run)) and run.case(0).rows == 101
        with pytest.raises(KeyError, match="'q.x' was not brought back: name it in `columns`"):
            run.case(0)["q.x"]
        with pytest.raises(ValueError, match="some columns were kept alone"):
            run.save(tmp_path / "run")
        for page in (run.case(0)._repr_html_(), run._repr_html_(), repr(run)):
            assert "101" in page or "columns" in page
    assert none.columns == [] and len(none.case(0)) == 0
    with pytest.raises(sp.SpringpotError, match="brought none back"):
        none.table()
    assert not (tmp_path / "run").exists()


def test_little_comes_back_of_large_cases():
    study = _cluster.Study(SLIDE, {"time.output_step": 1e-4}, [], [])
    (whole,), (none,) = _cluster.work(study.to_bytes(), [0]), _cluster.work(study.to_bytes(), [0], [])
    assert len(whole) > 1_000_000 > 100 * len(none)


def test_what_cannot_be_chosen_is_refused(tmp_path):
    with pytest.raises(ValueError, match="what is written has all rows"):
        sp.sweep(SLIDE, sweep=GRID, columns="t", out=tmp_path / "run")
    with pytest.raises(ValueError, match="rows=False keeps no columns"):
        sp.sweep(SLIDE, sweep=GRID, columns="t", rows=False)
