"""The studies, a package each: what is varied, the work, the page. Their rows are in `service.registry`."""
