"""A thousand stored tables by `map` of the awaited client, over loopback: rate, CPU time, memory."""

from __future__ import annotations

import asyncio
import shutil
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.example_pair import PAIR, TORQUES
from benchmarks.figures import Figure
from benchmarks.fresh_process import measure
from benchmarks.service_process import cpu_seconds, memory_mb, running
from lineofaction.client import AsyncLineOfActionClient
from lineofaction.gearbox.subjects import case_inputs
from service.page.files import examples
from service.store.places import stored_results
from service.worker.process import ANALYZE

COUNT, CONCURRENCY = 1000, 16
_TABLE = (
    PAIR + 'analyze(pair, torques={torques}, model="plane_strain").to_netcdf({table!r})\nmeasured = {{}}\n'
)


@dataclass(frozen=True)
class _Pass:
    """What a pass over all cases took: seconds elapsed, CPU seconds of both, MB that the client grew by."""

    elapsed: float
    client: float
    service: float
    growth: float


def figures() -> list[Figure]:
    """Store a table under the hashes of a thousand cases; obtain them all, twice."""
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder)
        table = directory / "ste.nc"
        measure(_TABLE.format(torques=list(TORQUES), table=str(table)))
        store = stored_results(directory)
        for case in cases():
            shutil.copyfile(table, directory / "copy.nc")  # the store moves it
            store.put(ANALYZE.key(case_inputs(case)), "database", directory / "copy.nc")
        with running(directory) as (address, process, _):
            passes = asyncio.run(_passes(address, directory / "cache", process.pid))
    names = ("fetched", "in the client's cache")
    return [figure for name, each in zip(names, passes, strict=True) for figure in _figures(name, each)]


def cases() -> Iterator[dict[str, Any]]:
    """Yield a thousand cases that differ in their largest torque."""
    case = examples()[0].content
    for number in range(COUNT):
        yield {**case, "load": {"torque_n_m": [50.0, 100.0 + 0.1 * number]}}


async def _passes(address: str, cache: Path, service: int) -> list[_Pass]:
    """Obtain all tables, first from the service, then from the cache."""
    async with AsyncLineOfActionClient(address, cache_dir=cache) as client:
        async for job in client.analyze.map(list(cases())[:50], concurrency=CONCURRENCY):
            await job.file()  # warms up
        return [await _pass(client, service) for _ in range(2)]


async def _pass(client: AsyncLineOfActionClient, service: int) -> _Pass:
    """Obtain all tables; memory is compared between a fifth of the way and the end."""
    own = Path("/proc/self").resolve().name
    begin = time.perf_counter(), time.process_time(), cpu_seconds(service)
    count, memory = 0, 0.0
    async for job in client.analyze.map(cases(), concurrency=CONCURRENCY):
        assert (await job.file()).is_file()
        count += 1
        memory = memory_mb(int(own)) if count == COUNT // 5 else memory
    end = time.perf_counter(), time.process_time(), cpu_seconds(service)
    elapsed, client_cpu, service_cpu = (after - before for before, after in zip(begin, end, strict=True))
    assert count == COUNT
    return _Pass(elapsed, client_cpu, service_cpu, memory_mb(int(own)) - memory)


def _figures(name: str, each: _Pass) -> Iterator[Figure]:
    """Yield the figures of a pass."""
    subject = f"{COUNT} stored tables by map, {name}"
    yield Figure(subject, "time of one", 1e3 * each.elapsed / COUNT, "ms", 1e3 / 400.0)
    yield Figure(subject, "CPU time of the client for one", 1e3 * each.client / COUNT, "ms")
    yield Figure(subject, "CPU time of the service for one", 1e3 * each.service / COUNT, "ms")
    yield Figure(subject, "growth of the client after a fifth", each.growth, "MB", 5.0)
