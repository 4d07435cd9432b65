"""Evaluation of measured flanks beside the results that the measuring machine printed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fe_contact.geometry import Gear
from lineofaction.gearbox.inspection.machine_file import machine_file
from lineofaction.gearbox.inspection.machine_judgement import results
from lineofaction.gearbox.inspection.machine_values import value_file
from lineofaction.validation.comparison import Comparison


def printed_results(data: Path, values: str, gear: dict[str, float], digit_um: float) -> Iterator[Comparison]:
    """Yield each printed deviation of a gear whose trace or pitch table is in the curve file."""
    measured = machine_file(data.read_text(encoding="utf-8"), Gear(**gear))  # type: ignore[arg-type]
    computed = dict(results(measured, Gear(**gear)))  # type: ignore[arg-type]
    printed = value_file((data.parent / Path(values).name).read_text(encoding="utf-8")).printed
    for _, figure, flank, tooth, value in (*measured.printed, *printed):
        if (figure, flank, tooth) in computed:
            name = " ".join(str(part) for part in (figure, flank, f"tooth {tooth}" if tooth else "") if part)
            yield Comparison(name, "µm", value, digit_um, computed[figure, flank, tooth])
