"""Verification of the package's results.

Not in the wheel. It imports the package ``model``, which never imports it; ``benchmarks`` uses it.

- ``independent``: a second statement of the model on scipy
- ``trials``, ``accuracy``: error estimates on random sets (``make accuracy``)
- ``fuzz``, ``fuzz_campaign``: properties of runs on sets over the whole domain (``make fuzz``)
"""
