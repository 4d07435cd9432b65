"""Figures of a report, and the page and images that hold them."""
