"""Answers to operators: health, readiness and metrics of one process, and the port for them."""
