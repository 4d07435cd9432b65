"""JSON bodies of the service alone."""
