"""Drawings of runs, curves and maps, their style, and the device sheet."""
