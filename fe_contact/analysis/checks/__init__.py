"""Assumptions of a run and laws of its table, checked on its results, and the ledger of effects."""
