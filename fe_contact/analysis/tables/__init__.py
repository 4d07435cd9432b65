"""Positions of a table, and what is solved at them."""
