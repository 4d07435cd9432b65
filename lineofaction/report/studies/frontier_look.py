"""The words of the accuracy studies of cases and of scenes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis.studies.frontier import Frontier
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import number
from lineofaction.report.studies import frontier_full_contact as full_contact
from lineofaction.report.studies.frontier_peer import Peer

Study = Frontier | SceneFrontier


@dataclass(frozen=True)
class Look:
    """The look of an accuracy study.

    `key`, `title`, the label of `time`, `panels` (error, title, label, head of its column) and `families`
    (name, members, color) make the plot; `member` is the attribute of a result that tells its family. The
    table has a caption and `further` columns behind the errors. `chosen` says what that mark means, `lead`
    what was compared, `caption` how to read the plot, `peers` what stands beside.
    """

    key: str
    title: str
    time: str
    panels: tuple[tuple[str, str, str, str], ...]
    member: str
    families: tuple[tuple[str, tuple[str, ...], str], ...]
    further: tuple[tuple[str, Callable[[Any], str]], ...]
    table: str
    chosen: str
    lead: Callable[[Any], str]
    caption: Callable[[Any], str]
    peers: Callable[[Any], Sequence[Peer]] = lambda _study: ()


def _case_caption(study: Frontier) -> str:
    """Say what the errors of a case are."""
    return (
        f"Largest relative difference to the finest fidelity ({study.reference.title}) over all curves of "
        f"the table of {study.solves} positions x loads; the point of that fidelity is what its mesh leaves "
        f"by its convergence, and nothing below it can be told apart. {full_contact.caption(study)}".strip()
    )


def _scene_caption(study: SceneFrontier) -> str:
    """Say what the errors of a scene are."""
    return (
        f"Root of the sum of squared differences to the finest fidelity ({study.reference.title}), "
        f"relative, over {study.blocks} blocks of the run and {study.orders} mesh orders; the point of that "
        "fidelity is what its steps leave, by the rate at which errors fall towards it. All fidelities share "
        "the tables: a third of what every second position node changes is their own error."
    )


_CASE = Look(
    key="frontier",
    title="Error of each fidelity over its CPU time, this case",
    time="CPU time of the table, s",
    panels=(
        ("mean_error", "Mean", "error of the mean, %", "mean error, %"),
        ("peak_to_peak_error", "Peak to peak", "error of peak to peak, %", "peak-to-peak error, %"),
    ),
    member="name",
    families=(
        ("closed forms", ("iso6336", "thin_slices"), palette.ORANGE),
        (
            "2-D finite elements",
            ("plane_strain", "corrected_draft", "corrected", "corrected_fine"),
            palette.BLUE,
        ),
        ("3-D finite elements", ("3d_draft", "3d_standard", "3d_fine"), palette.GREEN),
    ),
    further=(("memory, MiB", lambda result: number(result.peak_memory_bytes / 2**20, 3)),),
    table="Accuracy study",
    chosen="chosen for the requested accuracy",
    lead=lambda study: f"{len(study.results)} fidelities, tables of {study.solves} positions x loads",
    caption=_case_caption,
    peers=full_contact.peers,
)
_SCENE = Look(
    key="run_frontier",
    title="Error of each fidelity over its CPU time, this scene",
    time="CPU time of the run, s",
    panels=(
        ("rms_error", "Transmission error, rms", "error of the rms, %", "DTE rms error, %"),
        (
            "transmission_error_orders",
            "Transmission error, orders",
            "error of the orders, %",
            "DTE orders error, %",
        ),
        (
            "bearing_force_orders",
            "Bearing forces, orders",
            "error of the orders, %",
            "bearing-force orders error, %",
        ),
    ),
    member="family",
    families=(
        ("fewer effects", ("model",), palette.ORANGE),
        ("fewer position nodes", ("table",), palette.GREEN),
        ("step tolerance", ("steps",), palette.BLUE),
    ),
    further=(),
    table="Accuracy study of the scene",
    chosen="the scene's own setting",
    lead=lambda study: (
        f"{len(study.results)} fidelities of the vibration: {study.blocks} blocks, {study.orders} orders"
    ),
    caption=_scene_caption,
)


def look_of(study: Study) -> Look:
    """Return the words of a case, or of a scene."""
    return _CASE if isinstance(study, Frontier) else _SCENE
