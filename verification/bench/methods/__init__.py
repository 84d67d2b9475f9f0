"""The methods of ``make bench``; the report runs the package alone.

To add a method, write a subclass of ``base.Method``, and name it in ``peers``.
"""
