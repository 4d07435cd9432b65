"""Figures and tables of housings and their sound in a report."""
