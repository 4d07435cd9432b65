"""Compiled functions: their compiler, tuples handed over by address, the state that laws share."""
