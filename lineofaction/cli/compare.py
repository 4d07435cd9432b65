"""``loa compare``: pages that compare two results, designs or flanks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bounds.types import Json
from lineofaction.cli.output import check_writable, console, print_json
from lineofaction.cli.run_study import run_study
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.number_list import number_list
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import file_of
from lineofaction.gearbox.registry import STUDIES
from lineofaction.gearbox.schemas import Case, read_model, read_table, validated
from lineofaction.report.comparison.compare import compare
from lineofaction.report.comparison.recorded import Measurement
from lineofaction.report.document import write_page
from lineofaction.report.run.view import RunView


@dataclass(frozen=True)
class FlankQuestion:
    """Arguments of ``loa compare BEFORE AFTER --scene SCENE`` as the caller typed them."""

    scene: Path
    mesh: str | None
    tolerances: Path | None
    load_cases: Path | None
    speed_rpm: str | None
    requirement_db: float | None


def run_compare_flanks(
    files: Sequence[Path], question: FlankQuestion, output: Path, *, as_json: bool
) -> None:
    """Run the study of a change of flanks.

    `files` are the case files before and after, or the one after, which is then compared with the case of the
    scene. Tolerances and load cases are read from the files of the question.
    """
    if len(files) > 2:
        bound = (
            "the case files of the flanks before and after, or of those after alone: before are the scene's"
        )
        raise BadInput.of("files", [str(file) for file in files], bound)
    if question.speed_rpm is None:
        raise BadInput.of(
            "--speed-rpm", None, "given beside a scene", "For example --speed-rpm 500:6000:100."
        )
    *before, after = (read_model(Case, file) for file in files)
    inputs: Json = {
        "before": next(iter(before), None),
        "after": after,
        "mesh": question.mesh,
        "speed_rpm": number_list("--speed-rpm", question.speed_rpm),
        "requirement_db": question.requirement_db,
    }
    study = STUDIES["change"]
    if question.tolerances is not None:
        inputs["tolerances"] = read_table(question.tolerances)
    if question.load_cases is not None:
        inputs |= read_table(question.load_cases)
    options = {
        "scene": file_of(InputFile(question.scene), "scene"),
        "study": validated(study.inputs, inputs),
        "output": output,
    }
    run_study(study, options | {"workers": 1, "scheduler": None, "json": as_json})


def run_compare(
    files: Sequence[Path],
    output: Path,
    view: RunView,
    of: tuple[float | None, Measurement],
    *,
    as_json: bool,
) -> None:
    """Write the page that compares two files, and print the differences that are above their errors.

    `of`: torque in N m at which tables are compared, and the recording that runs are compared with.
    """
    check_writable(output)
    page = compare(files, view, *of)
    write_page(page, output)
    if as_json:
        differences = {
            line.name: {"difference": line.value, "finding": line.remark} for line in page.headlines
        }
        print_json({"file": str(output), "differences": differences})
        return
    headlines = (f"{line.name}: {line.value}: {line.remark}" for line in page.headlines)
    for line in (*headlines, page.lead, f"written to {output}"):
        console().print(line, soft_wrap=True)
