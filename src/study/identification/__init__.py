"""The search for the parameters that the paper leaves unstated (decision 19).

``space`` has the unknowns and what sweeps they stand for, ``batch`` computes the figures of many
devices at once, and ``search`` finds the device by the ledger and the limits of the regime.
"""
