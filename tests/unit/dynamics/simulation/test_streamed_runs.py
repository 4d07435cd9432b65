"""Runs streamed to a file: the same bits as in memory, however often cancelled, killed and resumed."""

import math
import signal
import subprocess
import sys
import time
import tracemalloc
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from flexible_scenes import flexible_pair
from geared_scenes import RPM, gear_pair_scene
from planetary_scenes import planetary_scene, published_set

from dynamics import CoastFlank, Integration, Outputs, RunResult, TimeLaw, simulate, simulate_to_file
from dynamics.assembly.assemble import assemble
from dynamics.errors import InputError, ResultError, SolveError
from dynamics.integrators import static_equilibrium
from dynamics.integrators.checkpoints import leaves_of, read_checkpoint, restore, write_checkpoint
from dynamics.integrators.march import start_march
from dynamics.integrators.state_sink import BLOCK
from dynamics.simulation import interrupted_run
from dynamics.types import RunStatus

FAKES = Path(__file__).parents[3] / "fakes"


def run_up(duration=0.2, **changes):
    return gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=duration, **changes)


def free_planets():
    """A train without a drive: its rotation is moved into counted quanta. Many samples: several blocks."""
    scene = planetary_scene(published_set(3), duration=0.02)
    return replace(scene, outputs=Outputs(sample_rate=2.5 * BLOCK / 0.02, displacements=True))


def with_backlash():
    scene = run_up(0.1)
    coast = CoastFlank(backlash=2e-6, thickness=0.5)
    meshes = (replace(scene.meshes[0], coast=coast),)
    return replace(scene, meshes=meshes, effects={"backlash": "on"}, outputs=Outputs(displacements=True))


SCENES = {
    "run-up": lambda: replace(run_up(), outputs=Outputs(displacements=True)),
    "free planets": free_planets,
    "backlash": with_backlash,
    "flexible shafts": lambda: flexible_pair(gear=0.07, duration=0.05, outputs=Outputs(displacements=True)),
    "explicit": lambda: replace(run_up(0.05), integration=Integration(method="explicit")),
    "measured error": lambda: replace(run_up(0.05), integration=Integration(estimate_error=True)),
}


def assert_same(first: RunResult, second: RunResult) -> None:
    """Every bit but the times it took."""
    for entry in fields(RunResult):
        one, other = getattr(first, entry.name), getattr(second, entry.name)
        if isinstance(one, np.ndarray):
            assert one.shape == other.shape, entry.name
            assert one.tobytes() == other.tobytes(), entry.name
        elif entry.name == "receipt":
            assert one["seconds"].keys() == other["seconds"].keys()
            assert one["error"]["time_step"]["rms"] == pytest.approx(
                other["error"]["time_step"]["rms"], rel=1e-12, abs=0.0
            )
        else:
            assert one == other, entry.name


def after(blocks):
    """Cancel after that many blocks."""
    left = iter(range(blocks - 1))
    return lambda: next(left, None) is None


def in_pieces(scene, path, blocks):
    """Cancel after every so many blocks, resume, count the pieces."""
    for piece in range(1, 1000):
        status = simulate_to_file(scene, path, resume=piece > 1, cancel=after(blocks))
        if status is not RunStatus.CANCELLED:
            return status, piece
    raise AssertionError("never ended")


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("name", SCENES)
def test_a_run_in_pieces_is_the_run_in_memory_bit_by_bit(name, tmp_path):
    scene = SCENES[name]()
    status, pieces = in_pieces(scene, tmp_path / "run.nc", 7)
    assert status is RunStatus.COMPLETED
    assert pieces > 5
    assert_same(RunResult.from_netcdf(tmp_path / "run.nc"), simulate(scene))
    assert [file.name for file in tmp_path.iterdir()] == ["run.nc"]


def test_a_cancelled_run_says_so_and_holds_the_beginning_of_the_whole(tmp_path):
    whole = simulate(run_up())
    status = simulate_to_file(run_up(), tmp_path / "run.nc", cancel=after(21))
    part = RunResult.from_netcdf(tmp_path / "run.nc")
    assert status is part.status is RunStatus.CANCELLED
    assert 0.3 * whole.time.size < part.time.size < 0.6 * whole.time.size
    np.testing.assert_array_equal(part.contact, whole.contact[:, : part.time.size])
    known = slice(0, part.time.size - math.ceil(part.receipt["sampling"]["edge"] * part.sample_rate))
    np.testing.assert_array_equal(part.mesh_force[:, known], whole.mesh_force[:, known])
    assert part.energy.relative_to_throughput < 1e-7
    assert interrupted_run(tmp_path / "run.nc").is_dir()


def test_a_run_in_memory_can_be_cancelled():
    with pytest.raises(SolveError, match="cancelled at") as stopped:
        simulate(run_up(), cancel=after(21))
    assert stopped.value.partial.status is RunStatus.CANCELLED
    assert stopped.value.partial.time[-1] == pytest.approx(0.084, rel=0.05)


_CHILD = """
import sys, time
from pathlib import Path
sys.path.insert(0, {fakes!r})
from flexible_scenes import flexible_pair
from geared_scenes import RPM, gear_pair_scene
from dynamics.loads.time_law import TimeLaw
from dynamics.simulation import simulate_to_file
scene = gear_pair_scene(speed=TimeLaw.ramp(0.0, 955.0 * RPM, 0.2), duration=0.2)
states, checkpoint = (Path({folder!r}) / name for name in ("run.states", "run.checkpoint"))
def hold(*_):
    while checkpoint.exists() and states.stat().st_size >= 500 * 8 * 12:
        time.sleep(1.0)  # until killed
simulate_to_file(scene, {path!r}, progress=hold, checkpoint_every=0.0)
"""


@pytest.mark.law
def test_a_killed_run_resumes_to_the_same_file(tmp_path):
    path, folder = tmp_path / "run.nc", interrupted_run(tmp_path / "run.nc")
    code = _CHILD.format(fakes=str(FAKES), path=str(path), folder=str(folder))
    child = subprocess.Popen([sys.executable, "-c", code])
    states, checkpoint = folder / "run.states", folder / "run.checkpoint"
    while not checkpoint.exists() or states.stat().st_size < 500 * 8 * 12:
        assert child.poll() is None
        time.sleep(0.02)
    child.send_signal(signal.SIGKILL)
    child.wait()
    assert not path.exists()
    _, facts = read_checkpoint(checkpoint)
    assert 0 < facts["samples"] < 4001
    with states.open("ab") as file:
        file.write(b"half a record")
    assert simulate_to_file(run_up(), path, resume=True) is RunStatus.COMPLETED
    assert_same(RunResult.from_netcdf(path), simulate(run_up()))


@pytest.mark.law
def test_memory_does_not_grow_with_duration(tmp_path):
    def peak(duration):
        scene = replace(run_up(duration), outputs=Outputs(sample_rate=200e3, displacements=True))
        tracemalloc.start()
        simulate_to_file(scene, tmp_path / "run.nc")
        _, maximum = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return maximum

    peak(0.05)
    short, long = peak(0.2), peak(0.8)
    stored = 0.6 * 200e3 * 8 * 50  # bytes of what the longer one has more
    assert long - short < 0.02 * stored


def test_a_checkpoint_holds_every_array_of_the_workspace(tmp_path):
    system = assemble(with_backlash())
    start = static_equilibrium(system)
    work, other = (start_march(system, start, system.scene.integration).work for _ in range(2))
    random = np.random.default_rng(1)
    for _, array in leaves_of(work):
        array[...] = random.integers(0, 2 if array.dtype == bool else 100, array.shape)
    write_checkpoint(tmp_path / "c", work, samples=3)
    arrays, facts = read_checkpoint(tmp_path / "c")
    restore(other, arrays, tmp_path / "c")
    for (name, one), (_, two) in zip(leaves_of(work), leaves_of(other), strict=True):
        np.testing.assert_array_equal(one, two, name)
    assert "local.hint" in dict(leaves_of(work))
    assert int(facts["samples"]) == 3


def test_a_checkpoint_of_another_scene_or_a_damaged_one_is_refused(tmp_path):
    path = tmp_path / "run.nc"
    simulate_to_file(run_up(), path, cancel=lambda: True)
    with pytest.raises(ResultError, match="another scene"):
        simulate_to_file(run_up(torque=101.0), path, resume=True)
    checkpoint = interrupted_run(path) / "run.checkpoint"
    checkpoint.write_bytes(checkpoint.read_bytes()[:1000])
    with pytest.raises(ResultError, match="not a readable checkpoint"):
        simulate_to_file(run_up(), path, resume=True)
    assert simulate_to_file(run_up(), path) is RunStatus.COMPLETED


def test_two_processes_do_not_write_one_file(tmp_path):
    path, seen = tmp_path / "run.nc", []

    def second(_fraction, _text):
        with pytest.raises(InputError, match="another process"):
            simulate_to_file(run_up(), path)
        seen.append(True)

    simulate_to_file(run_up(0.01), path, progress=lambda *facts: seen or second(*facts))
    assert seen


def test_a_run_that_diverges_writes_what_it_has(tmp_path):
    scene = replace(run_up(), integration=Integration(step_limit=200))
    assert simulate_to_file(scene, tmp_path / "run.nc") is RunStatus.STEP_LIMIT
    with pytest.raises(SolveError) as stopped:
        simulate(scene)
    assert_same(RunResult.from_netcdf(tmp_path / "run.nc"), stopped.value.partial)


def test_a_large_scene_fits_into_the_attributes(tmp_path):
    result = simulate(run_up(0.001))
    large = replace(result, case={**result.case, "remark": "x" * 300_000})
    large.to_netcdf(tmp_path / "run.nc")
    assert RunResult.from_netcdf(tmp_path / "run.nc").case == large.case


def test_running_a_scene_needs_no_xarray():
    code = "import sys, dynamics.simulation; print(sorted({'xarray', 'pandas'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
