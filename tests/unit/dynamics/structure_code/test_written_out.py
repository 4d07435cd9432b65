"""Code written out for a structure does what compiled loops do, to the last bit."""

from typing import NamedTuple

import numpy as np
import pytest

from dynamics.kernels.by_address import by_address
from dynamics.kernels.compiled import compiled, inner_sums
from dynamics.kernels.routine import routine
from dynamics.structure_code.arithmetic import Unsupported
from dynamics.structure_code.known_parts import Known
from dynamics.structure_code.machine_code import MachineCode
from dynamics.structure_code.machine_code import compiled as machine_code
from dynamics.structure_code.module import Module
from dynamics.structure_code.structure import structure_key


class Plan(NamedTuple):
    """Known numbers."""

    first: np.ndarray
    column: np.ndarray
    weight: np.ndarray
    kind: np.ndarray
    count: int
    rate: float
    on: bool


class Work(NamedTuple):
    """Numbers known at run time."""

    x: np.ndarray
    y: np.ndarray
    block: np.ndarray
    hint: np.ndarray
    ready: np.ndarray


def sample(seed: int) -> tuple[Plan, Work]:
    rng = np.random.default_rng(seed)
    plan = Plan(
        np.array([0, 2, 3, 6]), np.array([0, 3, 1, 0, 2, 3]), rng.normal(size=6), np.array([1, 0, 2]),
        7, 0.3, True,
    )  # fmt: skip
    hints, ready = rng.integers(-5, 6, 4), np.zeros(3, dtype=bool)
    return plan, Work(rng.normal(size=4), np.zeros(8), rng.normal(size=(3, 8)), hints, ready)


@routine
def _weighted(plan: Plan, work: Work, row: int, scale: float) -> tuple[float, float]:
    total, size = 0.0, 0.0
    for entry in range(np.uint64(plan.first[row]), np.uint64(plan.first[row + 1])):
        total += scale * plan.weight[entry] * work.x[np.uint64(plan.column[entry])]
        size = max(size, abs(plan.weight[entry]))
    return total, size


@compiled
def _found(work: Work, minimum: float) -> int:
    for i in range(work.x.size):
        if work.x[i] < minimum:
            continue
        if work.x[i] > 1.0 or (work.hint[i] > 3 and work.x[i] > 0.0):
            return i
    return -1


@compiled
def everything(plan: Plan, work: Work, at: float) -> int:
    """Branches and loops of both kinds, early returns, rows, rests, extremes."""
    for row in range(plan.kind.size):
        work.y[row], size = _weighted(plan, work, row, at)
        if plan.kind[row] == 1:
            work.y[row] -= size
        elif plan.kind[row] == 2 and plan.on:
            work.y[row] *= plan.rate**2
    line = work.block[1]
    for i in range(line.size):
        line[i] = 0.5 * line[i] + work.block[0, i] / 3.0
    steps, value = 0, at
    while value > 0.1 and steps < 9:
        value = 0.6 * value if steps % 2 == 0 else value - 0.05
        steps += 1
        if not 0.0 <= value < 50.0:
            break
    work.y[3] = value
    work.y[4] = min(work.x[0], work.x[1], at)
    work.y[5] = work.hint[0] // 3 + 10 * (work.hint[1] % 4) + work.hint[2] // -2
    for k in range(100):
        if k * k > plan.count * abs(at):
            work.y[6] = k
            break
    for i in range(3):
        work.ready[i] = work.x[i] > 0.0
    work.y[7] = -work.x[-1] if work.ready[1] else +work.x[2]
    return _found(work, -0.5) + steps


def own_code(function, plan: Plan, work: Work) -> MachineCode:
    module = Module()
    module.export(function, {by_address(plan): Known.ALL, by_address(work): Known.DIMENSIONS})
    return MachineCode(machine_code(module))


@pytest.mark.law
def test_all_kinds_of_statements_give_the_bits_of_the_compiled_loop():
    plan, shown = sample(0)
    _weighted.prepare(by_address(plan), by_address(shown))
    code = own_code(everything, plan, shown)
    for seed in range(40):
        for at in (0.0, 0.7, -3.0, 60.0, np.nan):
            weights = sample(seed)[0].weight
            given = plan._replace(weight=weights)  # not known: other weights have the same code
            ours, theirs = sample(seed)[1], sample(seed)[1]
            status = everything(by_address(given), by_address(theirs), at)
            assert code.call("everything", by_address(given), by_address(ours), float(at)) == status
            for one, other in zip(ours, theirs, strict=True):
                np.testing.assert_array_equal(one, other)


@compiled
def not_written_out(plan: Plan, work: Work, at: float) -> int:
    """A known table read where a number at run time says."""
    for k in range(3):
        if work.x[k] > at:
            return _COUNTS[work.hint[k]]
    return 0


_COUNTS = np.array([1, 2, 3])


@inner_sums
def _total(work: Work) -> float:
    total = 0.0
    for i in range(work.x.size):
        total += work.x[i] * work.x[i]
    return total


@compiled
def sums_in_any_order(plan: Plan, work: Work, at: float) -> int:
    """The compiler chooses the order: no second one is equal to the last bit."""
    return int(_total(work) > at)


@pytest.mark.parametrize("function", [not_written_out, sums_in_any_order])
def test_what_cannot_be_equal_is_refused(function):
    with pytest.raises(Unsupported):
        own_code(function, *sample(1))


@routine
def _refused(work: Work) -> float:
    return float(_COUNTS[work.hint[0]])


@routine
def _by_kind(plan: Plan, work: Work, row: int) -> float:
    if plan.kind[row] == 3:
        return _refused(work)
    return work.x[row]


@compiled
def of_kinds(plan: Plan, work: Work, at: float) -> int:
    """Rows of which none is of the kind that cannot be written out."""
    for row in range(plan.kind.size):
        work.y[row] = at * _by_kind(plan, work, row)
    return 0


def test_what_only_other_structures_need_is_left_out():
    plan, shown = sample(2)
    _by_kind.prepare(by_address(plan), by_address(shown))
    ours, theirs = sample(2)[1], sample(2)[1]
    of_kinds(by_address(plan), by_address(theirs), 0.3)
    own_code(of_kinds, plan, shown).call("of_kinds", by_address(plan), by_address(ours), 0.3)
    np.testing.assert_array_equal(ours.y, theirs.y)


def test_the_key_is_that_of_what_is_known():
    plan, _ = sample(3)

    def key(changed, known=Known.ALL):
        return structure_key({by_address(changed): known})

    own = key(plan)
    assert key(plan._replace(weight=plan.weight + 1.0, rate=0.7)) == own
    others = [
        plan._replace(column=plan.column[::-1].copy()),
        plan._replace(count=8),
        plan._replace(on=False),
        plan._replace(weight=np.ones(5)),
    ]
    assert len({own, *map(key, others)}) == 5
    assert len({key(each, Known.DIMENSIONS) for each in (plan, *others[:3])}) == 1
    assert key(plan._replace(weight=np.ones(5)), Known.WIDTHS) == key(plan, Known.WIDTHS)
