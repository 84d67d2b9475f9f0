"""How the paper's printed equations are read: one named switch per misprint or open question.

Each switch is ``"consistent"`` (the default) or ``"printed"``. R numbers are used in the figures
and the documentation; R7 of that list (F1 must be an amplitude) cannot be run either way.
"""

from dataclasses import dataclass, fields
from typing import Literal, get_args

Reading = Literal["consistent", "printed"]


@dataclass(frozen=True, kw_only=True)
class Readings:
    """The switches; each value is ``"consistent"`` or ``"printed"``.

    Attributes:
        normal_sign: R1. Sign of the contact's horizontal component U1. The print has it of the
            mirror image: sin φ - μ cos φ instead of μ cos φ - sin φ.
        friction_law: R2. Printed: T = +μ n whatever the slip. Consistent: Coulomb, with sticking.
        contact_damping_law: R3. Printed: n = k_a d - h_a √(ẋ² + ẏ²), a speed where a closing rate
            belongs. Consistent: n = k_a d + h_a ḋ. Both are clamped at 0.
        side_gap: R4. Printed: the left side's depth is D2 as printed, which mixes x and y terms.
            Consistent: distance of A2 from the line B2 D2.
        side_force: R5. Printed: n at A2 enters (3) as n at A1 does, with A2's q. Consistent: the
            force acts along the normal of the side face, e_t.
        preload: R6. Printed: (3) drops y_st, so the axial spring is relaxed at y = 0 and
            ``rest_y`` is ignored. Consistent: y_st = ``rest_y``.
        alignment_criterion: R8. Printed: the paper's four corner conditions. Consistent: the
            contact is lost because the edge A1 has passed the corner B1 while B2 is in the slot.
        moment_arms: R9. Printed: arms q and b of the undeformed contact. Consistent: s and b - d.

    Raises:
        ValueError: a value that is neither ``"consistent"`` nor ``"printed"``.
    """

    normal_sign: Reading = "consistent"
    friction_law: Reading = "consistent"
    contact_damping_law: Reading = "consistent"
    side_gap: Reading = "consistent"
    side_force: Reading = "consistent"
    preload: Reading = "consistent"
    alignment_criterion: Reading = "consistent"
    moment_arms: Reading = "consistent"

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value not in get_args(Reading):
                raise ValueError(
                    f"readings.{field.name} = {value!r}: must be 'consistent' or 'printed'"
                )

    @classmethod
    def consistent(cls) -> "Readings":
        """Every misprint mended (the default)."""
        return cls()

    @classmethod
    def printed(cls) -> "Readings":
        """The equations as the paper prints them."""
        printed: dict[str, Reading] = dict.fromkeys(READING_NAMES, "printed")
        return cls(**printed)

    def is_printed(self, name: str) -> float:
        """1.0 where switch ``name`` is printed, else 0.0: the form that kernels take."""
        return float(getattr(self, name) == "printed")


READING_NAMES: tuple[str, ...] = tuple(field.name for field in fields(Readings))
