"""Errors of meshes in quiet helical pairs: drawn pairs on two levels against finer solutions."""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, fields, replace
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.figures import Figure
from benchmarks.quiet_drives import FLANKS, QuietDrive, quiet_drive
from fe_contact.analysis.estimates.relieved_helical import REMAINDER, mean_of_limit, ripple_of_limit
from fe_contact.analysis.pairs.operating_points import operating_points
from fe_contact.analysis.pairs.pair_contact import PairContact, pair_contact
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.contact import ContactSolution
from fe_contact.options import TableAxes
from fe_contact.planning.discretization import face_discretization
from fe_contact.planning.plan import Plan
from fe_contact.ste.curve_quantities import PEAK_TO_PEAK, quantity_changes
from fe_contact.types import FloatArray, Json

SUBJECT = "meshes of quiet helical pairs against finer ones"
RECORD = Path(__file__).parents[1] / "docs" / "lab" / "quiet_meshes.csv"
PAIRS, POSITIONS, COVERAGE = 7, 48, 95.0
MORE_LAYERS = 1.3
"""Layers of the mesh fine over those of the mesh standard from which it tells what the latter leaves."""
FINE = (1,)
"""Pairs that are solved on it, 60 CPU s each; the limit of drafts is that of the mesh standard."""
LEVELS, NM = ("draft", "medium", "standard"), 1e-9


@dataclass(frozen=True)
class MeshRow:
    """One curve on one mesh, lengths in nm."""

    pair: str
    flanks: int
    load: int
    level: str
    slices: int
    mean: float
    added: float
    """Share of the mean that the load adds."""
    ripple: float
    by_mesh: float
    by_patches: float
    """`by_mesh`, `by_patches`: Remainder at second order of the mean change by mesh and by patches."""
    half_ripple: float
    """Remainder at second order of half the peak-to-peak of the change by the mesh."""
    patch_ripple: float
    slice_ripple: float
    """`patch_ripple`, `slice_ripple`: Errors of peak-to-peak by patches and by slices, as stated."""
    mean_missing: float
    ripple_missing: float
    """`mean_missing`, `ripple_missing`: Of the limit less this curve: exact meshes, and of the ripple the
    most slices.
    """

    @property
    def stated_mean(self) -> float:
        """The stated error of the mean by meshes and patches."""
        signed, doubt = mean_of_limit(REMAINDER[self.level], self.by_mesh, self.by_patches)
        return float(abs(signed) + doubt)


def stated_ripples(rows: Sequence[MeshRow]) -> FloatArray:
    """Return the stated errors (n,) of peak-to-peak by meshes, patches and slices, nm."""
    curves: dict[tuple[str, int, str], list[int]] = {}
    for number, row in enumerate(rows):
        curves.setdefault((row.pair, row.flanks, row.level), []).append(number)
    stated = np.empty(len(rows))
    for numbers in curves.values():
        loads = [rows[number] for number in numbers]
        half, added = (np.array([getattr(row, name) for row in loads]) for name in ("half_ripple", "added"))
        by_mesh = ripple_of_limit(REMAINDER[loads[0].level], half, added)
        others = np.array([np.hypot(row.patch_ripple, row.slice_ripple) for row in loads])
        stated[numbers] = np.hypot(by_mesh, others)
    return stated


def figures() -> list[Figure]:
    """Return how often the stated errors miss, and by how much they exceed the true ones."""
    rows = recorded()
    known = {row.pair for row in rows}
    for number in range(PAIRS):
        drive = quiet_drive(number)
        if drive.name not in known:
            sys.stderr.write(f"  {drive.name}\n")
            rows += list(measured(drive, finer=number in FINE))
            write_record(rows)
    return [figure for level in LEVELS for figure in _figures([row for row in rows if row.level == level])]


def _figures(rows: Sequence[MeshRow]) -> Iterator[Figure]:
    stated_mean = np.array([row.stated_mean for row in rows])
    for name, stated in (("mean", stated_mean), ("ripple", stated_ripples(rows))):
        true = np.array([abs(getattr(row, f"{name}_missing")) for row in rows])
        missed = 100.0 * float(np.mean(true > stated))
        ratio = float(np.median(stated / np.maximum(true, 1e-5 * np.array([row.mean for row in rows]))))
        title = f"{rows[0].level}, {name}"
        yield Figure(SUBJECT, f"{title}: not covered, of {true.size}", missed, "%", 100.0 - COVERAGE)
        yield Figure(SUBJECT, f"{title}: median stated over true", ratio, "times")
        yield Figure(SUBJECT, f"{title}: largest stated", float(stated.max()), "nm")


@cache
def _recorded() -> tuple[MeshRow, ...]:
    if not RECORD.exists():
        return ()
    kinds = {field.name: field.type for field in fields(MeshRow)}
    convert = {"str": str, "int": int, "float": float}
    with RECORD.open(encoding="utf-8", newline="") as file:
        return tuple(
            MeshRow(**{name: convert[str(kinds[name])](text) for name, text in line.items()})
            for line in csv.DictReader(file)
        )


def recorded() -> list[MeshRow]:
    """Return the rows of the record."""
    return list(_recorded())


def write_record(rows: Sequence[MeshRow]) -> None:
    """Write the record, lengths to a tenth of a nm."""
    with RECORD.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(MeshRow)], lineterminator="\n")
        writer.writeheader()
        for row in rows:
            values = asdict(row).items()
            writer.writerow({name: f"{x:.1f}" if isinstance(x, float) else x for name, x in values})


def measured(drive: QuietDrive, *, finer: bool) -> Iterator[MeshRow]:
    """Solve a pair on both levels and their coarse meshes, and on what stands for the limit."""
    requests = [
        check_request(pair, TableAxes(normal_forces=drive.loads, misalignments=(skew,)))
        for pair, skew in zip(drive.pairs, drive.misalignments, strict=True)
    ]
    solved = {level: _solved(requests, requests[0].plan(level)) for level in LEVELS}
    # patches of the coarse mesh of the level fine are those of the mesh standard, which is two thirds as fine
    for level in LEVELS[:-1]:
        yield from _rows(drive.name, level, solved[level], solved["standard"])
    if finer:
        plan = requests[0].plan("fine")
        few, many = (
            face_discretization(drive.pairs[0], level).recipes[0].layers for level in ("standard", "fine")
        )
        assert many >= MORE_LAYERS * few
        fine = _solved(requests, plan, solved["standard"].table)
        yield from _rows(drive.name, "standard", solved["standard"], fine)


@dataclass(frozen=True)
class _Curves:
    """Curves (P, flanks x loads) in m of one level."""

    plan: Plan
    level: str
    table: FloatArray
    patched: FloatArray
    coarse: FloatArray
    sliced: FloatArray
    many_slices: FloatArray
    no_load: FloatArray
    """Mean without load (flanks x loads)."""

    @property
    def left(self) -> tuple[FloatArray, FloatArray]:
        """Remainder at second order of the changes by the mesh and by the patches."""
        made = self.plan.discretization
        by_mesh = made.remaining * (self.patched - self.coarse)
        return by_mesh, self.plan.remaining_patches * (self.table - self.patched)

    def limit(self, table: FloatArray) -> FloatArray:
        """Return curves of other slices with what is left of them added, by its sign."""
        remainder = REMAINDER[self.level]
        by_mesh, by_patches = self.left
        return np.asarray(table + remainder.mesh * by_mesh + remainder.patches * by_patches)


def _solved(requests: Sequence[Checked], plan: Plan, coarse: FloatArray | None = None) -> _Curves:
    """Solve a pair on one level; `coarse` has the curves on a coarser mesh if they are known."""
    pair, made = requests[0].request.pair, plan.discretization
    body = pair_contact(pair, plan, None)
    if coarse is None:
        coarse = _curves(requests, pair_contact(pair, plan, None, coarse=True))
    in_slices = (body.in_slices(count) for count in (made.coarse_slices, 2 * made.slices + 1))
    sliced, many_slices = (_curves(requests, contact) for contact in in_slices)
    table, patched = (_curves(requests, contact) for contact in (body, body.in_coarse_patches))
    level = plan.level if plan.level in REMAINDER else "standard"
    no_load = np.repeat([_no_load(checked, body) for checked in requests], requests[0].request.load.size)
    return _Curves(plan, level, table, patched, coarse, sliced, many_slices, no_load)


def _no_load(checked: Checked, contact: PairContact) -> float:
    """Return the mean transmission error without load, m."""
    return float(_solution(checked, contact).no_load.mean())


def _solution(checked: Checked, contact: PairContact) -> ContactSolution:
    request = checked.request
    on_flanks = replace(contact, pair=request.pair, touches={})  # the assembled compliance stays
    (place,) = operating_points(request.scene, request.choices, on_flanks).places
    return place.solve(np.arange(POSITIONS) / POSITIONS, request.load)[1]


def _curves(requests: Sequence[Checked], contact: PairContact) -> FloatArray:
    return np.concatenate([_solution(checked, contact).deflection for checked in requests], axis=1)


def _rows(name: str, level: str, curves: _Curves, limit: _Curves) -> Iterator[MeshRow]:
    by_mesh, by_patches = curves.left
    position, made = np.arange(POSITIONS) / POSITIONS, curves.plan.discretization
    left = made.remaining_slices * (curves.table - curves.sliced)
    by_slices = quantity_changes(position, curves.table + left, curves.table, 1)[PEAK_TO_PEAK]
    patched = quantity_changes(position, curves.table + by_patches, curves.table, 1)[PEAK_TO_PEAK]
    exact, sliced = limit.limit(limit.table), limit.limit(limit.many_slices)
    for c in range(curves.table.shape[1]):
        own = curves.table[:, c]
        lengths: Json = {
            "mean": own.mean(),
            "added": own.mean() - curves.no_load[c],
            "ripple": np.ptp(own),
            "by_mesh": by_mesh[:, c].mean(),
            "by_patches": by_patches[:, c].mean(),
            "half_ripple": 0.5 * np.ptp(by_mesh[:, c]),
            "patch_ripple": patched[c],
            "slice_ripple": by_slices[c],
            "mean_missing": exact[:, c].mean() - own.mean(),
            "ripple_missing": np.ptp(sliced[:, c]) - np.ptp(own),
        }
        places = divmod(c, curves.table.shape[1] // FLANKS)  # flanks, load
        yield MeshRow(name, *places, level, made.slices, **_in_nm(lengths))


def _in_nm(lengths: Json) -> Json:
    return {name: float(length) / NM for name, length in lengths.items()}
