"""Verification of the package's results, and comparison with other methods.

Not in the wheel. It imports the package ``model``, which never imports it; ``benchmarks`` uses it.

- ``problems``, ``methods``: problems to integrate, and methods that integrate them
- ``work_precision``: cost against true error on the study's cases (section of the report)
- ``hard_cases``: every method on scenes that are hard to integrate (section of the report)
- ``fixed_steps``: points of figures that fixed steps get wrong
- ``without_location``: the engine without event location that these compare with
- ``independent``: a second statement of the model on scipy
- ``trials``, ``accuracy``: error estimates on random sets (``make accuracy``)
- ``fuzz``: properties of every run, on sets over the whole domain (``make fuzz``)
- ``report``: the sections and their figures
"""
