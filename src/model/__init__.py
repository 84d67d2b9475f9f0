"""The model: vibratory alignment of a peg with a hole. Each room imports only from those above it.

- ``compile``: kernels, plain Python functions, become machine code or WebAssembly.
- ``physics``: parameters, units, geometry, contacts, forces, equations of motion.
- ``events``: what happens to the contacts, as a table; outcomes of runs; scenes.
- ``engine``: integration from event to event; what a run records.
- ``runs``: settings, runs of one device or many, their errors.
- ``sweeps``: grids of runs as plans, and the datasets that hold their results.
"""
