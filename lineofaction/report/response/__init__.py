"""Figures and tables of modes, forced responses and steady states in a report."""
