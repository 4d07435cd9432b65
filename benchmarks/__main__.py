"""Measure, print, and keep: ``python -m benchmarks [--publish] [SUBJECT ...]``, else every subject."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from datetime import date
from importlib import import_module
from inspect import signature
from pathlib import Path
from types import ModuleType

from benchmarks.machine import describe
from benchmarks.marked_section import MEASURED
from benchmarks.page import page, with_figures
from benchmarks.record import Measured, read_record, write_record

ROOT = Path(__file__).parents[1]
_IN_ORDER = """
    reference_errors static_table full_contact_cost full_contact_coverage full_contact_helical
    full_contact_over_face finite_width run_up long_phase other_engine corrected_plane dynamics_cost
    step_cost study_cost accumulated_errors solvers_3d condensation housing_modes gear_case_sound housed_run
    default_run heard_band predictions announced_costs
    predicted_errors predicted_memory receipt_cost error_coverage quiet_meshes live_coverage load_arm_coverage
    limit_coverage derivatives heard_flanks heard_designs heard_tolerances tolerance_kept looser_tolerance
    influence_estimates quiet_helical dynamic_influence_estimates neglected_effects
    deviating_cycles made_pairs live_cost page_redraw page_motion page_memory service_queries
    cluster_rate worker_cost shared_table divided_studies cold_start
"""
SUBJECTS = tuple(_IN_ORDER.split())
"""Modules here, in the order of the page."""


def main(arguments: Sequence[str]) -> int:
    """Run the subjects named, or every one; the status tells whether all targets were met."""
    requested = set(arguments) - {"--publish"}
    if unknown := sorted(requested - set(SUBJECTS)):
        sys.stderr.write(f"{__doc__}\nno subject {', '.join(unknown)}; one of {', '.join(SUBJECTS)}\n")
        return 2
    machine, record = describe(), {}
    for name in [name for name in SUBJECTS if name in requested or not requested]:
        sys.stderr.write(f"{name} ...\n")
        figures = tuple(_module(name).figures())
        record[name] = Measured(date.today().isoformat(), machine, figures)
    print(page(record))
    _keep(record, SUBJECTS)
    if "--publish" in arguments:
        _publish(record, SUBJECTS)
        for name in record:
            _publish_own(_module(name), machine)
    measured = [figure for part in record.values() for figure in part.figures]
    return 0 if all(figure.met is not False for figure in measured) else 1


def _module(name: str) -> ModuleType:
    """Import a subject: `figures`, and perhaps `publish`, of what it `assessed`, for a page of its own."""
    return import_module(f"benchmarks.{name}")


def _publish_own(subject: ModuleType, machine: Mapping[str, str]) -> None:
    if publish := getattr(subject, "publish", None):
        found = {"found": subject.assessed, "machine": lambda: machine}
        publish(*(found[name]() for name in signature(publish).parameters))


def _keep(record: Mapping[str, Measured], order: Sequence[str]) -> None:
    """Write out/bench/bench.md and bench.json."""
    folder = ROOT / "out" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.md").write_text(page(record), encoding="utf-8")
    write_record(folder / "bench.json", record, order)


def _publish(record: Mapping[str, Measured], order: Sequence[str]) -> None:
    """Put the subjects into docs/lab/benchmarks.json; write the page of all and README.md from it."""
    store, readme = ROOT / "docs" / "lab" / "benchmarks.json", ROOT / "README.md"
    write_record(store, {**read_record(store), **record}, order)
    published = read_record(store)
    MEASURED.mkdir(parents=True, exist_ok=True)
    (MEASURED / "benchmarks.md").write_text(page(published), encoding="utf-8")
    readme.write_text(with_figures(readme.read_text(encoding="utf-8"), published), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
