"""The version of the contact solver, which is in the content hash of every table."""

SOLVER_VERSION = "17"
