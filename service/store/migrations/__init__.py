"""Steps from schema to schema of the database, in order."""

REVISIONS = (
    "0001",
    "0002",
    "0003",
    "0004",
    "0005",
    "0006",
    "0007",
    "0008",
    "0009",
    "0010",
    "0011",
    "0012",
    "0013",
    "0014",
)
"""All schemas there have been, the newest last."""
USABLE_SINCE = "0007"
"""The oldest schema whose program can use the newest one: all steps behind it only add.

Programs of two versions work on one database during an upgrade. A step that removes or renames moves it up.
"""
