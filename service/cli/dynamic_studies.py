"""``loa modes``, ``loa response``, ``loa steady``: studies of a scene that need no time integration."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dynamics.periodic.steady_states import BRANCH
from dynamics.scene import Scene
from service.cli.effects import run_lines
from service.cli.output import Report, check_writable, console, print_json, progress_bar, table
from service.cli.scene_tables import scene_with_tables
from service.cli.warned import messages, warnings_so_far
from service.client.portable import scene_of
from service.convert.modal import modes_json, modes_of
from service.convert.response import response_json, response_of
from service.convert.stamp import stamp
from service.convert.steady import steady_json, steady_of
from service.problems import BadInput, JobFailed
from service.report.figure import Figure
from service.report.image import png
from service.report.inputs import Inputs
from service.report.modal import critical_table, modal_figures, modes_table
from service.report.response import peak_table, response_figure
from service.report.steady import steady_figure, steady_table
from service.report.write import write_page
from service.schemas import validated
from service.schemas.dynamic_studies import ModesInput, ResponseInput, SteadyInput
from service.schemas.model import BoundaryModel
from service.units import RPM

Json = dict[str, Any]
ENDINGS = (".nc", ".json", ".png", ".html")


@dataclass(frozen=True)
class Study:
    """A kind of study on the command line.

    Attributes
    ----------
    inputs : type[BoundaryModel]
        What it varies.
    run : callable
        Scene, inputs and progress to the result, which writes itself by ``to_netcdf``.
    json : callable
        Figures of a result.
    picture : callable
        The figure of ``-o FILE.png``.
    page : callable
        The inputs of the page of ``-o FILE.html``.
    show : callable
        Prints a result for people.
    failure : callable
        Says what of a result was not found, if anything.
    """

    inputs: type[BoundaryModel]
    run: Callable[[Scene, Any, Report], Any]
    json: Callable[[Any], Json]
    picture: Callable[[Any], Figure]
    page: Callable[[Any], Inputs]
    show: Callable[[Any], None]
    failure: Callable[[Any], str] = lambda _found: ""


def run_study(
    study: Study, file: Path, output: Path | None, service: str | None, asked: Json, *, as_json: bool
) -> None:
    """Compute, write, print. `asked` holds the fields of the inputs that were given."""
    chosen = validated(study.inputs, asked)
    scene, folder = scene_of(file)
    if output is not None:
        _check(output)
    with progress_bar() as report:
        found = study.run(scene_with_tables(scene, folder, service, report), chosen, report)
    if output is not None:
        _write(study, found, output)
    if as_json:
        print_json(({} if output is None else {"file": str(output)}) | study.json(found))
    else:
        study.show(found)
        _lines(tuple(run_lines(found.facts)))
        if output is not None:
            console().print(f"written to {output}", highlight=False)
    if failure := study.failure(found):
        raise JobFailed(failure)


def _check(output: Path) -> None:
    """Refuse an output of another kind before the work."""
    if output.suffix not in ENDINGS:
        raise BadInput.of("output", str(output), f"a file ending in one of {', '.join(ENDINGS)}")
    check_writable(output)


def _write(study: Study, found: Any, output: Path) -> None:
    """Write a result as its ending says."""
    if output.suffix == ".nc":
        found.to_netcdf(output)
    elif output.suffix == ".json":
        text = json.dumps(study.json(found), allow_nan=False, indent=1)
        output.write_text(f"{text}\n", encoding="utf-8")
    elif output.suffix == ".png":
        output.write_bytes(png(study.picture(found)))
    else:
        write_page(replace(study.page(found), warnings=tuple(messages())), output)
    stamp(output, warnings_so_far())


def _lines(texts: Sequence[str]) -> None:
    """Print lines for people."""
    for text in texts:
        console().print(text, highlight=False)


def _show_modes(found: Any) -> None:
    """Print modes and critical speeds."""
    out = console()
    start = found.facts["equilibrium"]
    forces = ", ".join(f"{name} {force:.5g} N" for name, force in start["mesh_force"].items())
    _lines([f"static equilibrium {start['status'].lower()}, {start['residual']:.1e} N left; {forces}"])
    modes = modes_table(found)
    out.print(table(modes.head, modes.rows, modes.caption))
    if found.speed.size:
        critical = critical_table(found)
        out.print()
        out.print(table(critical.head, critical.rows, critical.caption))
    _lines([f"cost {sum(found.facts['seconds'].values()):.3g} CPU s"])


def _show_response(found: Any) -> None:
    """Print the peaks, and what the linear answer does not hold."""
    out = console()
    listed = peak_table(found)
    out.print(table(listed.head, listed.rows, listed.caption))
    parting = found.speed[~found.in_contact] / RPM
    if parting.size:
        where = f"{parting[0]:.5g} to {parting[-1]:.5g} rpm"
        _lines([f"flanks part at {parting.size} of {found.speed.size} speeds, {where}: see loa steady"])
    worst = float(found.excitation_difference.max(initial=0.0))
    _lines(
        [
            "first-order theory: the other excitation changes amplitudes by up to "
            f"{100.0 * worst:.2g} % of the largest",
            f"residual of the solves {found.residual:.1e}",
            f"cost {sum(found.facts['seconds'].values()):.3g} CPU s",
        ]
    )


def _show_steady(found: Any) -> None:
    """Print both sweeps, jumps and what the branch came to."""
    out = console()
    listed = steady_table(found)
    out.print(table(listed.head, listed.rows, listed.caption))
    answer = steady_json(found)
    for jump in answer["jumps"]:
        before, behind = jump["between_rpm"]
        sense = "rising" if jump["sweep"] == "up" else "falling"
        _lines([f"{sense} speeds jump between {before:.6g} and {behind:.6g} rpm"])
    if answer["branch"]["status"] != "none":
        branch, places = answer["branch"], answer["bifurcations"]
        turns = ", ".join(f"{place['kind']} at {place['speed_rpm']:.6g} rpm" for place in places)
        _lines([f"branch {branch['status']}, {len(branch['points'])} motions; {turns or 'no bifurcation'}"])
    _lines([f"cost {sum(found.facts['seconds'].values()):.3g} CPU s"])


def _not_found(found: Any) -> str:
    """Say at how many speeds a sweep found no motion."""
    missing = (found.status != 0) & (found.curve != BRANCH)
    if not missing.any():
        return ""
    speeds = sorted({f"{speed / RPM:.6g}" for speed in found.speed[missing]})
    shown = ", ".join(speeds[:5]) + (" ..." if len(speeds) > 5 else "")
    return (
        f"{int(missing.sum())} of {int((found.curve != BRANCH).sum())} motions were not found, at {shown} "
        "rpm. They may repeat after more periods (--repeat 2), or never."
    )


STEADY = Study(
    SteadyInput,
    steady_of,
    steady_json,
    steady_figure,
    lambda found: Inputs(steady=found),
    _show_steady,
    _not_found,
)
RESPONSE = Study(
    ResponseInput,
    response_of,
    response_json,
    response_figure,
    lambda found: Inputs(response=found),
    _show_response,
)
MODES = Study(
    ModesInput,
    modes_of,
    modes_json,
    lambda found: modal_figures(found)[0],
    lambda found: Inputs(modal=found),
    _show_modes,
)
