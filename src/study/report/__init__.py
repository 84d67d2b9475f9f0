"""The report: one HTML page of sections, which holds its pictures and loads nothing else.

A section is a function of ``Results`` that returns a ``Section``, and a template in this folder.
To add one, write both and name the function in ``page.FINDINGS``.
"""
