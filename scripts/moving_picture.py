"""Draw the moving picture of the README: tip relief moves, pressure on the flank, ripple and sound follow.

python scripts/moving_picture.py docs/images/relief.gif        about 40 CPU s; writes relief.wav beside it
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

import lineofaction as loa
from dynamics.acoustics.recording import Recording, write_wav
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, FloatArray, HeatMap, Line, Panel
from lineofaction.report.drawing.image import panel_sheet
from lineofaction.report.flank.flank import contact_pattern_figure

CASE = """
[pair] # the EV reducer of the tutorial "Whine at 1.4 kHz"
normal_module_mm = 2.1
helix_angle_deg = 27
center_distance_mm = 101.5
[pair.pinion]
teeth = 25
face_width_mm = 30
bore_diameter_mm = 24
profile_shift_coefficient = 0.2017
tip_relief_length_mm = 0.84
helix_crowning_um = 6
[pair.wheel]
teeth = 61
face_width_mm = 30
bore_diameter_mm = 62
profile_shift_coefficient = -0.1281
tip_relief_length_mm = 0.84
[load]
torque_n_m = [80]
[accuracy]
level = "draft"
"""
TORQUE = 80.0
RELIEFS = tuple(float(relief) for relief in range(0, 25, 2))
DOTS, FRAME_MS, REST_MS = 80, 160, 900
COLORS = 96
MESH_HZ, SAMPLE_RATE = 1400.0, 12_000
"""The pitch of the tutorial's complaint; four harmonics are below half the sample rate."""
FADE_S = 0.02


def relieved(case: dict[str, Any], relief: float) -> dict[str, Any]:
    """Return the case with one tip relief in µm on both gears."""
    changed = deepcopy(case)
    for gear in ("pinion", "wheel"):
        changed["pair"][gear]["tip_relief_um"] = relief
    return changed


def ripple_of(flanks: Any) -> FloatArray:
    """Return the transmission error less its mean over two pitches, µm."""
    curve = 1e6 * (flanks.deflection - flanks.deflection.mean())
    return np.asarray(np.concatenate([curve, curve, curve[:1]]))


def velocities(ripple: FloatArray) -> FloatArray:
    """Return the amplitudes of the harmonics of a curve over one pitch as velocities at the mesh, µm/s.

    As the page sounds live curves: each harmonic by its velocity.
    """
    orders = np.arange(1, int(0.5 * SAMPLE_RATE / MESH_HZ) + 1)
    amplitude = 2.0 * np.abs(np.fft.rfft(ripple)[orders]) / ripple.size
    return np.asarray(2.0 * np.pi * orders * MESH_HZ * amplitude)


def sound(ripples: Sequence[FloatArray], durations_ms: Sequence[int]) -> Recording:
    """Return the sound of each curve while it is shown, all at one scale."""
    counts = [round(1e-3 * duration * SAMPLE_RATE) for duration in durations_ms]
    velocity = np.repeat([velocities(ripple) for ripple in ripples], counts, axis=0)
    fade = np.hanning(round(FADE_S * SAMPLE_RATE) + 2)[1:-1]
    level = np.column_stack([np.convolve(each, fade / fade.sum(), "same") for each in velocity.T])
    phase = 2.0 * np.pi * MESH_HZ * np.arange(len(level)) / SAMPLE_RATE
    samples = (level * np.sin(phase[:, None] * np.arange(1, level.shape[1] + 1))).sum(axis=1)
    return Recording(samples, SAMPLE_RATE, "velocity of the transmission error; no sound pressure", "um/s")


def panels(all_flanks: Sequence[Any], index: int) -> tuple[Panel, ...]:
    """Return pressure on the pinion, ripple, and peak-to-peak over relief with the slider where it is."""
    flanks, ripples = all_flanks[index], [ripple_of(one) for one in all_flanks]
    sizes = np.array([np.ptp(ripple) for ripple in ripples])
    pattern = contact_pattern_figure(flanks).content[0]
    assert isinstance(pattern.shade, HeatMap)
    hottest = 1e-6 * max(float(one.pressure.max()) for one in all_flanks)
    shade = replace(pattern.shade, largest=hottest)
    pressure = replace(
        pattern, shade=shade, references=(), title=f"Pressure on the pinion, {RELIEFS[index]:g} µm relief"
    )
    pitches = np.linspace(0.0, 2.0, ripples[0].size)
    half = 0.6 * float(sizes.max())
    curves = (
        Line("without relief", pitches, ripples[0], palette.MUTED, "dash"),
        Line("with it", pitches, ripples[index], palette.BLUE, width=2.6),
    )
    ripple = Panel(
        Axis("base pitches"), Axis("STE less its mean, µm", limits=(-half, half)), curves, title="Ripple"
    )
    at = np.array([RELIEFS[index]])
    slider = (
        Line("peak to peak", np.array(RELIEFS), sizes, palette.MUTED),
        Line("slider", at, sizes[[index]], palette.VERMILLION, width=0.0, markers=True),
    )
    over = Panel(
        Axis("tip relief, µm"),
        Axis("peak to peak, µm", limits=(0.0, 1.1 * float(sizes.max()))),
        slider,
        title=f"Peak to peak {sizes[index]:.2f} µm",
    )
    return pressure, ripple, over


def frame(drawn: tuple[Panel, ...]) -> Image.Image:
    """Return panels as a picture."""
    sheet = panel_sheet(drawn, across=2)
    sheet.legends.clear()
    FigureCanvasAgg(sheet)
    buffer = BytesIO()
    sheet.savefig(buffer, format="png", dpi=DOTS)
    return Image.open(buffer).convert("RGB").quantize(COLORS, Image.Quantize.MAXCOVERAGE)


def there_and_back(count: int) -> list[tuple[int, int]]:
    """Return which of the positions of the slider is shown, and for how many ms; it rests at both ends."""
    rests = {0, count - 1}
    return [(i, REST_MS if i in rests else FRAME_MS) for i in (*range(count), *range(count - 2, 0, -1))]


def moving(frames: Sequence[Image.Image], output: Path) -> None:
    """Write frames there and back as a GIF that repeats."""
    sequence = there_and_back(len(frames))
    first, *others = (frames[index] for index, _ in sequence)
    durations = [duration for _, duration in sequence]
    first.save(output, save_all=True, append_images=others, duration=durations, loop=0, optimize=True)


def main(output: Path) -> None:
    """Compute all reliefs and write the picture and its sound."""
    case = tomllib.loads(CASE)
    found = [loa.flank(relieved(case, relief), torque_n_m=TORQUE) for relief in RELIEFS]
    moving([frame(panels(found, index)) for index in range(len(found))], output)
    frames = there_and_back(len(found))
    curves = [1e6 * found[index].deflection for index, _ in frames]
    recording = sound(curves, [duration for _, duration in frames])
    write_wav(output.with_suffix(".wav"), recording, recording.peak)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
