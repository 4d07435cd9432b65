"""Long time series for a plot: what the eye sees of them, and no more points than that."""

from __future__ import annotations

import numpy as np

from lineofaction.report.drawing.figure import FloatArray


def envelope(time: FloatArray, values: FloatArray, columns: int = 1200) -> tuple[FloatArray, FloatArray]:
    """Keep the lowest and the highest sample of each of `columns` stretches, in their order in time.

    A line through them covers the same pixels as the whole series. A short series comes back whole.
    """
    size = len(time)
    if size <= 2 * columns:
        return time, values
    edges = np.linspace(0, size, columns + 1).astype(int)
    kept = [edges[k] + np.sort(_extremes(values[edges[k] : edges[k + 1]])) for k in range(columns)]
    index = np.unique(np.concatenate([[0], *kept, [size - 1]]))
    return time[index], values[index]


def _extremes(values: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    return np.array([np.argmin(values), np.argmax(values)], dtype=np.int64)
