"""A PostgreSQL server of the tests' own: made from what is installed, on a socket of its own."""

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
import uuid
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psycopg
import pytest
from psycopg import sql

_FAST = (
    "fsync=off",
    "full_page_writes=off",
    "listen_addresses=",
    "max_connections=60",
    "shared_buffers=16MB",
)
_ABSENT = "PostgreSQL is not installed (Debian: apt-get install postgresql); initdb and postgres were sought"


@dataclass
class PostgresServer:
    """A server in a directory; whoever may reach its socket is its superuser."""

    directory: Path
    program: str
    user: Mapping[str, Any]
    _process: subprocess.Popen[bytes] | None = None
    _shared: str | None = None

    @property
    def socket(self) -> Path:
        return self.directory / ".s.PGSQL.5432"

    def start(self) -> None:
        options = [part for setting in _FAST for part in ("-c", setting)]
        with (self.directory / "log").open("ab") as log:
            arguments = [self.program, "-D", str(self.directory / "data"), "-k", str(self.directory)]
            self._process = subprocess.Popen(
                [*arguments, *options], stdout=log, stderr=log, cwd="/", **self.user
            )
        _await(self, self._process)

    def fall(self) -> None:
        """End it at once: no transaction ends, no connection is told (``pg_ctl stop -m immediate``)."""
        self._process.send_signal(signal.SIGQUIT)
        self._process.wait()

    def fall_and_rise(self, after_s: float) -> None:
        """End it at once and start it again after a while: it recovers from its log."""
        self.fall()
        time.sleep(after_s)
        self.start()

    def new_database(self) -> str:
        name = f"loa_{uuid.uuid4().hex[:12]}"
        with self.administration() as connection:
            connection.execute(sql.SQL("CREATE DATABASE {} ENCODING 'UTF8'").format(sql.Identifier(name)))
        return f"postgresql://postgres@/{name}?host={self.directory}"

    def emptied_database(self) -> str:
        """Return the URL of the database that tests share one after the other: its tables have no rows.

        A new one is some 300 files to copy, and to remove at the end.
        """
        if self._shared is None:
            self._shared = migrated(self.new_database())
            return self._shared
        self.end_connections(self._shared)
        with psycopg.connect(self._shared, autocommit=True) as connection:
            found = connection.execute("SELECT tablename FROM pg_tables WHERE schemaname = 'public'")
            tables = [sql.Identifier(name) for (name,) in found if not name.endswith("_version")]
            connection.execute(sql.SQL("TRUNCATE {}").format(sql.SQL(", ").join(tables)))
        return self._shared

    def end_connections(self, url: str) -> int:
        """End all connections to a database as an administrator would; return how many."""
        name = url.rpartition("/")[2] if "?" not in url else url.partition("?")[0].rpartition("/")[2]
        with self.administration() as connection:
            ended = "SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE datname = %s"
            row = connection.execute(ended, (name,)).fetchone()
        return int(row[0])

    @contextmanager
    def administration(self) -> Iterator[psycopg.Connection[Any]]:
        with psycopg.connect(
            f"host={self.directory} user=postgres dbname=postgres", autocommit=True
        ) as found:
            yield found


def program(name: str) -> str | None:
    """Find a program of the server: Debian keeps them off the path."""
    found = sorted(Path("/usr/lib/postgresql").glob(f"*/bin/{name}"))
    return shutil.which(name) or (str(found[-1]) if found else None)


def _other_user() -> dict[str, Any]:
    """Return whom the server runs as: it refuses root."""
    if os.getuid() != 0:
        return {}
    names = {entry.pw_name: entry for entry in pwd.getpwall()}
    entry = names.get("postgres") or names.get("nobody")
    if entry is None:
        pytest.skip("PostgreSQL refuses to run as root, and there is no user postgres or nobody")
    return {"user": entry.pw_uid, "group": entry.pw_gid, "extra_groups": []}


@contextmanager
def running_server() -> Iterator[PostgresServer]:
    """Run a server; skip if none is installed."""
    initdb, postgres = program("initdb"), program("postgres")
    if initdb is None or postgres is None:
        pytest.skip(_ABSENT)
    user = _other_user()
    directory = Path(tempfile.mkdtemp(prefix="loa-pg-"))
    try:
        if user:
            os.chown(directory, user["user"], user["group"])
            directory.chmod(0o711)
        data = directory / "data"
        made = [initdb, "-D", str(data), "-U", "postgres", "-A", "trust", "-E", "UTF8", "--no-sync"]
        subprocess.run(made, check=True, capture_output=True, cwd="/", **user)
        server = PostgresServer(directory, postgres, user)
        try:
            server.start()
            yield server
        finally:
            server.fall()
    finally:
        shutil.rmtree(directory, ignore_errors=True)


def _await(server: PostgresServer, process: subprocess.Popen[bytes]) -> None:
    end = time.monotonic() + 60.0
    while True:
        try:
            with server.administration():
                return
        except psycopg.OperationalError:
            log = (server.directory / "log").read_text(errors="replace")
            assert process.poll() is None, f"PostgreSQL ended: {log}"
            assert time.monotonic() < end, f"PostgreSQL does not answer: {log}"
            time.sleep(0.05)


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    with running_server() as found:
        yield found


@pytest.fixture(params=["sqlite", "postgresql"])
def database_url(request: pytest.FixtureRequest) -> str | None:
    """What the job table and the index are kept in: a file in the data directory, or a server.

    Tests that ask for it run once on each.
    """
    if request.param == "sqlite":
        return None
    server: PostgresServer = request.getfixturevalue("postgres")
    return server.emptied_database()


def migrated(url: str) -> str:
    from service.store.database import Schema, database_engine  # noqa: PLC0415 (skipped tests need none)

    engine = database_engine(url)
    Schema(engine).upgrade()
    engine.dispose()
    return url
