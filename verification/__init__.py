"""Verification of the package's results, and its speed beside that of other methods.

Not in the wheel. It imports the packages, which never import it.

- ``independent``: a second statement of the model on scipy
- ``round``: a round peg in space, against which the equations of its tips are held
- ``trials``, ``accuracy``: error estimates on random sets (``make accuracy``)
- ``fuzz``, ``fuzz_campaign``: properties of runs on sets over the whole domain (``make fuzz``)
- ``bench``: cost at equal true error, for the report and ``make bench``
"""
