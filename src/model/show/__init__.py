"""Top floor: what people see. Drawings, plots, the report, the command line."""
