"""Measured frequency responses of a housing, by bearings and points, from the nodes of a universal file."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from dynamics.errors import InputError
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import Direction, MeasuredMobility
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals import Channel, read_frequency_responses

SAME_LINES = 2e-5
"""Relative difference of frequencies that are the same line: a universal file has six digits of its step."""
_RATES = {"m/N": 1, "m/(N s)": 0, "m/(N s²)": -1}
"""Derivatives in time from a response to a mobility."""
_LISTED = 12  # nodes in a message


def measured_mobility(
    file: Path | str,
    seats: Mapping[int, str],
    points: Mapping[int, str],
    axes: FloatArray | None = None,
    field: str = "file",
) -> MeasuredMobility:
    """Return the mobilities from bearing seats to points that a universal file holds (dataset 58).

    Functions between other nodes are passed over, and so is a line at 0 Hz. Raises `BadInput`: as
    `read_frequency_responses`; a node has no function, a function is not along an axis, is there twice, is
    missing between a measured seat and a measured point, has other lines than the first or no finite values.

    Parameters
    ----------
    seats, points : mapping of int to str
        Bearings by reference node, points by response node.
    axes : (3, 3) array, optional
        Columns: the axes of the file in the scene; by default the same.
    field : str
        What names the file, for errors.
    """
    file = Path(file)
    functions = _chosen(read_frequency_responses(file, field), (field, file.name), seats, points)
    response = tuple(dict.fromkeys(ends[0] for ends in functions))
    excitation = tuple(dict.fromkeys(ends[1] for ends in functions))
    first = next(iter(functions.values()))[0]
    lines = _lines(first, field)
    rows = np.empty((lines.size, len(response), len(excitation)), dtype=complex)
    for q, point in enumerate(response):
        for e, seat in enumerate(excitation):
            if (point, seat) not in functions:
                bound = f"a function of {point} per {seat}, as of the other directions"
                raise BadInput.of(field, file.name, bound, "Measure or export all pairs.")
            rows[:, q, e] = _mobility(*functions[point, seat], lines, field)
    moving = lines > 0.0
    try:
        own = {} if axes is None else {"axes": axes}
        return MeasuredMobility(lines[moving], response, excitation, rows[moving], **own)
    except InputError as error:
        value = f"{file.name}: {error.field}"
        raise BadInput.of(field, value, str(error.bound), str(error.suggestion)) from None


def _chosen(
    channels: Sequence[Channel], where: tuple[str, str], seats: Mapping[int, str], points: Mapping[int, str]
) -> dict[tuple[Direction, Direction], tuple[Channel, float]]:
    """Return the functions from seats to points, and 1 or -1 for their sense, by point and seat."""
    field, name = where
    if not channels:
        advice = "Export functions of type 4, one for each pair of seat and point."
        raise BadInput.of(field, name, "a file with frequency responses; it has none", advice)
    for kind, known, at in (("response", points, 0), ("reference", seats, 2)):
        present = sorted({channel.nodes[at] for channel in channels})
        if (node := next((number for number in known if number not in present), None)) is not None:
            listed = ", ".join(map(str, present[:_LISTED]))
            more = f" and {len(present) - _LISTED} more" if len(present) > _LISTED else ""
            raise BadInput.of(field, node, f"a {kind} node of {name}: {listed}{more}")
    functions: dict[tuple[Direction, Direction], tuple[Channel, float]] = {}
    for channel in channels:
        point, towards, seat, pushed = channel.nodes
        if point not in points or seat not in seats:
            continue
        if not (1 <= abs(towards) <= 3 and 1 <= abs(pushed) <= 3):
            bound = "a function along x, y or z (directions 1 to 3, or -1 to -3)"
            raise BadInput.of(field, f"{name}: {channel.name}", bound, "Leave rotations out.")
        ends = Direction(points[point], abs(towards) - 1), Direction(seats[seat], abs(pushed) - 1)
        if ends in functions:
            bound = f"one function of {ends[0]} per {ends[1]}"
            raise BadInput.of(field, f"{name}: {channel.name}", bound, "Export one of them.")
        functions[ends] = channel, math.copysign(1.0, towards * pushed)
    if not functions:
        raise BadInput.of(
            field, name, "a file with a function from a seat to a point; all end at other nodes"
        )
    return functions


def _lines(channel: Channel, field: str) -> FloatArray:
    """Return the frequencies of a function, Hz; raises `BadInput`: there are none, or they do not rise."""
    lines = channel.abscissa
    if lines.size < 2:
        raise BadInput.of(field, channel.name, f"at least two lines; it has {lines.size}")
    if not (np.all(np.isfinite(lines)) and lines[0] >= 0.0 and np.all(np.diff(lines) > 0.0)):
        raise BadInput.of(field, channel.name, "a function whose frequency rises from 0 Hz or above")
    return lines


def _mobility(channel: Channel, sense: float, lines: FloatArray, field: str) -> ComplexArray:
    """Return the velocity per force of a function at the lines; 0 at 0 Hz."""
    same = channel.abscissa.shape == lines.shape and np.allclose(
        channel.abscissa, lines, rtol=SAME_LINES, atol=SAME_LINES * float(lines[1] - lines[0])
    )
    if not same:
        bound = f"a function over the same {lines.size} lines as the first one"
        raise BadInput.of(field, channel.name, bound, "Export all with one frequency axis.")
    if not np.iscomplexobj(channel.values):
        raise BadInput.of(field, channel.name, "a function of complex values", "Export real and imaginary.")
    rate = 2j * np.pi * np.where(lines > 0.0, lines, 1.0)
    return np.asarray(sense * rate ** _RATES[channel.unit] * channel.values * (lines > 0.0))
