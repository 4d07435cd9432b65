"""Results as figures, tables, pages and documents."""
