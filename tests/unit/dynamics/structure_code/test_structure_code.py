"""Runs in code of their own: the bits of ordinary loops, the structure by which it is found, its files."""

import gc
import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from geared_scenes import RPM, gear_pair_scene, square_wave_table, with_mesh
from planetary_scenes import driven_scene, planetary_scene, published_set
from rotors_on_bearings import KINDS, rotor

from dynamics import CoastFlank, Integration, TimeLaw
from dynamics.assembly.assemble import assemble
from dynamics.integrators import code_choice, integrate, static_equilibrium
from dynamics.integrators.march import start_march
from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled
from dynamics.loads import AppliedForce, Unbalance
from dynamics.structure_code.arithmetic import CALLS
from dynamics.structure_code.known_parts import Known
from dynamics.structure_code.machine_code import CodeStore
from dynamics.structure_code.module import Module
from dynamics.structure_code.structure import structure_key

UP = TimeLaw((0.0, 0.01, 0.03), (200.0 * RPM, 900.0 * RPM, 1200.0 * RPM))
ON = {"lateral": "on", "tilt": "on", "axial": "on"}
PUSH = AppliedForce("push", "output", 0.1, (50.0, 20.0, 5.0), course=TimeLaw((0.0, 0.01), (0.0, 1.0)))


def meshes(scene):
    return replace(scene, meshes=tuple(replace(mesh, table=square_wave_table()) for mesh in scene.meshes))


SCENES = {
    "run-up with a coast flank": lambda: with_mesh(
        gear_pair_scene(speed=UP, torque=5.0), coast=CoastFlank(60e-6), damping_ratio=0.03
    ),
    "all freedoms, friction, unbalance": lambda: gear_pair_scene(
        effects=ON | {"friction": "on", "dynamic_misalignment": "on"},
        unbalances=(Unbalance("off", "input", 0.05, 1e-3),),
    ),
    "a force that comes on": lambda: gear_pair_scene(effects=ON, forces=(PUSH,)),
    "a free train": lambda: meshes(planetary_scene(published_set(3))),
    "planets": lambda: meshes(driven_scene(published_set(3), effects=ON | {"gyroscopic": "on"})),
    "balls": lambda: rotor((KINDS["deep groove"],) * 2, gravity=(0.0, -9.81, 0.0)),
    "rollers": lambda: rotor((KINDS["cylindrical"],) * 2, gravity=(0.0, -9.81, 0.0)),
}


@pytest.fixture
def store(tmp_path, monkeypatch):
    found = CodeStore(tmp_path)
    monkeypatch.setattr(code_choice, "_store", lambda: found)
    monkeypatch.setattr(code_choice, "_spent", {})
    monkeypatch.setattr(code_choice, "_expressions", {})
    return found


def system_of(scene):
    settings = Integration("explicit", step_limit=4_000)
    return assemble(replace(scene, integration=settings, duration=0.02, on_violation="report"))


def run(system, monkeypatch, worthwhile):
    monkeypatch.setattr(code_choice, "WORTHWHILE", worthwhile)
    monkeypatch.setattr(code_choice, "SEEN", min(worthwhile, code_choice.SEEN))
    return integrate(system, static_equilibrium(system), system.scene.integration)


def parts(trajectory):
    figures = vars(trajectory.figures).values()
    return [trajectory.work, trajectory.count, trajectory.stored, *trajectory.states, *figures]


DAILY = ("run-up with a coast flank", "all freedoms, friction, unbalance", "balls")


@pytest.mark.law
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.nightly] * (name not in DAILY)) for name in SCENES],
)
def test_a_run_is_that_of_ordinary_loops_to_the_last_bit(name, store, monkeypatch):
    system = system_of(SCENES[name]())
    ordinary = run(system, monkeypatch, math.inf)
    own = run(system, monkeypatch, 0.0)  # from its second block on
    again = run(system, monkeypatch, math.inf)
    assert store.get(key_of(system)) is not None
    assert ordinary.count[2] > 100
    for trajectory in (own, again):
        assert trajectory.status is ordinary.status
        for one, other in zip(parts(ordinary), parts(trajectory), strict=True):
            np.testing.assert_array_equal(one, other)


def key_of(system):
    return structure_key(structure_of(system))


def structure_of(system):
    return start_march(system, static_equilibrium(system), system.scene.integration).structure


def test_numbers_do_not_change_the_structure_and_entries_do():
    pair = gear_pair_scene()
    key = key_of(system_of(pair))
    assert key_of(system_of(gear_pair_scene(torque=80.0))) == key
    assert key_of(system_of(with_mesh(pair, damping_ratio=0.02))) == key
    assert key_of(system_of(gear_pair_scene(speed=UP))) != key
    assert key_of(system_of(replace(pair, bushings=pair.bushings[:3]))) != key


def test_arrays_that_overlap_have_no_structure():
    system = system_of(gear_pair_scene())
    work = start_march(system, static_equilibrium(system), system.scene.integration).work
    both = np.zeros(2 * work.q.size)
    shifted = work._replace(q=both[: work.q.size], v=both[1 : work.q.size + 1])
    assert structure_key({by_address(work): Known.DIMENSIONS}) is not None
    assert structure_key({by_address(shifted): Known.DIMENSIONS}) is None


def test_a_law_that_is_not_written_out_leaves_ordinary_loops(store, monkeypatch):
    system = system_of(gear_pair_scene())
    ordinary = run(system, monkeypatch, math.inf)
    monkeypatch.delitem(CALLS, math.floor)
    refused = run(system, monkeypatch, 0.0)
    assert code_choice._expressions == {key_of(system): math.inf}
    np.testing.assert_array_equal(refused.states.filtered, ordinary.states.filtered)


def test_code_is_made_after_as_long_as_it_takes_and_sooner_when_seen_before(store, monkeypatch):
    system = system_of(gear_pair_scene())
    key = key_of(system)
    run(system, monkeypatch, math.inf)
    assert not store.seen(key)  # too short to be noted
    monkeypatch.setattr(code_choice, "MIN", 0.0)
    run(system, monkeypatch, math.inf)
    assert store.seen(key)
    assert store.get(key) is None
    monkeypatch.setattr(code_choice, "SECONDS_PER_EXPRESSION", 0.0)
    run(system, monkeypatch, math.inf)
    assert store.get(key) is not None


class Count(NamedTuple):
    number: np.ndarray


@compiled
def doubled(count: Count, by: float) -> int:
    """Return twice the number and `by`."""
    return int(2.0 * count.number[0] + by)


def module():
    count = by_address(Count(np.array([3.0])))
    found = Module()
    found.export(doubled, {count: Known.DIMENSIONS})
    return found, count


@pytest.mark.parametrize("damage", [lambda data: data[:-7], lambda data: b"\0" * len(data), lambda data: b""])
def test_a_damaged_file_is_no_code(damage, tmp_path):
    written, count = module()
    CodeStore(tmp_path).add("key", written)
    (file,) = tmp_path.iterdir()
    assert CodeStore(tmp_path).get("key").call("doubled", count, 1.0) == 7
    file.write_bytes(damage(file.read_bytes()))
    assert CodeStore(tmp_path).get("key") is None
    assert CodeStore(tmp_path).seen("key")


def test_a_folder_that_cannot_be_written_costs_the_file_alone(tmp_path):
    written, count = module()
    nowhere = CodeStore(tmp_path / "gone")
    nowhere.note("key")
    assert nowhere.add("key", written).call("doubled", count, 2.0) == 8
    assert nowhere.get("key") is not None
    assert not (tmp_path / "gone").exists()


def test_code_lasts_as_long_as_somebody_holds_it(tmp_path, monkeypatch):
    monkeypatch.setattr("dynamics.structure_code.machine_code.MAX_IN_MEMORY", 1)
    store = CodeStore(tmp_path)
    held = [
        (store.add(f"key {k}", written), count)
        for k, (written, count) in enumerate(module() for _ in range(3))
    ]
    gc.collect()
    assert [code.call("doubled", count, float(k)) for k, (code, count) in enumerate(held)] == [6, 7, 8]


def test_files_and_code_in_memory_stay_few(store, monkeypatch, tmp_path):
    monkeypatch.setattr("dynamics.structure_code.machine_code.MAX_IN_FILES", 3)
    for k in range(6):
        store.note(f"{k:040d}")
    assert len(list(tmp_path.iterdir())) == 3
    assert store.seen(f"{5:040d}")
