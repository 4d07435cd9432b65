"""Limits of a server within the files that it may open: lowered and said, or refused at the start."""

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from running_service import PATIENCE_S

from lineofaction.gearbox.problems import EXIT_BAD_INPUT, BadInput
from service.access import capacity as of_process
from service.access.capacity import Capacity, capacity


@contextmanager
def serving(directory: Path, files: int) -> Iterator[subprocess.Popen[str]]:
    """Start `loa serve` as a process that may open so many files; its log is in a file."""
    serve = [
        sys.executable,
        "-m",
        "lineofaction.cli",
        "serve",
        "--port",
        "0",
        "--data-directory",
        str(directory),
    ]
    command = ["sh", "-c", f'ulimit -n {files}; exec "$@"', "sh", *serve]
    with (directory / "lines").open("w") as log:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=log, text=True)
        try:
            yield process
        finally:
            process.terminate()
            process.communicate(timeout=PATIENCE_S)


def healthy(port: int, held: ExitStack) -> bool:
    connection = held.enter_context(socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S))
    connection.sendall(b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n")
    answer = b""
    while not answer.endswith(b"}"):
        answer += connection.recv(65536)
    return answer.startswith(b"HTTP/1.1 200 ")


def test_a_start_with_too_few_files_is_refused_by_their_name(tmp_path):
    """It began, and then /health was reset and the log named the database damaged."""
    with serving(tmp_path, 64) as process:
        assert process.wait(PATIENCE_S) == EXIT_BAD_INPUT
    log = (tmp_path / "lines").read_text()
    assert "open files" in log and "64" in log and "ulimit -n" in log
    assert "damaged" not in log


def test_with_few_files_as_many_connections_are_taken_as_they_suffice_for(tmp_path):
    """Beyond them the connections that are idle for longest make room, and every request is answered."""
    with serving(tmp_path, 256) as process, ExitStack() as held:
        port = int(process.stdout.readline().rpartition(":")[2])
        assert all(healthy(port, held) for _ in range(300))
    log = (tmp_path / "lines").read_text()
    assert '"limits lowered"' in log and '"open_files": 256' in log and '"connections": 60' in log
    assert "damaged" not in log


@pytest.mark.parametrize("files", [228, 300, 996, 20_000])
def test_limits_follow_the_number_of_files(files, monkeypatch):
    monkeypatch.setattr(of_process, "max_open_files", lambda: files)
    own = capacity(workers=1)
    assert own.connections == min(files - 196, 800)
    assert 0 < own.share <= own.requests < own.comfortable_connections < own.connections
    assert own == Capacity() or files < 996
    with pytest.raises(BadInput, match="ulimit -n"):
        capacity(workers=files)
