"""``loa export RUN.nc``: a run for other programs."""

from __future__ import annotations

from pathlib import Path

from dynamics.export import FUNCTIONS, write_universal_file
from lineofaction.cli.output import check_writable, console, print_json, print_written
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.document import read_run

UNIVERSAL = (".unv", ".uff", ".uf")

TABLE = ".csv"


def export_run(
    file: Path, output: Path, function: str, window: tuple[float | None, float | None], *, as_json: bool
) -> None:
    """Write a run for other programs, by the ending of the output."""
    if function not in FUNCTIONS or (output.suffix == TABLE and function != "time"):
        allowed = "time" if output.suffix == TABLE else ", ".join(FUNCTIONS)
        raise BadInput.of("--function", function, f"one of {allowed}")
    check_writable(output)
    run = read_run(file, "file")
    answer: dict[str, object] = {"written": [str(output)]}
    if output.suffix == TABLE:
        run.to_csv(output)
    else:
        answer["functions"] = write_universal_file(run, output, function, *window)
    if as_json:
        print_json(answer)
        return
    if "functions" in answer:
        console().print(f"{answer['functions']} functions of dataset 58")
    print_written([output])
