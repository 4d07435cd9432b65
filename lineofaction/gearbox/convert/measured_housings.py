"""Measured frequency responses of a housing, by bearings and points, from the nodes of a universal file.

The file is one on disk, or its content in a scene; a confined process reads it. A *function* of the file is a
frequency response between two nodes: velocity, displacement or acceleration at the response node per force on
the reference node, over *lines*, its frequencies. Mobility is velocity per force. Here reference nodes are
bearing seats and response nodes are points.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from dynamics.errors import InputError
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import Direction, MeasuredMobility
from lineofaction.gearbox.convert.housings import response_content
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.housings import HousingInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.signals.channel import Channel
from lineofaction.gearbox.signals.recording import read_frequency_responses

SAME_LINES = 2e-5
"""Relative difference of frequencies that are the same line: a universal file has six digits of its step."""
_RATES = {"m/N": 1, "m/(N s)": 0, "m/(N s²)": -1}
"""Power of i omega that turns a function of a unit into a mobility: displacement, velocity, acceleration."""
_LISTED = 12  # most nodes in a message
_CACHE_SIZE = 8
"""Number of housings whose mobilities stay in memory: check and study of a scene read the file once."""
_PLAIN = re.compile(r"\w[\w .+-]{0,99}")
"""File names that are valid on any system; other names are replaced in the temporary copy."""

_PLACES = {"response": 0, "reference": 2}
"""Index of the node of each kind in `Channel.nodes`: response node, its direction, reference node, its
direction. A direction is 1 to 3 for x, y, z, negative against the axis."""


def read_responses(scene: SceneInput) -> None:
    """Read the files of the measured housings of a scene, so that their faults come before its tables.

    Raises `BadInput` as `housing_mobility`.
    """
    for index, part in enumerate(scene.housings):
        if part.is_measured:
            try:
                housing_mobility(part)
            except BadInput as error:
                raise error.within(f"housings[{index}]") from None


@lru_cache(maxsize=_CACHE_SIZE)
def housing_mobility(housing: HousingInput) -> MeasuredMobility:
    """Return the mobilities of a measured housing of a scene, along the axes of its file.

    Raises `BadInput` as `measured_mobility`, by the fields of the housing.
    """
    suffix, content = response_content(housing)
    assert housing.frf_file is not None  # the schema has required it
    name = housing.frf_file.name
    with TemporaryDirectory() as folder:
        file = Path(folder) / (name if _PLAIN.fullmatch(name) else f"responses{suffix}")
        file.write_bytes(content)
        channels = read_frequency_responses(file, "frf_file")
    where = "frf_file", file.name
    seats = {part.node: part.bearing for part in housing.seat_nodes}
    points = {part.node: part.name for part in housing.point_nodes}
    for field, kind, nodes in (("seat_nodes", "reference", seats), ("point_nodes", "response", points)):
        numbers = {node: f"{field}[{index}].node" for index, node in enumerate(nodes)}
        _check_nodes(channels, where, kind, numbers)
    axes = Placement.of(housing.file_x_axis, housing.file_z_axis, (0.0, 0.0, 0.0)).axes
    return _mobility_of(channels, where, seats, points, axes)


def measured_mobility(
    file: Path | str,
    seats: Mapping[int, str],
    points: Mapping[int, str],
    axes: FloatArray | None = None,
    field: str = "file",
) -> MeasuredMobility:
    """Return the mobilities from bearing seats to points that a universal file holds (dataset 58).

    Functions between other nodes are ignored, and so is a line at 0 Hz. Raises `BadInput` as
    `read_frequency_responses` does, and for a node without function; for a function that is not along an
    axis, occurs twice, or has other lines than the first or no finite values; for a missing function between
    a measured seat and a measured point.

    Parameters
    ----------
    seats, points : mapping of int to str
        Bearings by reference node, points by response node.
    axes : (3, 3) array, optional
        Columns: the axes of the file in the scene; by default those of the scene.
    field : str
        Field that names the file, for errors.
    """
    file = Path(file)
    channels, where = read_frequency_responses(file, field), (field, file.name)
    _check_nodes(channels, where, "response", dict.fromkeys(points, field))
    _check_nodes(channels, where, "reference", dict.fromkeys(seats, field))
    return _mobility_of(channels, where, seats, points, axes)


def _mobility_of(
    channels: Sequence[Channel],
    where: tuple[str, str],
    seats: Mapping[int, str],
    points: Mapping[int, str],
    axes: FloatArray | None,
) -> MeasuredMobility:
    """Return the mobilities that the functions of a file hold; `where` are its field and its name."""
    field, name = where
    functions = _chosen(channels, where, seats, points)
    response = tuple(dict.fromkeys(point for point, _ in functions))
    excitation = tuple(dict.fromkeys(seat for _, seat in functions))
    first, _ = next(iter(functions.values()))
    lines = _lines(first, field)
    rows = np.empty((lines.size, len(response), len(excitation)), dtype=complex)
    for q, point in enumerate(response):
        for e, seat in enumerate(excitation):
            if (point, seat) not in functions:
                bound = f"a function of {point} per {seat}, as of the other directions"
                raise BadInput.of(field, name, bound, "Measure or export all pairs.")
            rows[:, q, e] = _mobility(*functions[point, seat], lines, field)
    positive = lines > 0.0
    try:
        rotation = {} if axes is None else {"axes": axes}
        return MeasuredMobility(lines[positive], response, excitation, rows[positive], **rotation)
    except InputError as error:
        value = f"{name}: {error.field}"
        raise BadInput.of(field, value, str(error.bound), str(error.suggestion)) from None


def _check_nodes(
    channels: Sequence[Channel], where: tuple[str, str], kind: str, nodes: Mapping[int, str]
) -> None:
    """Refuse a file without functions, or a node that none of them has, by the field that `nodes` give it."""
    field, name = where
    if not channels:
        remedy = "Export functions of type 4, one for each pair of seat and point."
        raise BadInput.of(field, name, "a file with frequency responses; it has none", remedy)
    present = sorted({channel.nodes[_PLACES[kind]] for channel in channels})
    if (node := next((number for number in nodes if number not in present), None)) is not None:
        listed = ", ".join(map(str, present[:_LISTED]))
        more = f" and {len(present) - _LISTED} more" if len(present) > _LISTED else ""
        raise BadInput.of(nodes[node], node, f"a {kind} node of {name}: {listed}{more}")


def _chosen(
    channels: Sequence[Channel], where: tuple[str, str], seats: Mapping[int, str], points: Mapping[int, str]
) -> dict[tuple[Direction, Direction], tuple[Channel, float]]:
    """Return the functions from seats to points, and 1 or -1 for their sense, by point and seat."""
    field, name = where
    functions: dict[tuple[Direction, Direction], tuple[Channel, float]] = {}
    for channel in channels:
        point, point_axis, seat, seat_axis = channel.nodes
        if point not in points or seat not in seats:
            continue
        if not (1 <= abs(point_axis) <= 3 and 1 <= abs(seat_axis) <= 3):
            bound = "a function along x, y or z (directions 1 to 3, or -1 to -3)"
            raise BadInput.of(field, f"{name}: {channel.name}", bound, "Leave rotations out.")
        ends = Direction(points[point], abs(point_axis) - 1), Direction(seats[seat], abs(seat_axis) - 1)
        if ends in functions:
            bound = f"one function of {ends[0]} per {ends[1]}"
            raise BadInput.of(field, f"{name}: {channel.name}", bound, "Export one of them.")
        functions[ends] = channel, math.copysign(1.0, point_axis * seat_axis)
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
    """Return the mobility at the lines, m/(N s), with the sign `sense`; 0 at 0 Hz."""
    fits = channel.abscissa.shape == lines.shape and np.allclose(
        channel.abscissa, lines, rtol=SAME_LINES, atol=SAME_LINES * float(lines[1] - lines[0])
    )
    if not fits:
        bound = f"a function over the same {lines.size} lines as the first one"
        raise BadInput.of(field, channel.name, bound, "Export all with one frequency axis.")
    if not np.iscomplexobj(channel.values):
        raise BadInput.of(field, channel.name, "a function of complex values", "Export real and imaginary.")
    rate = 2j * np.pi * np.where(lines > 0.0, lines, 1.0)  # i omega; any value at 0 Hz
    return np.asarray(sense * rate ** _RATES[channel.unit] * channel.values * (lines > 0.0))
