"""The readable reference engine: one run at a time."""
