"""Settings of a run: readings, scene, start, tolerance and horizon, with their checks."""

import math
import numbers
from dataclasses import dataclass, field, fields, replace
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from model.engine.lifecycle import NOISE, Control
from model.engine.record import AT
from model.events.insertion import INSERTION
from model.events.kernels import SceneEvents, in_kernels
from model.events.outcomes import Outcome
from model.events.scenes import ALIGNMENT, Scene
from model.physics.approach import Start, rows_of_start
from model.physics.parameters import Batch, Shape, check_name
from model.physics.tables import Value
from model.physics.variants import Variants

SCENES: dict[str, Scene] = {scene.name: scene for scene in (ALIGNMENT, INSERTION)}
"""Scenes that devices and maps may ask for, by name."""

# Largest tolerance from which the noise of settling follows: at looser ones a creep towards
# alignment would count as noise.
_SETTLING = 1e-8


def _is_number(value: Any) -> bool:
    """Return whether a value is a real number; True and False are none."""
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Settings(Value):
    """Settings of a run: everything that is not a parameter of the device.

    Attributes:
        readings: variants of the paper's equations.
        shape: "round" for a round part in a round hole, "square" for the paper's plane one beside a
            slot. A round part needs the consistent readings. None for the shape that the device's
            file states, and "square" where it states none.
        scene: the contacts that are modelled; with ``INSERTION`` a run continues after alignment
            until the part is inserted, for the horizon once more.
        start: "simultaneous": the press and the vibration set in together, on a part that touches
            the base without load (paper). "pressed": the part rests under the press, which has
            risen slowly, and then the vibration sets in; needs the consistent readings. The
            initial tilt then has no effect. A part that finds no rest leaves the scene at once.
            "running" and "still": the part is lowered at its ``approach_speed``, with the tilt
            ``rest_tilt``, vibrating or not; see ``Start``. These need the consistent readings, and
            the initial tilt has no effect. Times and the horizon count from the first touch or, of
            "still", from the onset of the vibration; the horizon is longer by the time for which
            the holder goes on being lowered. None for the start that the device's file states,
            and "simultaneous" if it states none.
        insertion_depth: depth at which a part counts as inserted, > 0, dimensionless, with
            ``INSERTION`` only; by default that of ``Batch.insertion_depths``.
        horizon: latest time τ of a run, > 0, dimensionless.
        tolerance: largest local error of a step, 1e-14 to 1e-2, relative to ``1 + |state|``;
            ``align`` and ``simulate`` run at a hundredth of it, but not below 1e-14.
        max_evaluations: largest number of right-hand-side evaluations of one integration, >= 1.
        may_settle: stop a run in periodic steady state, which never aligns.
        alignment_only: end a run at alignment without computing the largest tilt and force:
            ``tilt_max`` and ``contact_force_max`` are NaN, and so is ``tau_corners_inside`` unless
            it is the criterion of alignment.

    Raises:
        TypeError: a setting of the wrong type.
        ValueError: a setting out of range.
    """

    readings: Variants = field(default_factory=Variants)
    shape: Shape | None = None
    scene: Scene = ALIGNMENT
    start: Start | None = None
    insertion_depth: float | None = None
    horizon: float = 300.0
    tolerance: float = 1e-10
    max_evaluations: int = 20_000_000
    may_settle: bool = True
    alignment_only: bool = False

    def __post_init__(self) -> None:
        for name in ("horizon", "tolerance", "max_evaluations"):
            if not _is_number(getattr(self, name)):
                raise TypeError(f"{name} = {getattr(self, name)!r}: must be a number")
        for name in ("may_settle", "alignment_only"):
            if not isinstance(getattr(self, name), bool | np.bool_):
                raise TypeError(f"{name} = {getattr(self, name)!r}: must be True or False")
        kinds = {"readings": Variants, "scene": Scene}
        for name, kind in kinds.items():
            if not isinstance(getattr(self, name), kind):
                called = "Readings" if kind is Variants else kind.__name__  # as the API calls them
                raise TypeError(f"{name} = {getattr(self, name)!r}: must be a {called}")
        if self.start is not None:
            check_name(self.start, get_args(Start), "start")
        if self.shape is not None:
            check_name(self.shape, get_args(Shape), "shape")
        if self.shape == "round" and self.readings != Variants.consistent():
            raise ValueError(
                "shape = 'round': needs the consistent readings; choose them or 'square'"
            )
        if self.number_of_start and self.readings != Variants.consistent():
            raise ValueError(
                f"start = {self.start!r}: needs the consistent readings; choose them or "
                "'simultaneous'"
            )
        if self.start == "pressed" and "edge_on_face" not in self.scene.contacts:
            raise ValueError(
                f"start = 'pressed': the scene {self.scene.name!r} must declare edge_on_face"
            )
        depth = self.insertion_depth
        if depth is not None and not (_is_number(depth) and 0.0 < depth < math.inf):
            raise ValueError(f"insertion_depth = {depth!r}: must be a finite number > 0, or None")
        if depth is not None and self.success is not Outcome.INSERTED:
            raise ValueError(
                f"insertion_depth = {depth!r}: a run ends at alignment; use the insertion scene"
            )
        if not (self.horizon > 0.0 and math.isfinite(self.horizon)):
            raise ValueError(f"horizon = {self.horizon!r}: must be a finite number > 0")
        if not 1e-14 <= self.tolerance <= 1e-2:
            raise ValueError(f"tolerance = {self.tolerance!r}: must be between 1e-14 and 1e-2")
        if not 1 <= self.max_evaluations < math.inf:
            raise ValueError(f"max_evaluations = {self.max_evaluations!r}: must be finite and >= 1")

    @property
    def success(self) -> Outcome:
        """Outcome of a run that ends well: INSERTED in the insertion scene, else ALIGNED.

        A run of any scene that is ``alignment_only`` ends ALIGNED.
        """
        inserts = self.scene.name == INSERTION.name and not self.alignment_only
        return Outcome.INSERTED if inserts else Outcome.ALIGNED

    @property
    def quickest(self) -> "Settings":
        """These settings, ``alignment_only`` where a run ends at alignment."""
        return replace(self, alignment_only=self.success is Outcome.ALIGNED)

    def rows(self, batch: Batch) -> NDArray[np.float64]:
        """Return the constants of every parameter set as kernels take them.

        Raises:
            ValueError: a set does not fit the start; see ``rows_of_start``.
        """
        return rows_of_start(batch.constants(self.readings, self.insertion_depth), AT, self.start)

    @property
    def number_of_start(self) -> int:
        """Number of the start in kernels."""
        return 0 if self.start is None else get_args(Start).index(self.start)

    @property
    def for_kernels(self) -> tuple[SceneEvents, Control]:
        """Scene and control in the form that kernels take."""
        return in_kernels(self.scene, self.shape == "round"), self.control

    @property
    def control(self) -> Control:
        """Limits and flags of a run in the form that kernels take."""
        return Control(
            float(self.horizon),
            int(self.max_evaluations),
            NOISE * min(self.tolerance, _SETTLING) if self.may_settle else 0.0,
            float(self.alignment_only),
            float(self.number_of_start),
        )


def settings_with(settings: Settings | None, changes: dict[str, Any]) -> Settings:
    """Return ``settings``, or the default ones, with ``changes``.

    Raises:
        TypeError: not a ``Settings``, or a setting of the wrong type.
        ValueError: an unknown setting, or one out of range.
    """
    if settings is not None and not isinstance(settings, Settings):
        raise TypeError(f"settings = {settings!r}: must be a Settings")
    for name in changes:
        if name == "engine":
            raise ValueError("engine: leave it out: since release 2 there is one engine")
        check_name(name, [each.name for each in fields(Settings)], "setting")
    if isinstance(scene := changes.get("scene"), str):
        check_name(scene, [*SCENES], "scene")
        changes = {**changes, "scene": SCENES[scene]}
    return replace(settings or Settings(), **changes)
