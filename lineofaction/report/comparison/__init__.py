"""Comparison of two results, or of a result with a measurement: differences with their errors."""
