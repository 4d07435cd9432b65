"""Pictures of the unit's case: natural modes and surface velocity, as PNG and for ParaView."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from dynamics.assembly.assemble import assemble
from dynamics.housing_modes import ReducedHousing, write_surface
from dynamics.linearize import forced_response
from dynamics.noise import RadiatedSound, loudest
from dynamics.types import FloatArray
from dynamics.vibration import SurfaceShape, housing_motion, mode_shape, operating_deflection, seat_forces
from service.cli.scene_tables import tabled_scene
from service.client.portable import scene_of
from service.drawing.figure import HeatMap, Panel
from service.drawing.surface_view import EYE, surface_panel
from service.units import RPM

HOUSING = "housing"
DRAWN = 3
"""Modes that are drawn."""
SIDES = {"far side": EYE, "motor side": (-1.0, 0.55, -0.65)}
"""Directions to the eye."""
MOVED = 0.02
"""How far the drawn surface moves, m."""


def write_pictures(folder: Path, scene: Path, sound: RadiatedSound, orders: int) -> None:
    """Write modes and surface velocity of a scene's case where its loudest order is.

    Parameters
    ----------
    folder : Path
        Gets modes and velocity, .png and .vtu.
    scene : Path
    sound : RadiatedSound
        Of the scene.
    orders : int
        Multiples of the first mesh's frequency, as of the sound.
    """
    tabled = tabled_scene(*scene_of(scene), None, lambda _stage, _fraction: None)
    housing = tabled.housings[HOUSING]
    write_modes(folder, housing)
    (point,) = loudest(sound, 1)
    response = forced_response(assemble(tabled.scene), [point.speed], orders)
    force = seat_forces(response, housing)[0, point.order_index]
    motion = housing_motion(housing, np.array(point.frequency), force)
    velocity = operating_deflection(housing, 2j * np.pi * point.frequency * motion)
    title = f"{point.speed / RPM:.0f} rpm, {point.frequency:.0f} Hz"
    panels = tuple(
        drawn(velocity, f"{title}, {side}", "velocity, mm/s", eye, 1e3) for side, eye in SIDES.items()
    )
    draw(folder / "velocity.png", panels)
    fields = {"velocity real, m/s": velocity.motion.real, "velocity imaginary, m/s": velocity.motion.imag}
    write_fields(folder / "velocity.vtu", housing, fields)


def write_modes(folder: Path, housing: ReducedHousing) -> None:
    """Write the first modes of the case, its seats free."""
    shapes = {
        f"mode {number}, {housing.frequency[number - 1]:.0f} Hz": mode_shape(housing, number)
        for number in range(1, DRAWN + 1)
    }
    panels = tuple(drawn(shape, name, "motion, 1", EYE) for name, shape in shapes.items())
    draw(folder / "modes.png", panels)
    write_fields(folder / "modes.vtu", housing, {name: shape.motion.real for name, shape in shapes.items()})


def write_fields(file: Path, housing: ReducedHousing, fields: Mapping[str, FloatArray]) -> None:
    """Write fields on the surface of the case."""
    surface = housing.surface
    assert surface is not None
    write_surface(file, surface.points, surface.triangles, fields)


def draw(file: Path, panels: tuple[Panel, ...]) -> None:
    """Draw panels side by side."""
    sheet = Figure(figsize=(3.2 * len(panels), 4.2), layout="constrained")
    for panel, axes in zip(panels, sheet.subplots(1, len(panels), squeeze=False)[0], strict=True):
        shade, (edges,) = panel.shade, panel.lines
        assert isinstance(shade, HeatMap)
        values = axes.pcolormesh(shade.x, shade.y, shade.z, vmin=0.0, vmax=shade.largest, cmap="cividis")
        axes.plot(edges.x, edges.y, color="black", linewidth=0.4)
        axes.set(aspect="equal", title=panel.title)
        axes.axis("off")
        sheet.colorbar(values, ax=axes, label=shade.label, location="bottom", shrink=0.8)
    sheet.savefig(file, dpi=90)


def drawn(
    shape: SurfaceShape, title: str, label: str, eye: tuple[float, float, float], scale: float = 1.0
) -> Panel:
    """Return a picture of a shape: the surface moved, its amount in colors."""
    amount = np.linalg.norm(np.abs(shape.motion), axis=1)
    offset = shape.motion.real * MOVED / amount.max()
    value = scale * amount[shape.facets].mean(axis=1)
    return surface_panel(shape.points, shape.facets, offset, value, label, title, eye)
