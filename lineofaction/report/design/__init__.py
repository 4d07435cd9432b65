"""Figures and tables of studies of designs in a report: sweeps, tolerances, optimization."""
