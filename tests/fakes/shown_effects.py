"""The effect ledger of a study of a scene beside what its terminal output and its report show."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any


def check_effects_shown(ledger: Mapping[str, Any], printed: str, report: str) -> None:
    assert len(ledger["entries"]) > 3
    for entry in ledger["entries"]:
        row = "".join(f"<td>{cell}</td>" for cell in (entry["part"], "yes" if entry["on"] else "no"))
        assert f'<th scope="row">{entry["effect"]}</th>{row}' in report
        assert f"<td>{escape(entry['reason'])}</td>" in report
        assert entry["effect"] in printed or not (entry["on"] or entry["possible"])
    assert "<td>nothing</td>" in report and "<td>0 µm at" not in report
    for name in ledger["left_out"]:
        assert name.replace("_", " ") in report
