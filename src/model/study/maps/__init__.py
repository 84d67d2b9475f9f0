"""Stability maps: plan, refined lattice, computation, starts of the ensemble, and dataset.

Import what is needed from the modules, so that a job depends on these alone.
"""
