"""The sound of a plot in a page: players that need no script, and a cursor on the plot by one."""

from __future__ import annotations

import base64
import json
from html import escape
from importlib.resources import files
from typing import Any

from lineofaction.report.drawing.figure import Figure, Sound, numbers

Json = dict[str, Any]
SCRIPT, STYLE_SHEET = "player.js", "player.css"
"""The page of the service has the same."""
# In this page players stand in the document: the script joins them to their plot once that is drawn.
_JOINED = """
for (const group of document.querySelectorAll(".player")) {
  const sound = JSON.parse(group.querySelector("script").textContent);
  joined(group, group.closest("figure").querySelector(".plot"), sound);
}
"""


def player(figure: Figure) -> str:
    """Return the players of a plot's sound; in place of files that are too large a sentence."""
    if figure.sound is None:
        return ""
    files = figure.sound.files
    caption = f"<p>{escape(figure.sound.caption)}</p>"
    if not files:
        return f"{caption}<p>Too long for this page: write it to a file by loa listen.</p>"
    tracks = "".join(
        f'<label>{escape(track.name)} <audio controls preload="metadata" '
        f'src="data:audio/wav;base64,{base64.b64encode(file).decode("ascii")}"></audio></label>'
        for track, file in zip(figure.sound.tracks, files, strict=True)
    )
    title = escape(f"Sound: {figure.title}", quote=True)
    about = json.dumps(sound_json(figure.sound), allow_nan=False).replace("<", "\\u003c")
    script = f'<script type="application/json">{about}</script>'
    return f'<div class="player" role="group" aria-label="{title}">{tracks}{caption}{script}</div>'


def sound_json(sound: Sound) -> Json:
    """Return what the script needs of a sound."""
    tracks = [
        {"name": one.name, "query": one.query, "time": numbers(one.time), "along": numbers(one.along)}
        for one in sound.tracks
    ]
    return {"caption": sound.caption, "tracks": tracks}


def player_script() -> str:
    """Return the script that joins players and plots, as a module."""
    return f'<script type="module">{_text(SCRIPT)}{_JOINED}</script>'


def player_style() -> str:
    """Return the style sheet of players and cursor."""
    return _text(STYLE_SHEET)


def _text(name: str) -> str:
    return (files(__package__) / name).read_text("utf-8")
