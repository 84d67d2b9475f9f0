"""Provenance of jobs, the index of all runs, and the comparison with the reference."""
