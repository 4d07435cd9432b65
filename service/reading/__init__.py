"""Foreign bytes are read here: those of each request by a confined child, within one set of limits."""
