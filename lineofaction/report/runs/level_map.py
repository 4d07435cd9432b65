"""Levels over a run as colors: over frequency or over mesh order."""

from __future__ import annotations

import numpy as np

from lineofaction.report.drawing.figure import FloatArray, HeatMap

LINES, DEPTH = 220, 60.0


def level_map(along: FloatArray, line: FloatArray, amplitude: FloatArray, top: float) -> HeatMap:
    """Return levels below the largest on an even grid of the axis; the loudest of the lines in each cell.

    Parameters
    ----------
    along : (B,) array
        Speed or time of the blocks, rising or falling.
    line : (K,) array
        Frequencies or orders, equally spaced from 0; those above 0 and up to `top` are shown.
    amplitude : (B, K) array
    """
    kept = np.flatnonzero((line > 0.0) & (line <= top))
    group = max(int(np.ceil(kept.size / LINES)), 1)
    kept = kept[: kept.size // group * group]
    rows = amplitude[:, kept].reshape(amplitude.shape[0], -1, group).max(axis=-1)
    order = np.argsort(along)
    even = np.linspace(along.min(), along.max(), along.size)
    middle = 0.5 * (along[order][1:] + along[order][:-1])
    columns = rows[order][np.searchsorted(middle, even)]
    level = 20.0 * np.log10(np.maximum(columns / max(float(columns.max()), 1e-300), 1e-12))
    z = np.clip(level + DEPTH, 0.0, None).T
    height = line[kept].reshape(-1, group).mean(axis=-1)
    return HeatMap(even, height, z, f"level above −{DEPTH:g} dB of the largest, dB", DEPTH)
