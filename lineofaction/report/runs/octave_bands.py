"""One-third-octave levels of the shown quantity."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.orders import ThirdOctaves, Waterfall, third_octaves
from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number
from lineofaction.report.runs.run_view import Signal, decibels

DEPTH = 80.0


def octave_bands(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure | None:
    """Draw the rms of each band over the whole run and in its loudest block; None where no band fits."""
    try:
        made = third_octaves(blocks, float(run.receipt["sampling"]["pass_frequency"]))
    except InputError:  # the run is too short for a band
        return None
    rms = signal.magnitude(made.rms)
    mean, most = np.sqrt(np.mean(rms**2, axis=0)), np.max(rms, axis=0)
    floor = float(most.max()) * 10.0 ** (-DEPTH / 20.0)
    lines = (
        _steps("loudest block", made, decibels(most, floor), palette.VERMILLION),
        _steps("whole run", made, decibels(mean, floor), palette.BLUE),
    )
    unit, worst = signal.quantity.unit, int(np.argmax(mean))
    names = tuple((float(at), _nominal(at)) for at in made.nominal[made.band % 3 == 0])
    x = Axis("nominal center of the band, Hz", "log", (float(made.edges[0]), float(made.edges[-1])), names)
    return Figure(
        key="octave_bands",
        title=f"One-third-octave levels of the {signal.name}",
        caption=f"Effective values in bands after IEC 61260-1, lines of blocks of "
        f"{number(1.0 / float(blocks.line[1]), 2)} s added in power: over the whole run, and the largest of "
        "any block.",
        alternative=f"The band at {_nominal(made.nominal[worst])} Hz is the loudest over the run: "
        f"{number(float(mean[worst]), 3)} {unit} rms.",
        content=(Panel(x, Axis(f"level, dB re 1 {unit} rms"), lines),),
        table=_table(made, mean, most, unit),
    )


def _steps(name: str, made: ThirdOctaves, level: FloatArray, color: str) -> Line:
    return Line(name, np.repeat(made.edges, 2)[1:-1], np.repeat(level, 2), color)


def _nominal(frequency: float) -> str:
    return f"{frequency:g}" if frequency < 1000.0 else f"{frequency / 1000.0:g}k"


def _table(made: ThirdOctaves, mean: FloatArray, most: FloatArray, unit: str) -> Table:
    """Every band."""
    rows = tuple(
        (f"{at:g}", number(float(a), 3), number(float(b), 3))
        for at, a, b in zip(made.nominal, mean, most, strict=True)
    )
    head = ("band, Hz", f"whole run, {unit} rms", f"loudest block, {unit} rms")
    return Table("One-third-octave bands", head, rows)
