"""The studies, a package each: what is varied, and the work. Their rows are in the registry of the gearbox."""
