"""Page of a run heard through a housing: its level over the speeds, with a player."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.acoustics import sound_pressure_level, wav_file
from dynamics.types import FloatArray
from dynamics.vibration import vibration_level
from lineofaction.gearbox.studies.listen.run import HeardRun
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Sound, Table, Track, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from lineofaction.report.run.sound import PAGE_BYTES, SAMPLE_BYTES
from lineofaction.report.run.view import speed_axis

BLOCK = 0.1
"""Duration over which a level is averaged, s."""
MIN_SPAN, DEPTH, MARGIN = 20.0, 60.0, 2.0
"""Range of levels below the loudest in a plot, dB: least range, largest range, and margin at both ends."""


def _level_figure(audio: HeardRun) -> Figure:
    time, level = _block_levels(audio)
    axis, track = speed_axis(audio.time, audio.speed)
    along = np.interp(time, audio.time, track)
    x = replace(axis, limits=(float(track.min()), float(track.max())))
    unit = "dB re 1 nm/s" if audio.figures is None else "dB(A) re 20 µPa"
    name = _noun(audio)
    loudest = int(np.argmax(level))
    top = float(level[loudest])
    lowest = min(top - MIN_SPAN, max(float(level.min()), top - DEPTH))
    y = Axis(f"level, {unit}", limits=(lowest - MARGIN, top + MARGIN))
    rows = tuple((f"{t:.3f}", number(x, 5), f"{dB:.1f}") for t, x, dB in zip(time, along, level, strict=True))
    return Figure(
        key="heard_level",
        title=f"Level of the {name}",
        # the middle of the first block is half its duration
        caption=f"{audio.recording.quantity[0].upper()}{audio.recording.quantity[1:]}. Over blocks of "
        f"{number(time[0] * 2.0, 2)} s.",
        alternative=f"Loudest at {number(along[loudest], 4)} {x.label.rpartition(', ')[2]}: "
        f"{level[loudest]:.1f} {unit.partition(' re ')[0]}.",
        content=(Panel(x, y, (Line(name, along, level, palette.INK, width=1.4),)),),
        table=Table("Level over the run", ("middle, s", x.label, unit), rows),
        sound=_sound(audio, track),
    )


def _block_levels(audio: HeardRun) -> tuple[FloatArray, FloatArray]:
    """Return the middles of blocks, s, and their levels: dB(A) of a pressure, dB re 1 nm/s of a velocity."""
    recording = audio.recording
    duration = recording.samples.size / recording.sample_rate
    blocks = np.array_split(recording.samples, max(1, int(duration / BLOCK)))
    time = (np.arange(len(blocks)) + 0.5) * duration / len(blocks)
    parts = [replace(recording, samples=block) for block in blocks]
    if audio.figures is None:
        return time, vibration_level([part.rms for part in parts])
    return time, np.array([sound_pressure_level(part, weighted=True) for part in parts])


def _noun(audio: HeardRun) -> str:
    return "velocity" if audio.figures is None else "sound pressure"


def _sound(audio: HeardRun, along: FloatArray) -> Sound | None:
    """Return the sound of the plot; None: silence."""
    recording = audio.recording
    if recording.peak == 0.0:
        return None
    fits = SAMPLE_BYTES * recording.samples.size <= PAGE_BYTES
    files = (wav_file(recording, recording.peak),) if fits else ()
    caption = f"Full scale: {number(recording.peak, 2)} {recording.unit}."
    return Sound(caption, (Track("run", audio.time, along, {}),), files)


def _headlines(audio: HeardRun) -> tuple[Headline, ...]:
    figures = audio.figures
    if figures is None:
        level = float(vibration_level(audio.recording.rms))
        return (Headline("velocity, rms", f"{engineering(audio.recording.rms, 4)} m/s", f"{level:.1f} dB"),)
    weighted = f"{figures.weighted_level:.1f} dB(A)"
    rows = [Headline("sound pressure level", weighted, f"{figures.level:.1f} dB")]
    if figures.loudness is not None:
        name = "loudness" if figures.steady else "loudness N5"
        rows.append(Headline(name, f"{engineering(figures.loudness, 3)} sone", "ISO 532-1, free field"))
    if figures.sharpness is not None:
        rows.append(Headline("sharpness", f"{engineering(figures.sharpness, 3)} acum", "DIN 45692"))
    if figures.tones:
        tones = ", ".join(f"{number(hertz, 4)} Hz" for hertz, _ in figures.tones)
        rows.append(Headline("prominent tones", tones, "ECMA-418-1"))
    return tuple(rows)


def _page(audio: HeardRun) -> Page:
    title = f"{_noun(audio).capitalize()} of the run"
    text = f"{audio.remark[0].upper()}{audio.remark[1:]}."
    section = Section(title, text, figures=(_level_figure(audio),))
    return Page("A run heard through its housing", "", _headlines(audio), (section,))


def _series(audio: HeardRun) -> Table:
    table = _level_figure(audio).table
    assert table is not None
    return table


PAGE = Presentation(
    _level_figure, _page, lambda audio: (audio.recording.quantity, audio.remark), series=_series
)
