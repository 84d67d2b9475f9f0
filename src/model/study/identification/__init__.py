"""The identification: parameters with which the model shows what the paper says of its figures.

``candidate`` is the search space, ``evaluate`` computes coarse figures of many candidates at
once, ``score`` judges them by the claims, ``search`` looks for the best, ``results`` gathers all
searches, ``committed`` holds the tables that the study reads.
"""
