"""Figures and tables of STE tables in a report."""
