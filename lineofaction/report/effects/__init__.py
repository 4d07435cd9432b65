"""Figures and tables of effects, errors and their cost in a report."""
