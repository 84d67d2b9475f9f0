"""Runs: one trajectory, or a batch of them on several cores, with error estimates."""
