"""The claims ledger: the paper's statements, judged by the datasets.

``claims.yaml`` states the claims, and ``claims`` loads and checks them. Each names a function of
``measures`` or ``comparisons`` that computes a number from datasets, which ``data`` reads.
``ledger`` judges the number.
"""

from model.study.claims.claims import CLAIMS
from model.study.claims.ledger import VERDICTS, Judgement, judge, tally

__all__ = ["CLAIMS", "VERDICTS", "Judgement", "judge", "tally"]
