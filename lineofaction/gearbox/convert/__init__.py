"""Conversion between the boundary and the libraries, the only place that knows mm, um, degrees and rpm."""
