"""The studies, a package each: what is varied, and the work. Their rows are in `registry`."""
