"""Variants of the paper's equations: one switch for every misprint or open question.

R1 to R9 number them in docs/paper.md. R7, that F1 must be an amplitude, has no switch:
the equations cannot be run as printed.
"""

from dataclasses import dataclass, fields
from typing import Literal, get_args

Variant = Literal["consistent", "printed"]


@dataclass(frozen=True, kw_only=True)
class Variants:
    """Choice of the equations; every switch is ``"consistent"`` (the default) or ``"printed"``.

    Attributes:
        normal_sign: R1. Sign of the contact's horizontal component U1. Printed: that of the mirror
            image, sin φ - μ cos φ. Consistent: μ cos φ - sin φ.
        friction_law: R2. Printed: T = +μ n for any slip. Consistent: Coulomb, with sticking.
        contact_damping_law: R3. Printed: n = k_a d - h_a √(ẋ² + ẏ²), with a speed in place of
            the closing rate. Consistent: n = k_a d + h_a ḋ. Neither pulls: n >= 0.
        side_gap: R4, the depth on the left side. Printed: the gap D2, which mixes x and y terms.
            Consistent: distance of A2 from the line through the corners B2 and D2.
        side_force: R5. Printed: n at A2 enters (3) like n at A1, with A2's q. Consistent: the
            force acts along the normal of the side face, e_t.
        preload: R6. Printed: (3) drops y_st, so the axial spring is relaxed at y = 0 and
            ``rest_y`` is ignored. Consistent: y_st = ``rest_y``.
        alignment_criterion: R8. Printed: the paper's four corner conditions. Consistent: the
            contact is lost because the edge A1 has passed the corner B1 while B2 is in the slot.
        moment_arms: R9. Printed: arms q and b of the undeformed contact. Consistent: s and b - d.

    Raises:
        ValueError: a value that is neither ``"consistent"`` nor ``"printed"``.
    """

    normal_sign: Variant = "consistent"
    friction_law: Variant = "consistent"
    contact_damping_law: Variant = "consistent"
    side_gap: Variant = "consistent"
    side_force: Variant = "consistent"
    preload: Variant = "consistent"
    alignment_criterion: Variant = "consistent"
    moment_arms: Variant = "consistent"

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value not in get_args(Variant):
                raise ValueError(
                    f"readings.{field.name} = {value!r}: must be 'consistent' or 'printed'"
                )

    @classmethod
    def consistent(cls) -> "Variants":
        """Return the variant with every misprint corrected (the default)."""
        return cls()

    @classmethod
    def printed(cls) -> "Variants":
        """Return the variant with every switch ``"printed"``; R7 has no switch."""
        printed: dict[str, Variant] = dict.fromkeys(VARIANT_NAMES, "printed")
        return cls(**printed)

    def is_printed(self, name: str) -> float:
        """Return 1.0 if the switch ``name`` is printed, else 0.0, as kernels take it."""
        return float(getattr(self, name) == "printed")

    @property
    def switches(self) -> tuple[float, ...]:
        """Switches of the equations by ``is_printed``: the last fields of ``Constants``."""
        return tuple(map(self.is_printed, SWITCHES))


VARIANT_NAMES: tuple[str, ...] = tuple(field.name for field in fields(Variants))
SWITCHES = tuple(name for name in VARIANT_NAMES if name != "preload")  # which changes a parameter
