"""The studies, a package each with inputs, figures and work. Their rows are in `registry`."""
