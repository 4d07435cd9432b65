"""What phases assume is in the text of a run and on its page."""

from lineofaction.report.drawing.tables import ledger_section
from lineofaction.report.presentation import effect_text

ROWS = [
    {
        "part": "middle",
        "words": "angle from a tooth of a to a tooth of b not stated: 0; 5 dB",
        "decibels": 5.0,
    },
    {"part": "middle", "words": "another one"},
]


def test_assumed_phases_are_said_line_by_line():
    lines = [part for part in effect_text({"entries": [], "assumed": ROWS}) if isinstance(part, str)]
    assert lines == [f"Assumed of middle: {row['words']}" for row in ROWS]
    assert not [part for part in effect_text({"entries": []}) if isinstance(part, str)]


def test_assumed_phases_are_a_table_of_the_page():
    section = ledger_section({"entries": [], "assumed": ROWS})
    (table,) = [table for table in section.folded if "Assumed" in table.caption]
    assert table.rows == tuple(("middle", row["words"]) for row in ROWS)
    assert not any("Assumed" in table.caption for table in ledger_section({"entries": []}).folded)
