"""Which parameters make the model show what the paper says its figures show.

``candidate`` turns points of the search space into devices and figures, ``evaluate`` computes
coarse figures of many candidates at once and judges them, ``search`` looks for the best,
``results`` says what was found.
"""
