"""Sine and cosine as plain arithmetic, which a compiler can vectorise, and the square root.

A call of the system's mathematics library cannot be vectorised, and its last bits differ between
systems. Reduction by π/2 in three parts after Cody and Waite, Software Manual for the Elementary
Functions (1980), ch. 8; minimax polynomials on [-π/4, π/4] from fdlibm (Sun Microsystems, 1993).
"""

from math import floor, sqrt

from model.compile.kernels import operation

_TWO_OVER_PI = 6.36619772367581382433e-01
# π/2 in parts of 33 bits: n times each of the first two is exact for |n| < 2^20.
_HALF_PI_1 = 1.57079632673412561417e00
_HALF_PI_2 = 6.07710050630396597660e-11
_HALF_PI_3 = 2.02226624879595063154e-21


@operation
def sine_cosine(angle):
    """Return (sin, cos) of ``angle`` in radians, to 3e-16 below 1e6; beyond, the error grows."""
    n = floor(angle * _TWO_OVER_PI + 0.5)
    r = angle - n * _HALF_PI_1 - n * _HALF_PI_2 - n * _HALF_PI_3
    z = r * r
    s = -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
    s = 2.75573137070700676789e-06 + z * s
    s = -1.98412698298579493134e-04 + z * s
    s = 8.33333333332248946124e-03 + z * s
    s = r + r * z * (-1.66666666666666324348e-01 + z * s)
    c = 2.08757232129817482790e-09 + z * -1.13596475577881948265e-11
    c = -2.75573143513506633035e-07 + z * c
    c = 2.48015872894767294178e-05 + z * c
    c = -1.38888888888741095749e-03 + z * c
    c = 1.0 - 0.5 * z + z * z * (4.16666666666666019037e-02 + z * c)
    quadrant = n - 4.0 * floor(0.25 * n)  # 0, 1, 2 or 3 quarter turns
    odd = quadrant == 1.0 or quadrant == 3.0
    sine, cosine = (c, s) if odd else (s, c)
    return (
        -sine if quadrant >= 2.0 else sine,
        -cosine if quadrant == 1.0 or quadrant == 2.0 else cosine,
    )


@operation
def square_root(value):
    """Return the square root of ``value``."""
    return sqrt(value)
