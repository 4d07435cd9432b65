"""Figures and tables of runs in a report."""
