"""The claims ledger: the paper's statements, judged by the datasets.

``claims.yaml`` states the claims, and ``claims`` loads and checks them. They name the numbers of
``measures`` and ``comparisons``, which are taken of datasets as ``data`` reads them. ``ledger``
judges the numbers.
"""

from model.study.claims.claims import CLAIMS, Claim
from model.study.claims.ledger import VERDICTS, Finding, judge, tally

__all__ = ["CLAIMS", "VERDICTS", "Claim", "Finding", "judge", "tally"]
