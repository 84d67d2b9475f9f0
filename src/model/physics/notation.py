"""Frame, symbols and state vector of the whole package.

Everything is dimensionless (paper, sect. 2): lengths in units of the excitation amplitude F1/K_Y,
time in units of 1/p with p² = K_Y/M, forces in units of F1, so mass and axial stiffness are 1.

::

                 e_n                      C    centre of mass, at (x, y)
                  ^   D1                  φ    tilt, counter-clockwise, 0 = upright
            .-----|---.                   e_t  = ( cos φ, sin φ), along the bottom face
            |     C---|--> e_t            e_n  = (-sin φ, cos φ), along the axis of the part
            |         |                   B1   = C + a e_t - b e_n   right bottom corner
      D2    '---------'                   B2   = C - a e_t - b e_n   left bottom corner
           B2         B1                  D2   = C - a e_t + b e_n   left top corner
     ________           _________         A1   = (+l, 0)             right edge of the slot
             |A2  O  A1|             y    A2   = (-l, 0)             left edge of the slot
             |         |             ^
             |  slot   |             |    The part starts displaced to the right, its bottom face
                                     +--> x    on A1; B2 hangs over the slot and dips into it.

For an edge A = (±l, 0): ``r = A - C``; ``s = r·e_t`` is the coordinate of the edge along the bottom
face and ``r·e_n`` that along the axis. If the edge lies exactly on the face, s is the paper's
q = (l - x)/cos φ - b tan φ.

The state vector is ``(x, y, φ, ẋ, ẏ, φ̇)``, everywhere in this order.
"""

from typing import NamedTuple

# The two edges of the slot, as the sign of their abscissa. Corner B1 is on the side of the right
# edge, and B2 on that of the left edge.
RIGHT_EDGE = 1.0
LEFT_EDGE = -1.0


class State(NamedTuple):
    """The state vector by name; rates are derivatives with respect to τ."""

    x: float
    y: float
    tilt: float
    x_rate: float
    y_rate: float
    tilt_rate: float


STATE_SIZE = len(State._fields)
