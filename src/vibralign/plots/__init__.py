"""Show results: figures, schematics, device sheets, the report and the explorer."""
