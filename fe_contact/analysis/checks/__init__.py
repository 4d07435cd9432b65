"""Assumptions of a run, checked on its results, and the ledger of effects."""
