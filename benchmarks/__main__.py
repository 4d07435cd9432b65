"""Measure, print, and keep: ``python -m benchmarks [--publish] [SUBJECT ...]``, else every subject."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path

from benchmarks import (
    bearing_rate,
    client_map,
    cluster_rate,
    cold_start,
    corrected_plane,
    derivatives,
    divided_studies,
    dynamic_influence_estimates,
    dynamics_cost,
    error_coverage,
    event_streams,
    finite_width,
    full_contact_cost,
    full_contact_coverage,
    full_contact_helical,
    full_contact_over_face,
    full_contact_picture,
    gear_case_sound,
    housed_run,
    housing_modes,
    influence_estimates,
    live_coverage,
    load_arm_coverage,
    long_phase,
    neglected_effects,
    other_engine,
    page_redraw,
    point_queries,
    predicted_errors,
    predicted_memory,
    predictions,
    quiet_helical,
    receipt_cost,
    reference_errors,
    run_up,
    service_queries,
    shared_table,
    solvers_3d,
    static_table,
    step_cost,
    study_cost,
    tolerance_kept,
    worker_cost,
)
from benchmarks.machine import describe
from benchmarks.page import page, with_figures
from benchmarks.record import Measured, read_record, write_record

ROOT = Path(__file__).parents[1]
SUBJECTS = (
    reference_errors,
    static_table,
    full_contact_cost,
    full_contact_coverage,
    full_contact_helical,
    full_contact_over_face,
    finite_width,
    run_up,
    long_phase,
    other_engine,
    corrected_plane,
    dynamics_cost,
    step_cost,
    study_cost,
    bearing_rate,
    solvers_3d,
    housing_modes,
    gear_case_sound,
    housed_run,
    predictions,
    predicted_errors,
    predicted_memory,
    receipt_cost,
    error_coverage,
    live_coverage,
    load_arm_coverage,
    derivatives,
    tolerance_kept,
    influence_estimates,
    quiet_helical,
    dynamic_influence_estimates,
    neglected_effects,
    page_redraw,
    service_queries,
    point_queries,
    event_streams,
    client_map,
    cluster_rate,
    worker_cost,
    shared_table,
    divided_studies,
    cold_start,
)


def main(arguments: Sequence[str]) -> int:
    """Run the subjects named, or every one; the status tells whether all targets were met."""
    asked = {word for word in arguments if not word.startswith("--")}
    names = {subject.__name__.rpartition(".")[2]: subject for subject in SUBJECTS}
    if unknown := sorted(asked - set(names)):
        sys.stderr.write(f"no subject {', '.join(unknown)}; one of {', '.join(names)}\n")
        return 2
    machine, record = describe(), {}
    for name in [name for name in names if name in asked or not asked]:
        sys.stderr.write(f"{name} ...\n")
        figures = tuple(names[name].figures())
        record[name] = Measured(date.today().isoformat(), machine, figures)
    print(page(record))
    _keep(record, tuple(names))
    if "--publish" in arguments:
        _publish(record, tuple(names))
        if "error_coverage" in record:
            error_coverage.publish(error_coverage.assessed(), machine, error_coverage.in_full())
        if "full_contact_coverage" in record:
            full_contact_coverage.publish(full_contact_coverage.assessed(), machine)
            full_contact_picture.draw()
        over_face = {
            "full_contact_helical": full_contact_helical.publish,
            "full_contact_over_face": full_contact_over_face.publish,
        }
        for name in over_face.keys() & record.keys():
            over_face[name]()
        if "live_coverage" in record:
            live_coverage.publish(live_coverage.assessed(), machine)
        if "tolerance_kept" in record:
            tolerance_kept.publish(tolerance_kept.assessed())
        if "predicted_errors" in record:
            predicted_errors.publish(predicted_errors.assessed())
        if "influence_estimates" in record:
            influence_estimates.publish(influence_estimates.assessed(), machine)
        if "quiet_helical" in record:
            quiet_helical.publish(quiet_helical.assessed(), machine)
        if "dynamic_influence_estimates" in record:
            dynamic_influence_estimates.publish(dynamic_influence_estimates.assessed(), machine)
    measured = [figure for part in record.values() for figure in part.figures]
    return 0 if all(figure.met is not False for figure in measured) else 1


def _keep(record: Mapping[str, Measured], order: Sequence[str]) -> None:
    """Write out/bench/bench.md and bench.json."""
    folder = ROOT / "out" / "bench"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "bench.md").write_text(page(record), encoding="utf-8")
    write_record(folder / "bench.json", record, order)


def _publish(record: Mapping[str, Measured], order: Sequence[str]) -> None:
    """Put the subjects into docs/lab/benchmarks.json; write benchmarks.md beside it and README.md from it."""
    store, readme = ROOT / "docs" / "lab" / "benchmarks.json", ROOT / "README.md"
    write_record(store, {**read_record(store), **record}, order)
    published = read_record(store)
    (ROOT / "docs" / "lab" / "benchmarks.md").write_text(page(published), encoding="utf-8")
    readme.write_text(with_figures(readme.read_text(encoding="utf-8"), published), encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
