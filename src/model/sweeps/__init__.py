"""Runs over grids of parameters: axes, settings, starts, sweeps, their datasets and their files."""
