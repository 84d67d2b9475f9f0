"""Devices that are known in part: what is possible, what trials tell of it, what to measure next.

- ``possible``: sets of the unknowns, and their runs from every touch-down; is a device reliable?
- ``doubt``: what decides a verdict, and what knowing an unknown would be worth.
- ``settings``: which setting covers most of what is possible (design).
- ``trials``, ``likelihood``, ``posterior``, ``fit``, ``next_trial``, ``calibrate``: trials.
"""
