"""Error against cost: for a section of the report, and against other methods by ``make bench``.

Not in the wheel. Methods are compared by their cost at the same true error. True values are
the independent solution's in the report's usual cases, else the package's own at a far smaller
tolerance.

Shared by both:

- ``problems``: parameter sets to run, and solutions
- ``methods``: ways to solve a problem: the package, and ``peers`` for ``make bench``
- ``work_precision.climbed``: the ladder of tolerances, from coarse to fine

The report's section, with data and CPU times from the workflow:

- ``plans``: what it computes, from the configuration
- ``work_precision``: cost against true error, on usual and on hard cases
- ``report``: the section

``make bench`` runs in an environment of its own (``.venv-bench``), which the study never needs;
``make bench BENCH_FLAGS=--quick`` gives a rough table. A method climbs the ladder to the first
tolerance with a true error of at most 1e-8, and is timed there: compiled, on one core, as median of
rounds in which all methods take turns. Results: the table on the terminal, and
``results/benchmarks/peers.csv`` with the same numbers.

- ``equations``: the peers' own statement of the physics, its modes and events
- ``trajectories``: the problems
- ``table``: settings, times and ratios
- ``store``: keeps the independent solutions of the study's cases
"""
