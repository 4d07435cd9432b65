"""Steps from schema to schema of the database, in order."""

REVISIONS = ("0001", "0002", "0003", "0004", "0005", "0006", "0007", "0008", "0009", "0010")
"""All schemas there have been, the newest last."""
