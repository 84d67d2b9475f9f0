"""The study of the paper, run from a checkout.

The rooms, from the bottom up:

- ``config``: the files in config/, checked; ``plans``: the sweeps that they ask for.
- ``claims``: the paper's claims, judged by datasets; ``jamming``: the jamming diagram.
- ``identification``: the search for what the paper leaves unstated; ``evidence``: random devices.
- ``plots``, ``jamming_plot``, ``schematics``: the pictures; ``explorer``: the page that runs live.
- ``outline``: source code without what changes nothing that runs, for hashes.
- ``tracking``: a record of every job and every start; the accepted reference.
- ``report``: the page on the whole study; ``commands``: ``python -m study``.
"""
