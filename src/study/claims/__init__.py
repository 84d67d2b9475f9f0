"""The claims ledger: the paper's statements, judged by the datasets.

``claims.yaml`` states the claims, and ``claims`` loads and checks them. Each names a function of
``measures`` that computes a number from columns of tables, which ``data`` makes of datasets.
``ledger`` judges the number.
"""

from study.claims.claims import CLAIMS
from study.claims.data import Tables
from study.claims.ledger import VERDICTS, Judgement, judge, tally

__all__ = ["CLAIMS", "VERDICTS", "Judgement", "Tables", "judge", "tally"]
