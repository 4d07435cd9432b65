"""Figures and tables of flanks and roots in a report."""
