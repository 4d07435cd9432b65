"""The gmsh child: triangles and blocks of quadrilaterals, and what its failures become."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fe_contact.errors import MeshError
from fe_contact.mesh.gmsh_process import WORKER
from fe_contact.mesh.quad_blocks import Block, fill_blocks
from fe_contact.mesh.quadratic_mesh import Region, triangulate

SQUARE = Region((np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),))
RING = Region(
    tuple(
        radius * np.stack([np.cos(t), np.sin(t)], axis=-1)
        for radius, t in (
            (2.0, np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)),
            (1.0, np.linspace(0.0, -2.0 * np.pi, 20, endpoint=False)),
        )
    )
)
SQUARE_SIDES = [
    (np.array(a), np.array(b))
    for a, b in (
        ((0.0, 0.0), (1.0, 0.0)),
        ((1.0, 0.0), (1.0, 1.0)),
        ((1.0, 1.0), (0.0, 1.0)),
        ((0.0, 1.0), (0.0, 0.0)),
    )
]


def area(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def polygon_area(loop: np.ndarray) -> float:
    x, y = loop.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def test_fills_the_polygon_and_keeps_its_points_bit_for_bit():
    (mesh,) = triangulate([RING])
    areas = area(mesh.points, mesh.triangles)
    assert areas.min() > 0.0
    assert areas.sum() == pytest.approx(sum(polygon_area(loop) for loop in RING.loops), rel=1e-12)
    (mesh,) = triangulate([replace(RING, scale=1e-3)])
    given = np.concatenate(RING.loops)
    assert np.array_equal(mesh.points[: len(given)], given)
    edges = {tuple(sorted(e)) for t in mesh.triangles for e in zip(t, np.roll(t, 1), strict=True)}
    assert {(i, i + 1) for i in range(39)} <= edges


@pytest.mark.law
def test_is_deterministic_and_free_of_scale():
    first, again = triangulate([RING, SQUARE])[0], triangulate([SQUARE, RING])[1]
    assert np.array_equal(first.points, again.points)
    assert np.array_equal(first.triangles, again.triangles)
    large = Region(tuple(1024.0 * loop for loop in RING.loops), scale=1024.0)
    (scaled,) = triangulate([large])
    assert np.array_equal(scaled.triangles, first.triangles)
    assert scaled.points == pytest.approx(1024.0 * first.points, rel=1e-14)


def test_growth_thins_the_interior_out_and_clockwise_triangles_are_turned():
    square = np.concatenate([np.linspace(a, b, 40, endpoint=False) for a, b in SQUARE_SIDES])
    slow, fast = (len(triangulate([Region((square,), growth=g)])[0].triangles) for g in (0.05, 0.5))
    assert fast < 0.6 * slow
    code = """print('{"regions": [{"points": [[0,0],[1,0],[1,1],[0,1]], "triangles": [[0,2,1],[0,2,3]]}]}')"""
    (mesh,) = triangulate([SQUARE], command=(sys.executable, "-c", code))
    assert area(mesh.points, mesh.triangles) == pytest.approx([0.5, 0.5])


@pytest.mark.parametrize(
    ("code", "complaint"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "killed by SIGKILL"),
        ("raise ValueError('no license to mesh')", "no license to mesh"),
        ("import sys; sys.exit(3)", "exit code 3"),
        ("print('not json')", "unusable answer"),
        ("print('{}')", "unusable answer"),
        ("print('[1]')", "unusable answer"),
        ("""print('{"regions": [{"points": [[0, 0]], "triangles": []}]}')""", "unusable answer"),
        ("""print('{"error": "boundary crosses itself"}')""", "boundary crosses itself"),
        ("""print('{"error": "MemoryError"}')""", "ran out of memory. Select a coarser level"),
        ("import sys; sys.exit('std::bad_alloc')", "ran out of memory"),
    ],
)
def test_a_failing_child_becomes_a_mesh_error_with_the_reason(code, complaint):
    with pytest.raises(MeshError, match=complaint):
        triangulate([SQUARE], command=(sys.executable, "-c", code))


def test_a_child_that_hangs_is_missing_or_refuses_is_a_mesh_error(tmp_path):
    with pytest.raises(MeshError, match=r"no answer within 0\.2 s"):
        triangulate([SQUARE], seconds=0.2, command=(sys.executable, "-c", "import time; time.sleep(60)"))
    with pytest.raises(MeshError, match="cannot be started"):
        triangulate([SQUARE], command=(str(tmp_path / "absent"),))
    crossed = Region((np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),))
    with pytest.raises(MeshError, match="gmsh"):
        triangulate([crossed])


def test_the_worker_leaves_signal_handlers_as_they_were():
    code = (
        "import runpy, signal, sys\n"
        "def mine(number, frame): pass\n"
        "names = ('SIGTERM', 'SIGHUP', 'SIGPIPE', 'SIGINT')\n"
        "for name in names: signal.signal(getattr(signal, name), mine)\n"
        f"worker = runpy.run_path({str(WORKER)!r})\n"
        "worker['_start_gmsh']()\n"
        "import ctypes\n"
        "action = ctypes.create_string_buffer(1024)\n"
        "libc = ctypes.CDLL(None)\n"
        "for name in names:\n"
        "    libc.sigaction(getattr(signal, name), None, action)\n"
        "    assert int.from_bytes(action.raw[:8], sys.byteorder) > 1, name\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_the_worker_finds_its_modules_where_a_hook_alone_finds_them(monkeypatch):
    paths = [path for path in sys.path if path and Path(path).resolve() != WORKER.parents[2]]
    monkeypatch.setattr(sys, "path", paths)
    (mesh,) = triangulate([SQUARE])
    assert len(mesh.triangles)


def test_the_worker_looks_for_a_library_of_the_system_as_python_does():
    code = (
        "import runpy, sys\n"
        f"worker = runpy.run_path({str(WORKER)!r})\n"
        "sys.modules['ctypes.util'] = worker['_LibrarySearch']('ctypes.util')\n"
        "from ctypes.util import find_library\n"
        "names = [find_library(name) for name in ('c', 'no library of this name')]\n"
        "import ctypes.util\n"
        "assert ctypes.util.__file__\n"
        "assert names == [ctypes.util.find_library('c'), None], names\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


U, V = np.linspace(0.0, 1.0, 6) ** 1.3, np.linspace(0.0, 1.0, 4)


def bent(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.stack([u + 0.2 * v**2, v + 0.3 * u * (1.0 - u)], axis=-1)


BENT = Block(bent(U, 0.0 * U), bent(1.0 + 0.0 * V, V), bent(U, 1.0 + 0.0 * U), bent(0.0 * V, V))
SQUARE_BLOCK = Block(
    *(
        np.array(side, float)
        for side in ([[0, 0], [1, 0]], [[1, 0], [1, 1]], [[0, 1], [1, 1]], [[0, 0], [0, 1]])
    )
)


def arc_share(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    lengths = sum(np.cumsum(np.linalg.norm(np.diff(side, axis=0), axis=1)) for side in (first, second))
    return np.concatenate([[0.0], lengths / lengths[-1]])


def test_is_the_transfinite_interpolation_of_the_sides_bit_for_bit():
    (found,) = fill_blocks([BENT], 1.0)
    u = arc_share(BENT.bottom, BENT.top)[None, :, None]
    v = arc_share(BENT.left, BENT.right)[:, None, None]
    low = (1 - u) * BENT.bottom[0] + u * BENT.bottom[-1]
    high = (1 - u) * BENT.top[0] + u * BENT.top[-1]
    rows, columns = (
        (1 - v) * BENT.bottom + v * BENT.top,
        (1 - u) * BENT.left[:, None] + u * BENT.right[:, None],
    )
    assert found == pytest.approx(rows + columns - (1 - v) * low - v * high, abs=1e-14)
    found, small = fill_blocks([BENT, SQUARE_BLOCK], 0.7)
    assert np.array_equal(found[0], BENT.bottom)
    assert np.array_equal(found[-1], BENT.top)
    assert np.array_equal(found[:, 0], BENT.left)
    assert np.array_equal(found[:, -1], BENT.right)
    assert small.shape == (2, 2, 2)
    turned = Block(BENT.bottom[::-1], BENT.left, BENT.top[::-1], BENT.right)
    one, other = fill_blocks([BENT, turned], 1.0)
    assert other == pytest.approx(one[:, ::-1], abs=1e-14)
    uneven = Block(BENT.bottom, BENT.right, BENT.top[[0, -1]], BENT.left)
    with pytest.raises(MeshError):
        fill_blocks([uneven], 1.0)


@pytest.mark.parametrize(
    ("answer", "cause"),
    [
        ('{"blocks": [[[[0, 0], [1, 0]]]]}', "unusable"),
        ('{"blocks": []}', "unusable"),
        ("{}", "unusable"),
        ('{"error": "no surface"}', "no surface"),
    ],
)
def test_a_useless_answer_is_a_mesh_error(answer, cause):
    with pytest.raises(MeshError, match=cause):
        fill_blocks([SQUARE_BLOCK], 1.0, command=(sys.executable, "-c", f"print('{answer}')"))
