"""``loa sensitivity``."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from service.cli.assessed_case import assessed_case
from service.cli.output import check_writable, console, print_json, progress_bar, table
from service.cli.warned import messages, warnings_so_far
from service.convert.sensitivity import Deviations, PairStudy, studies_json, study_case
from service.convert.sensitivity_file import write_studies
from service.convert.stamp import stamp
from service.convert.task_workers import ExecutorChoice, open_executor
from service.directories import cache_home
from service.problems import BadInput
from service.report.image import png
from service.report.inputs import Inputs
from service.report.sensitivity import sensitivity_figure, sensitivity_table
from service.report.write import write_page

_LARGEST_UM, _LARGEST_PERCENT = 10_000.0, 10.0


@dataclass(frozen=True)
class Varied:
    """The values of both options as they were typed: numbers separated by commas."""

    misalignment_um: str
    center_distance_change_percent: str

    @property
    def deviations(self) -> Deviations:
        """The numbers."""
        percent = self.center_distance_change_percent
        return Deviations(
            _numbers("--misalignment-um", self.misalignment_um, _LARGEST_UM),
            _numbers("--center-distance-change-percent", percent, _LARGEST_PERCENT),
        )


def run_sensitivity(
    files: Sequence[Path], output: Path, varied: Varied, executor: ExecutorChoice, *, as_json: bool
) -> None:
    """Study every case, write, print."""
    deviations = varied.deviations
    names = _names(files)
    cases = [assessed_case(file) for file in files]
    targets = _targets(output)
    cache = cache_home() / "compliance"
    with open_executor(executor) as workers, progress_bar() as report:
        studies = [
            study_case(name, case, deviations, cache, report, workers)
            for name, case in zip(names, cases, strict=True)
        ]
    for target in targets:
        target.parent.mkdir(exist_ok=True)
        _WRITERS[target.suffix](studies, target)
        stamp(target, warnings_so_far())
    if as_json:
        print_json({"written": [str(target) for target in targets], **studies_json(studies)})
    else:
        _show(studies, targets)


def _names(files: Sequence[Path]) -> list[str]:
    """Names of the lines: what tells the files apart."""
    names = [file.stem.removeprefix("sensitivity_").replace("_", " ") for file in files]
    return [str(file) for file in files] if len(set(names)) < len(names) else names


def _numbers(option: str, text: str, largest: float) -> tuple[float, ...]:
    """Values of an option, increasing."""
    bound = f"increasing numbers from {-largest:g} to {largest:g}, separated by commas"
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        raise BadInput.of(option, text, bound, "For example 0,30,60.") from None
    inside = all(abs(value) <= largest for value in numbers)  # nan is not
    if not inside or any(b <= a for a, b in pairwise(numbers)):
        raise BadInput.of(option, text, bound, "For example 0,30,60.")
    return numbers


def _targets(output: Path) -> list[Path]:
    """Files to write: one by its ending, or all kinds in a folder, which is made if missing.

    Raises
    ------
    BadInput
        Neither, or not writable.
    """
    endings = ", ".join(_WRITERS)
    if output.is_dir() or not output.suffix:
        check_writable(output / "x" if output.is_dir() else output)
        if output.is_file():
            raise BadInput.of("output", str(output), f"a folder, or a file ending in one of {endings}")
        return [output / f"sensitivity{ending}" for ending in _WRITERS]
    if output.suffix not in _WRITERS:
        raise BadInput.of("output", str(output), f"a folder, or a file ending in one of {endings}")
    check_writable(output)
    return [output]


def _picture(studies: Sequence[PairStudy], target: Path) -> None:
    """PNG."""
    target.write_bytes(png(sensitivity_figure(studies)))


def _page(studies: Sequence[PairStudy], target: Path) -> None:
    """Write the report page."""
    write_page(Inputs(studies=tuple(studies), warnings=tuple(messages())), target)


def _csv(studies: Sequence[PairStudy], target: Path) -> None:
    """One line per pair, model and deviation."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    content = sensitivity_table(studies)
    writer.writerow(content.head)
    writer.writerows(content.rows)
    target.write_text(text.getvalue(), encoding="utf-8")


def _json(studies: Sequence[PairStudy], target: Path) -> None:
    """JSON."""
    text = json.dumps(studies_json(studies), allow_nan=False, indent=1)
    target.write_text(f"{text}\n", encoding="utf-8")


_WRITERS: dict[str, Callable[[Sequence[PairStudy], Path], None]] = {
    ".png": _picture,
    ".csv": _csv,
    ".json": _json,
    ".nc": write_studies,
    ".html": _page,
}


def _show(studies: Sequence[PairStudy], targets: Sequence[Path]) -> None:
    """Print the table for people."""
    out = console()
    content = sensitivity_table(studies)
    out.print(table(content.head, content.rows, content.caption))
    for target in targets:
        out.print(f"written to {target}", highlight=False)
