"""The claims ledger: the paper's statements, judged by the datasets.

``claims.yaml`` states the claims, ``measures`` and ``comparisons`` hold the functions that it
names, ``reading`` the views of datasets they take, ``ledger`` the verdicts, ``runs`` the
trajectories that claims need beside the figures', ``table`` the file on disk.
"""

from model.study.claims.claims import CLAIMS, Claim
from model.study.claims.ledger import VERDICTS, Finding, judge, tally

__all__ = ["CLAIMS", "VERDICTS", "Claim", "Finding", "judge", "tally"]
