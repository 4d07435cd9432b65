"""Computations of validation cases that no single function or verb answers."""
