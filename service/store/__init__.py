"""The store: a database, and content-addressed result files."""
