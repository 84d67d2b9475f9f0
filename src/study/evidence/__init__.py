"""Worth of the verdicts (decision 43).

``null`` has the verdicts on devices drawn at random, which are stored; ``cases`` judges the study's
device off by a little and under other assumptions, and other devices.
"""
