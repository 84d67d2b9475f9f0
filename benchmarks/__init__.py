"""Speed of vibralign and of other integrators on the same problems, at equal true error.

``make bench`` runs this in an environment of its own (``.venv-bench``), which the study never
needs; ``make bench BENCH_FLAGS=--quick`` gives a rough table. Results: the table on the terminal,
``results/benchmarks/peers.csv`` with the same numbers, and ``machine.json`` with the processor, the
versions, and the times of start, compilation and a second core.

Problems, methods of the package, and the search for equal error are those of ``verification``. For
each method, problem and target it seeks the loosest tolerance whose true error keeps the target;
the cost is the CPU time of a trajectory at that tolerance: medians of rounds in which all methods
take turns, compiled code warmed up, on one core. True values are the package's own at a tolerance
of 1e-13; peers come within 2e-10 of them (3e-12 on W1 to W3). An error is the largest over the
answers of a case (alignment time, or six states at ten times), and of the cases the 90th
percentile.

- ``equations``: the peers' own statement of the physics, once for numbers and for expressions
- ``modes``: the peers' modes, event functions and restarts, compiled
- ``methods``: a module for each peer
- ``machine``: times that depend on no problem
- ``table``: ratios
- ``maps``: maps that follow their boundary against full grids (``--maps`` for these alone)
- ``truth``: alignment times against heyoka and MuJoCo (``make truth``)
"""
