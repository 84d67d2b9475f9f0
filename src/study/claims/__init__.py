"""The ledger: statements of the paper, each with all its parts, judged by the figures.

``claims.yaml`` states them, and ``claims`` loads them with their checks: functions of ``checks``
that compute numbers of figures, which ``data`` makes of datasets. ``ledger`` judges them.
"""

from study.claims.claims import CLAIMS
from study.claims.data import figure_of
from study.claims.ledger import VERDICTS, Judgement, judge, tally

__all__ = ["CLAIMS", "VERDICTS", "Judgement", "figure_of", "judge", "tally"]
