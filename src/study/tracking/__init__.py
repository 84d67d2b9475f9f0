"""Provenance of jobs, the history of all runs, and the comparison with the reference."""


class TrackingError(ValueError):
    """A record that cannot be read, a name without a record, or a run that must not start."""
