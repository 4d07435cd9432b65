"""Error estimates of tables: meshes, slices, positions, axes."""
