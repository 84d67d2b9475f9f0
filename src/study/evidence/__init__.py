"""Worth of the verdicts (decision 43).

``null`` judges devices drawn at random, ``assumptions`` the study's device under other assumptions,
and ``worth`` weighs the ledger by what random devices show.
"""
