"""Gears as they were measured: traces of an inspection, and the deviations of a case from them."""
