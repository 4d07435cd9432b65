"""A rolling upgrade: servers and schedulers of two versions on one database, killed while they are exchanged.

Every job ends: with a result, made by the version whose name it has, or, entered by the older version and not
computed by it, with that version as the reason. At night: once between two numbers of this program, twelve
times from the last published version (out/upgrades.json).
"""

from __future__ import annotations

import io
import json
import random
import signal
import subprocess
import tarfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from postgres_server import running_server
from two_versions import RollingService, Version

ROOT = Path(__file__).resolve().parents[2]
PUBLISHED = "0.2.0"
"""Its schedulers run what any server entered: they are exchanged before its servers."""
SEED = 20261122


@pytest.fixture
def service(tmp_path: Path) -> Iterator[RollingService]:
    """Nothing runs yet but PostgreSQL."""
    settings = {
        "LOA_RESULTS_URL": (tmp_path / "results").as_uri(),
        "LOA_ATTEMPTS": "10",
        "LOA_LEASE_S": "3",
    }
    with running_server() as server:
        found = RollingService(tmp_path, settings | {"LOA_DATABASE_URL": server.new_database()})
        try:
            yield found
        finally:
            found.close()


def exchange(service: RollingService, old: Version, new: Version, chance: random.Random) -> None:
    """Exchange the schema, then servers and schedulers; jobs come and parts are killed meanwhile.

    Schedulers of the published version are exchanged first, those of later ones last.
    """
    service.upgrade(old)
    service.serve(old)
    for _ in range(2):
        service.work(old)
    texts = iter(range(100))

    def disturb() -> None:
        for _ in range(2):
            service.submit(f"case {next(texts)}", chance)
        service.submit(f"case {chance.randrange(3)}", chance)  # known to the one version or the other
        service.kill_one(chance)
        time.sleep(chance.uniform(0.0, 0.5))

    disturb()
    service.upgrade(new)
    disturb()

    def exchange_schedulers() -> None:
        for part in list(service.workers):
            service.work(new)
            service.end(part, chance.choice([signal.SIGTERM, signal.SIGKILL]))
            disturb()

    def exchange_servers() -> None:
        former = service.servers[0]
        service.serve(new)
        disturb()
        service.end(former.part, chance.choice([signal.SIGTERM, signal.SIGKILL]))
        disturb()

    steps = (exchange_servers, exchange_schedulers)
    for step in reversed(steps) if old.number == PUBLISHED else steps:
        step()


def assess(service: RollingService, versions: tuple[Version, Version]) -> dict[str, int]:
    """Check that results are made by the versions that name them, and that only older jobs failed."""
    states = service.ended()
    left = f"failed: The job was entered by version {entered_by(versions[0])}; submit it again."
    assert {state for state in states.values() if not state.startswith("successful")} <= {left}, states
    made = dict.fromkeys((version.number for version in versions), 0)
    for job, text in service.jobs.items():
        if states[job] == left:
            continue
        key, content = service.result(job)
        inputs = {"wish": {"mode": "sign", "text": text, "number": 0.0}}
        names = {version.key(inputs): f"{text} by {version.number}" for version in versions}
        assert names.get(key) == content
        made[content.rpartition(" ")[2]] += 1
    return made


def entered_by(version: Version) -> str:
    """Return the words for a version: the published one writes none down."""
    return "0.2.0 or older" if version.number == PUBLISHED else version.number


def tree_of(revision: str, folder: Path) -> Path:
    """Unpack a revision of the project; skip where its history is not at hand."""
    words = [
        "git",
        "-C",
        str(ROOT),
        "archive",
        revision,
        "service",
        "fe_contact",
        "dynamics",
        "bounds",
        "host",
    ]
    done = subprocess.run(words, check=False, capture_output=True)
    if done.returncode != 0:
        pytest.skip(f"git has no {revision} here")
    with tarfile.open(fileobj=io.BytesIO(done.stdout)) as archive:
        archive.extractall(folder, filter="data")
    return folder


@pytest.mark.nightly
def test_two_versions_share_a_database_while_they_are_exchanged(
    service: RollingService, tmp_path: Path
) -> None:
    versions = (Version.of("1.0.0", ROOT, tmp_path), Version.of("1.1.0", ROOT, tmp_path))
    exchange(service, *versions, random.Random(SEED))
    made = assess(service, versions)
    assert made["1.0.0"] >= 1 and made["1.1.0"] >= 5


@pytest.mark.nightly
@pytest.mark.parametrize("trial", range(12))
def test_the_published_version_is_exchanged(service: RollingService, tmp_path: Path, trial: int) -> None:
    old = Version.of(PUBLISHED, tree_of(PUBLISHED, tmp_path / "old"), tmp_path)
    new = Version.of("999.0.0", ROOT, tmp_path)
    began = time.monotonic()
    exchange(service, old, new, random.Random(SEED + trial))
    made = assess(service, (old, new))
    figures = ROOT / "out" / "upgrades.json"
    known = json.loads(figures.read_text()) if figures.exists() else {}
    figures.parent.mkdir(exist_ok=True)
    known[str(trial)] = {"results by": made, "seconds": round(time.monotonic() - began)}
    figures.write_text(json.dumps(known, indent=1), encoding="utf-8")
