"""Where the line is drawn, and why: set by what a sentence says and by what a reader can see.

A printed figure of the paper's size shows a twentieth of an axis or of a duration; a tenth can be
told from equality at a glance. Which were mended after verdicts were seen stands in decision 17.
"""

import math
from dataclasses import dataclass, replace

from model.study.claims.reading import asymmetry


@dataclass(frozen=True)
class Limit:
    """What a number must reach.

    Attributes:
        threshold: NaN where there is nothing to measure.
        is_least: whether the number must be above the threshold, otherwise below.
        scale: what counts as one unit of margin.
        reason: why the threshold is where it is, or why there is nothing to measure.
    """

    threshold: float
    is_least: bool
    scale: float
    reason: str

    def margin(self, value: float) -> float:
        """How far a number is on the right side: in (-1, 1), positive if it is; -1 for NaN."""
        if math.isnan(value):
            return -1.0
        distance = (value - self.threshold) / self.scale * (1.0 if self.is_least else -1.0)
        if math.isinf(distance):
            return math.copysign(1.0, distance)
        return distance / (1.0 + abs(distance))

    def also(self, reason: str) -> "Limit":
        """The same, with more to say of it."""
        return replace(self, reason=f"{self.reason}; {reason}")

    @property
    def demand(self) -> str:
        """The threshold in words."""
        return f"at {'least' if self.is_least else 'most'} {self.threshold:.3g}"


def at_least(threshold: float, scale: float, reason: str) -> Limit:
    """The number must be above ``threshold``."""
    return Limit(threshold, True, scale, reason)


def at_most(threshold: float, scale: float, reason: str) -> Limit:
    """The number must be below ``threshold``."""
    return Limit(threshold, False, scale, reason)


def unmeasured(reason: str) -> Limit:
    """There is nothing to measure."""
    return Limit(math.nan, True, 1.0, reason)


_TREND = 0.8
_ORDERED = (
    "1 is a rise without exception, 0 no trend, -1 a fall: nine of ten pairs of points must be in "
    "the order that is claimed"
)
RISES, FALLS = at_least(_TREND, 1.0, _ORDERED), at_most(-_TREND, 1.0, _ORDERED)

_RESERVE = "said without reserve; a twentieth is left for the border"
NEARLY_ALL, HARDLY_ANY = at_least(0.95, 0.5, _RESERVE), at_most(0.05, 0.5, _RESERVE)

TENTH = 1.1
A_TENTH_MORE = at_least(TENTH, 0.5, "a tenth more can be told from equality in a printed figure")
A_TENTH_STEEPER = at_least(
    asymmetry(TENTH, 1.0), 0.5, "a tenth more can be told from equality in a printed figure"
)
SIGNIFICANT = at_least(
    1.2, 0.5, "significant, considerable: a fifth, twice what can just be told from equality"
)
VISIBLE = at_least(0.05, 0.2, "a twentieth is what can just be seen in a printed figure")
WIDER = at_least(0.03, 0.2, "three hundredths of the axis: one point of the coarsest grid judged")
