"""Whom a cluster listens to, and what is said of one that does not answer."""

from __future__ import annotations

import gc
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import nullcontext
from importlib import import_module
from pathlib import Path
from runpy import run_path
from typing import Any

import pytest
from hazards import Hazard, work

from elbowscrew import save_simulation, simulate_trial
from elbowscrew.cli import main
from elbowscrew.errors import UsageError
from elbowscrew.study.executors import open_executor
from elbowscrew.study.outcome import Failure
from elbowscrew.study.running import _collect, run_tasks

distributed: Any = pytest.importorskip("distributed")
psutil: Any = import_module("psutil")  # Dask's own
dask: Any = import_module("dask")

pytestmark = pytest.mark.filterwarnings("default")  # Dask leaves sockets to the garbage

LOCAL = """
import sys
import http.client, urllib.request
import psutil
from elbowscrew.study.executors import open_executor
if __name__ == "__main__":
    with open_executor("local-cluster", 1)() as executor:
        assert executor.submit(max, 1, 2).result() == 2
        me = psutil.Process()
        found = [one.laddr for who in (me, *me.children(recursive=True)) for one in who.net_connections("inet")
                 if one.status == psutil.CONN_LISTEN]
        statuses = []
        for at in found:
            try:
                urllib.request.urlopen(f"http://{at.ip}:{at.port}/status", timeout=2)
                statuses.append(at.port)
            except (OSError, http.client.HTTPException):
                pass
        print(sorted({at.ip for at in found}), statuses)
"""


def test_a_cluster_of_this_machine_listens_on_it_alone_and_shows_no_dashboard(tmp_path: Path) -> None:
    script = tmp_path / "local.py"
    script.write_text(LOCAL)
    told = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True).stdout
    assert told == "['127.0.0.1'] []\n"


@pytest.mark.parametrize(
    "address", ["nonsense", "http://a:1", "foo://a:1", "tcp://a", "tcp://a:b", "tcp://", "a b:1", ""]
)
def test_what_cannot_be_an_address_is_told_before_anything_is_done(address: str) -> None:
    with pytest.raises(UsageError, match="expected tcp://host:port, tls://host:port or local-cluster"):
        open_executor(address, 1)


def test_tls_without_certificates_says_what_is_missing() -> None:
    with (
        pytest.raises(UsageError, match="its certificates are missing"),
        open_executor("tls://127.0.0.1:1", 1)(),
    ):
        pass


@pytest.fixture
def certificates(tmp_path: Path) -> Iterator[Any]:
    """A certificate that answers for itself, in Dask's configuration."""
    if shutil.which("openssl") is None:
        pytest.skip("needs openssl")
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=localhost",
         "-keyout", str(key), "-out", str(certificate)],
        check=True, capture_output=True,
    )  # fmt: skip
    tls = {f"distributed.comm.tls.{who}.key": str(key) for who in ("client", "scheduler", "worker")}
    tls |= {f"distributed.comm.tls.{who}.cert": str(certificate) for who in ("client", "scheduler", "worker")}
    with dask.config.set({**tls, "distributed.comm.tls.ca-file": str(certificate)}):
        yield distributed.Security(require_encryption=True)


def cluster(workers: int, **how: Any) -> Any:
    return distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=False, dashboard_address=None, host="127.0.0.1",
        protocol="tls" if how else "tcp", scheduler_kwargs={"dashboard_address": "127.0.0.1:0"}, **how,
    )  # fmt: skip


def test_tls_works_with_the_certificates_of_dasks_configuration(certificates: Any) -> None:
    with cluster(1, security=certificates) as there:
        assert there.scheduler_address.startswith("tls://")
        with open_executor(there.scheduler_address, 1)() as executor:
            assert executor.submit(max, 1, 2).result() == 2


def test_a_client_that_came_to_nothing_is_gone_with_its_error() -> None:
    """Collected later, in the middle of another call of Dask, it would wait for that call's lock for ever."""
    gc.disable()
    try:
        with pytest.raises(UsageError), open_executor("tls://127.0.0.1:1", 1)():
            pass
        assert not [one for one in gc.get_objects() if isinstance(one, distributed.Client) and one.status != "closed"]
    finally:
        gc.enable()


OTHER = """
import sys
import elbowscrew._version
elbowscrew._version.__version__ = "0.0.1"
from distributed.cli.dask_worker import main
main([sys.argv[1], "--no-nanny", "--no-dashboard", "--nthreads", "1"])
"""


def test_workers_of_other_versions_are_told_and_cost_no_tables(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_simulation(simulate_trial(frames=60, inversion=30), tmp_path / "take.csv")
    common = ["batch", str(tmp_path / "take.csv"), "-o", str(tmp_path / "out"), "--figure-format", "none", "-q"]
    assert main([*common, "--workers", "1"]) == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").glob("*.csv")}
    assert set(before) == {"summary.csv", "failures.csv", "cycles.csv", "repetitions.csv"}
    with cluster(0) as there:
        address = there.scheduler_address
        with subprocess.Popen(
            [sys.executable, "-c", OTHER, address], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as worker:
            try:
                assert main([*common, "--restart", "--scheduler", address, "--wait", "60"]) == 2
            finally:
                worker.terminate()
    assert "the worker has elbowscrew 0.0.1: expected the same versions as here" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").glob("*.csv")} == before


def test_a_cluster_without_workers_is_told_and_waited_for_on_request_alone() -> None:
    with cluster(0) as there:
        with (
            pytest.raises(UsageError, match=r"no worker after 0.1 s; start some, or give --wait SECONDS"),
            open_executor(there.scheduler_address, 1, 0.1)(),
        ):
            pass
        later = threading.Timer(0.5, there.scale, (1,))
        later.start()
        with open_executor(there.scheduler_address, 1, 60.0)() as executor:
            assert executor.submit(max, 1, 2).result() == 2
        later.join()


def test_a_cluster_that_loses_its_workers_for_good_is_not_waited_for(tmp_path: Path) -> None:
    tasks = [Hazard(f"t{index}", "", str(tmp_path)) for index in range(8)]
    done: list[int] = []
    with cluster(1) as there:

        def lose_all(index: int, _failure: Failure | None) -> None:
            done.append(index)
            there.scale(0)
            while there.scheduler.workers:
                time.sleep(0.01)

        with pytest.raises(UsageError, match=r"no worker after 0.3 s; start some"):
            run_tasks(tasks, work, open_executor(there.scheduler_address, 1, 0.3), 1, lose_all)
    assert 0 < len(done) < len(tasks)


@pytest.mark.parametrize(("name", "suspected"), [("cfexecutor.py", [3]), ("reader.py", [])])
def test_a_task_that_dask_has_no_word_of_is_tried_again(tmp_path: Path, name: str, suspected: list[int]) -> None:
    """Of a task whose workers are gone its own code fails; the same error of the work itself is told."""
    code = tmp_path / name
    code.write_text("kind, error, trace = None")
    future: Future[Failure | None] = Future()
    try:
        run_path(str(code))
    except TypeError as error:
        future.set_exception(error)
    suspects: list[int] = []
    with nullcontext() if suspected else pytest.raises(UsageError, match="the workers cannot do the work: TypeError"):
        assert not _collect({future: 3}, lambda *_: None, suspects.append)
    assert suspects == suspected
