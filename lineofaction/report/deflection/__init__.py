"""Figures and tables of a deflected gearbox in a report."""
