"""The main computation, from a gear pair to its STE database, and the results on the flanks."""
