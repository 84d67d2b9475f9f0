"""Stability maps: plan, refined lattice, computation, starts of the ensemble, and dataset.

Nothing is exported here: a job depends only on the modules that it imports.
"""
