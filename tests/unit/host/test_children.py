"""Child processes: messages come as they were sent, whatever came before, and an end has its reason."""

import os
import resource
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import framed_fake_work
import pytest
from hypothesis import given
from hypothesis import strategies as st
from running_service import until

from host.children import child as child_module
from host.children.child import Child
from host.children.frames import LONGEST_HEAD, Frame, FrameBuffer
from host.children.launcher import Launcher, start_child
from host.memory_kills import memory_kills

WORK = "framed_fake_work"
FRAMES = st.lists(st.builds(Frame, st.text(max_size=20), st.binary(max_size=300)), max_size=6)


@pytest.fixture(autouse=True)
def fake_work(monkeypatch):
    """Let children find the module of their work."""
    monkeypatch.setenv("PYTHONPATH", str(Path(framed_fake_work.__file__).parent), prepend=os.pathsep)


@pytest.fixture(params=["started anew", "forked"])
def child(request, tmp_path):
    """A child that answers each order with the same."""
    launcher = Launcher(WORK, [], tmp_path / "warm.log", print)
    launch = partial(launcher.launch, warm_within=60.0)
    with (tmp_path / "log").open("wb") as log:
        made = Child(
            launch if request.param == "forked" else partial(start_child, WORK), log.fileno(), tmp_path
        )
    yield made
    made.end()
    launcher.close()


def test_a_closed_launcher_starts_no_process_even_for_who_waits_in_it(tmp_path, monkeypatch):
    """The launch that waits for a warm process ends at the close; an opened launcher launches again."""
    (tmp_path / "long_to_load.py").write_text("import time\ntime.sleep(600)\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    launcher = Launcher(WORK, ["long_to_load"], tmp_path / "warm.log", print)
    with (tmp_path / "log").open("wb") as log, ThreadPoolExecutor(1) as threads:
        launched = partial(Child, log=log.fileno(), workspace=tmp_path)
        waits = threads.submit(launched, partial(launcher.launch, warm_within=600.0))
        until(lambda: launcher._server is not None)
        warm = launcher._server._process
        time.sleep(0.2)  # it waits by now
        launcher.close()
        assert warm.poll() is not None
        for refused in (waits.result, partial(launched, launcher.launch), launcher.warm_up):
            with pytest.raises(OSError, match="closed"):
                refused()
        assert launcher._server is None
        launcher.open()
        made = launched(partial(launcher.launch, warm_within=0.0))
        assert made.send(Frame("echo", b"again"))
        assert answers(made, 1) == [Frame("echo", b"again")]
        made.end()
        launcher.close()


def answers(child: Child, count: int) -> list[Frame]:
    """Return so many frames that a child sends."""
    frames: list[Frame] = []
    until(lambda: len(frames.extend(child.receive(0.1)) or frames) >= count or child.closed)
    return frames


@given(frames=FRAMES, size=st.integers(1, 64))
def test_frames_come_whole_in_whatever_pieces(frames, size):
    sent = b"".join(frame.head + frame.body for frame in frames)
    buffer = FrameBuffer()
    pieces = [sent[start : start + size] for start in range(0, len(sent), size)]
    assert [frame for piece in pieces for frame in buffer.take(piece)] == frames
    assert (buffer.partial, buffer.broken, buffer.received) == (False, False, len(sent))


@given(frame=st.builds(Frame, st.text(max_size=20), st.binary(max_size=50)), cut=st.integers(1, 40))
def test_a_frame_that_breaks_off_is_none(frame, cut):
    sent = frame.head + frame.body
    buffer = FrameBuffer()
    assert buffer.take(sent[: max(len(sent) - cut, 1)]) == []
    assert buffer.partial


@pytest.mark.parametrize(
    "sent",
    [
        b"\xff\n",
        b"[]\n",
        b'{"kind": "a"}\n',
        b'{"kind": 1, "length": 0}\n',
        b'{"kind": "a", "length": -1}\n',
        b'{"kind": "a", "length": true}\n',
        b" " * LONGEST_HEAD,
    ],
)
def test_nothing_is_read_behind_what_is_no_frame(sent):
    buffer = FrameBuffer()
    first = Frame("first", b"1")
    assert buffer.take(first.head + first.body + sent) == [first]
    assert buffer.take(b"\n" + first.head + first.body) == []
    assert buffer.broken and buffer.partial


def test_orders_and_answers_of_any_size_pass(child):
    sent = [Frame("echo", bytes([number]) * size) for number, size in enumerate((0, 1, 5_000_000))]
    for order in sent:
        assert child.send(order)
        assert answers(child, 1) == [order]
    assert not child.partial


def test_a_child_that_ends_by_itself_says_how(child):
    child.send(Frame("leave", b"3"))
    until(lambda: child.receive(0.1) == [] and child.closed)
    assert child.exits_within(60.0)
    assert not child.send(Frame("echo"))
    ended = child.end()
    assert ended is not None and ended.code == 3
    assert not child.killed_from_outside


def test_a_kill_from_outside_is_told_from_that_of_its_starter(child):
    answers(child, 0)
    os.kill(child.pid, signal.SIGKILL)
    assert child.exits_within(60.0)
    ended = child.end()
    assert ended is not None and ended.code == -signal.SIGKILL
    assert child.killed_from_outside == (memory_kills() is not None)


def test_a_kill_by_its_starter_is_none_from_outside(child):
    ended = child.end()
    assert ended is not None and ended.code == -signal.SIGKILL
    assert not child.killed_from_outside


@pytest.mark.parametrize(("before", "after"), [(0, 1), (None, None)])
def test_a_kill_that_may_be_for_memory_is_none_from_outside(tmp_path, monkeypatch, before, after):
    """The system has killed some process since the start, or does not count."""
    counts = iter([before, after])
    monkeypatch.setattr(child_module, "memory_kills", lambda: next(counts, after))
    with (tmp_path / "log").open("wb") as log:
        made = Child(partial(start_child, WORK), log.fileno(), tmp_path)
    os.kill(made.pid, signal.SIGKILL)
    assert made.exits_within(60.0)
    assert made.end() is not None
    assert not made.killed_from_outside


@pytest.mark.skipif(sys.platform != "linux", reason="descriptors beyond 1023 need a raised limit")
def test_descriptors_beyond_those_of_select_are_heard(tmp_path):
    """A service with many connections has them."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(2048, hard), hard))
    opened = [os.open(os.devnull, os.O_RDONLY) for _ in range(1030)]
    try:
        with (tmp_path / "log").open("wb") as log:
            made = Child(partial(start_child, WORK), log.fileno(), tmp_path)
        try:
            assert made.channel > 1023
            assert made.send(Frame("echo", b"far"))
            assert answers(made, 1) == [Frame("echo", b"far")]
        finally:
            made.end()
    finally:
        for descriptor in opened:
            os.close(descriptor)
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def test_memory_kills_are_those_of_the_own_group_or_of_the_machine(tmp_path):
    proc, groups = tmp_path / "proc", tmp_path / "cgroup"
    assert memory_kills(proc, groups) is None
    (proc / "self").mkdir(parents=True)
    (proc / "vmstat").write_text("pgfault 12\noom_kill 7\n")
    assert memory_kills(proc, groups) == 7
    (proc / "self" / "cgroup").write_text("4:memory:/old\n0::/slice/service\n")
    (groups / "slice" / "service").mkdir(parents=True)
    (groups / "slice" / "service" / "memory.events").write_text("oom 3\noom_kill 2\noom_group_kill 0\n")
    assert memory_kills(proc, groups) == 2
