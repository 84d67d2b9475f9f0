"""Top floor: drawings, plots and the report."""
