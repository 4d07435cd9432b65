"""Record full finite-element contact: `python -m benchmarks.full_contact_records [CASE [POSITIONS]]`.

Without a case it solves the pairs of `PAIRS` and writes the records that come with the accuracy study. With
one it prints the accuracy study of the case beside full contact at a number of positions, 4 by default.
"""

from __future__ import annotations

import json
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.studies.frontier import Frontier, frontier
from fe_contact.analysis.studies.full_contact_record import RECORDS, FullContactRecord
from lineofaction.cli.output import print_parts
from lineofaction.gearbox.convert.case import study_options
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.schemas.case import Case
from lineofaction.report.effects.frontier import PAGE
from verification.full_contact_record import full_contact_refusal, record_full_contact

EXAMPLES = Path(__file__).parents[1] / "examples"
PAIRS = ("palermo_spur_20_20", "industrial_spur_21_59", "planetary_sun_planet", "internal_gear")
"""Examples whose pairs are recorded, under the loads of their cases."""
POSITIONS = 16


def write_records() -> None:
    """Solve the pairs and write their records, a line each."""
    records = [recorded(requested(EXAMPLES / f"{name}.toml"), POSITIONS) for name in PAIRS]
    lines = ",\n".join(json.dumps(record.to_json()) for record in records)
    RECORDS.write_text(f"[\n{lines}\n]\n", encoding="utf-8")


def print_study(case: Path, positions: int) -> None:
    """Print the accuracy study of a case, with full contact solved for it."""
    checked = requested(case)
    study = frontier(checked, full_contact=positions, records=[recorded(checked, positions)])
    print_parts(PAGE.text(study))


def requested(file: Path) -> Checked:
    """Return the request of the accuracy study of a case file."""
    case = CheckedCase(Case.model_validate(tomllib.loads(file.read_text("utf-8"))))
    return Frontier.request(case.pair, replace(case.axes, pitches=None), study_options(case.options))


def recorded(checked: Checked, positions: int) -> FullContactRecord:
    """Return the record of a request; ends with the reason where full contact does not hold its pair."""
    if (reason := full_contact_refusal(checked)) is not None:
        sys.exit(f"full contact does not hold this case: {reason}")
    return record_full_contact(checked, positions, _told)


def _told(done: float) -> None:
    sys.stderr.write(f"\r{done:4.0%}")


if __name__ == "__main__":
    case, *rest = sys.argv[1:] or [""]
    if case:
        print_study(Path(case), int(rest[0]) if rest else 4)
    else:
        write_records()
