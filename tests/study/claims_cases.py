"""Of each claim data that satisfy it, and data that do not."""

import numpy as np

from tests.study.claims_data import (
    AXES,
    IN_SLOT,
    NAN,
    Course,
    Datasets,
    Function,
    bump,
    falling,
    one_run,
    rising,
    runs,
    within,
)

Case = tuple[Datasets, Datasets]


def case(
    figure: str,
    satisfied: Function | float,
    violated: Function | float,
    of: str = "tau",
    **others: Function | float,
) -> Case:
    """Values of a variable, the duration if not named, that satisfy a claim, and that do not."""
    return runs(figure, **{of: satisfied, **others}), runs(figure, **{of: violated, **others})


def matched(at: float, x: float) -> float:
    """Aligns in two opposite quarters of a plane of two axes from 0 to 30 and 10."""
    return 5.0 if (at > 5.0) == (x > 15.0) else NAN


# Of each claim: data that satisfy it, and data that do not.
CASES: dict[str, Case] = {
    "N05": (Course().datasets, one_run(separations=2)),
    **{
        f"N{figure[3:]}": case(figure, 0.0, 2.0, of="separations")
        for figure in AXES
        if figure.startswith("fig")
    },
    "M1": (
        {**runs("centred", excursion=0.0), **runs("misaligned")},
        {**runs("centred", excursion=0.1), **runs("misaligned")},
    ),
    "M1b": (
        {**runs("centred", excursion=lambda t, _: 10.0 * t), **runs("misaligned")},
        {**runs("centred", excursion=lambda t, _: 0.3 * t), **runs("misaligned")},
    ),
    "M2": case("pressed", lambda k, f: f / k, 0.1, of="tilt_end", tau=NAN),
    "M2b": case("fig07", 5.0, within(0.01, 0.3)),
    "M2c": case("pressed", lambda k, f: f / k, lambda k, f: f * k, of="tilt_end", tau=NAN),
    "M2d": ({**Course().datasets, **runs("fig06")}, runs("fig06", unvibrated_tilt=-0.2)),
    "M2f": (
        runs("fig06", tilt_max=0.052, tilt_at_alignment=0.04),  # below its rest
        runs("fig06", tilt_max=0.052, tilt_at_alignment=0.048),
    ),
    "M2g": case("fig06", lambda k, f: -f / k, lambda k, f: (k - 9.0) * f, of="tilt_max"),
    "M3": case(
        "misaligned",
        lambda f, m: 5.0 if f == 1.0 and m < 0.3 else NAN,
        lambda f, m: 5.0 if f == 1.0 and m < 0.22 else NAN,
    ),
    "M3b": case("misaligned", rising, lambda f, _: f),
    "M4b": (
        {**Course().datasets, **runs("fig06")},
        runs("fig06", unvibrated_tilt=lambda _, f: 0.05 if f < 8.0 else 0.001),
    ),
    "M2e": (runs("fig06"), runs("fig06", tilt_max=0.2)),
    "M5": (
        {
            **runs("displaced"),
            **runs("rubbing", side_force_max=lambda _, m: 1.0 if m < 0.2 else 0.0),
        },
        # What does not align may lean on A2.
        runs("displaced", within(5.0, 30.0), side_force_max=lambda _, k: 1.0 if k < 5.0 else 0.0),
    ),
    "M6": (
        {**Course().datasets, **runs("fig06")},
        runs("fig06", tau_corners_inside=lambda _, f: 5.0 if f < 8.0 else np.inf),
    ),
    "M7": (runs("fig06", contact_force_max=lambda _, f: 1.0 + f), runs("fig06")),
    "M10": (
        {**Course().datasets, **runs("fig06", 2.6)},
        runs("fig10", lambda v, _: 6.0 / v),
    ),
    "F5a": (Course().datasets, Course(x=lambda t: 0.2 + 0.0 * t).datasets),
    "F5b": (
        Course().datasets,
        Course(y=lambda t: 4.1 + 0.01 * t, tilt=lambda t: 0.1 - 0.01 * t).datasets,
    ),
    "F5c": (Course().datasets, Course(force=lambda t: np.where(t < 10.0, 1.5, 0.0)).datasets),
    "F5d": (Course().datasets, Course(tilt=lambda t: 0.04 * t).datasets),
    "F5e": (Course().datasets, Course(force=lambda t: np.maximum(3.0 - 0.3 * t, 0.0)).datasets),
    # Some curves that rise and some that fall are no dependence.
    "F5f": case(
        "fig11", lambda _, d: 1.0 - d, lambda m, d: 1.0 + (m - 0.1) * d, of="tilt_at_alignment"
    ),
    "F6a": case(
        "fig06", lambda _, f: 9.0 if f < 2.0 else 5.0, lambda _, f: 4.0 if f < 2.0 else 5.0
    ),
    "F6g": case(
        "fig06", lambda k, f: (9.0 if k < 8.0 else 5.0) / f, lambda k, f: (5.0 + 0.1 * k) / f
    ),
    "F6b": case("fig06", bump, falling),
    "F6f": case("fig06", falling, bump),
    # A range that holes alone limit is scattered.
    "F6c": case("fig06", within(1.0, 6.0), 5.0),
    "F6h": case(
        "fig06",
        lambda k, f: 5.0 if f < 50.0 / k else NAN,
        lambda k, f: 5.0 if f < 3.0 + 0.3 * k else NAN,
    ),
    "F6d": case("fig06", falling, rising),
    "F6e": (
        {**runs("fig06", falling), **runs("fig12", falling)},
        {**runs("fig06"), **runs("fig12", lambda _, f: 5.0 + 0.01 * f)},
    ),
    "F7a": case("fig07", rising, falling),
    "F7b": case(
        "fig07",
        lambda _, m: 5.0 + 10.0 * min(m, 0.1) + m,
        lambda _, m: 5.0 + 10.0 * min(m, 0.1) - m,
    ),
    "F7f": case("fig07", lambda _, m: 5.0 + 90.0 * m**2, lambda _, m: 5.0 + 9.0 * m),
    "F7c": case(
        "fig07", lambda _, m: 5.0 + 10.0 * m, lambda f, m: 5.0 + m if f < 3.0 else 5.0 + 50.0 * m
    ),
    "F7d": case("fig07", lambda f, m: 5.0 + 20.0 * m / f, lambda _, m: 5.0 + 20.0 * m),
    "F7e": case(
        "fig07",
        lambda f, m: 5.0 + (20.0 if f < 3.0 else 2.0) * min(m, 0.15),
        lambda f, m: 5.0 + (2.0 if f < 3.0 else 9.0) * m**2,
    ),
    "F8a": case("fig08", within(8.0, 30.0), 5.0),
    "F8b": case("fig08", falling, rising),
    "F8c": case(
        "fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, lambda v, k: 5.0 if k > 14.0 - v else NAN
    ),
    "F8d": case(
        "displaced",
        lambda v, k: float(k > 3.0 + 2.0 * v),
        lambda v, k: float(k > 23.0 - v),
        of="way",
        tau=NAN,
    ),
    "F8e": case("fig09", lambda f, _: 10.0 / f, lambda f, _: 10.0 * f),
    "F8f": case("rubbing", within(0.0, 0.6), 5.0),
    "F8g": case("fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN, within(5.0, 30.0)),
    "F8h": case("fig08", lambda _, k: 1.0 / k, lambda _, k: k, of="tilt_max"),
    "F8i": case("displaced", 0.2, 0.1, of="tilt_end", tau=within(8.0, 30.0)),
    "F8j": case("fig08", lambda v, _: 5.0 + v, lambda v, _: 5.0 + 0.01 * v),
    "F9a": case("fig09", falling, rising),
    "F9b": case("fig09", lambda f, k: NAN if f > 2.0 and k < 10.0 else 5.0, 5.0),
    # A fall in the stiffer half is not one at first.
    "F9c": case(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 9.0 - 0.4 * max(k - 20.0, 0.0)),
    ),
    "F9i": case("fig09", falling, lambda _, k: abs(k - 14.0)),
    "F9d": case(
        "fig09",
        within(10.0, 30.0, lambda f, k: 4.0 + f * 20.0 / k),
        within(10.0, 30.0, lambda f, k: 4.0 + 20.0 / (f * k)),
    ),
    "F9e": case("fig09", lambda _, k: 1.0 / k, lambda _, k: k, of="tilt_max"),
    "F9f": case("fig09", falling, rising),
    "F9g": (
        runs("rocking", tilt_max=0.055, tilt_min=0.045),
        runs("rocking", tilt_max=0.055, tilt_min=0.03),
    ),
    "F9h": case(
        "fig09",
        within(10.0, 30.0, lambda _, k: 4.0 + 40.0 / (k - 8.0)),
        within(10.0, 30.0, lambda _, k: 9.0 - 0.001 * k**2),
    ),
    "F9j": case("fig09", falling, lambda f, k: k if f > 2.0 else -k, tilt_max=lambda _, k: 1.0 / k),
    "F10": case("fig10", rising, falling),
    "F11a": case("fig11", lambda m, d: 9.0 - 20.0 * d + m, lambda _, d: 2.0 + abs(d - 0.09)),
    "F11b": case(
        "fig11", lambda m, d: 9.0 - 20.0 * d + 10.0 * m, lambda m, d: 9.0 - 20.0 * d - 10.0 * m
    ),
    "F11c": case("fig11", lambda _, d: 9.0 - 20.0 * d, lambda _, d: 9.0 + 20.0 * d),
    # The same course, lifted by friction.
    "F11d": case(
        "fig11", lambda m, d: (1.0 + m) * (9.0 - 20.0 * d), lambda m, d: 9.0 - 200.0 * m * d
    ),
    "C6": case("fig11", lambda _, d: 0.5 / d, lambda _, d: 9.0 - 20.0 * d),
    "C6b": case("fig12", lambda d, _: 9.0 - 20.0 * d, lambda d, _: 9.0 + 20.0 * d),
    # A jump down and a jump up make no minimum.
    "F12": case(
        "fig12",
        lambda d, f: 5.0 + (f - 5.0) ** 2 if d > 0.06 else 5.0,
        lambda _, f: 5.0 if 4.0 < f < 6.0 else 8.0 - 0.001 * f,
    ),
    "F12b": (
        {**runs("fig06", falling), **runs("fig12", rising)},
        {**runs("fig06", falling), **runs("fig12", lambda _, f: 40.0 / (1.0 + f))},
    ),
    "F12c": case("by_frequency", lambda v, f: falling(v, f) if v > 1.0 else rising(v, f), falling),
    "F12d": case("by_frequency", lambda v, f: 5.0 if (v > 1.0) == (f > 5.0) else NAN, 5.0),
    # The places of the least duration differ where it is flat, and cost nothing.
    "C1b": case(
        "by_frequency",
        lambda v, f: 5.0 + abs(f - (3.0 if v > 1.0 else 7.0)),
        lambda v, f: 5.0 + v + 0.02 * abs(f - (3.0 if v > 1.0 else 7.0)),
    ),
    "C1c": (
        {**runs("fig06", within(1.0, 6.0)), **runs("fig13", lambda f, _: 5.0 if f < 6.0 else NAN)},
        {**runs("fig06"), **runs("fig12", lambda d, _: 5.0 if d > 0.06 else NAN)},
    ),
    "F13": case("fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, 5.0),
    "F13c": case(
        "fig13",
        lambda f, k: 5.0 if f < 50.0 / k else NAN,
        lambda f, k: 5.0 if f < 3.0 + 0.3 * k else NAN,
    ),
    # A border along one axis needs no matching.
    "F13d": (
        {**runs("fig13", matched), **runs("fig06", lambda k, f: matched(f, 2.0 * k))},
        {**runs("fig13", within(5.0, 20.0)), **runs("fig06", within(1.0, 6.0))},
    ),
    "F13b": case(
        "fig13",
        lambda f, k: 5.0 if k > 2.0 * f else NAN,
        lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN,
    ),
    "F14": case("fig14", lambda v, k: 5.0 if k > v else NAN, NAN),
    "F14b": case(
        "fig14", lambda v, k: 5.0 if k > v else NAN, lambda _, k: 5.0 if round(3.0 * k) % 3 else NAN
    ),
    "F14c": (
        {**runs("fig14", matched), **runs("fig08", lambda v, k: 5.0 if k > 3.0 * v else NAN)},
        {**runs("fig14", within(5.0, 20.0)), **runs("fig08", lambda v, _: 5.0 if v < 3 else NAN)},
    ),
    "C1a": case(
        "fig13", lambda f, k: 5.0 if k > 2.0 * f else NAN, lambda f, _: 5.0 if f < 4.0 else NAN
    ),
    "C2": (
        {**runs("fig08", falling), **runs("fig06", lambda k, _: 10.0 / k)},
        {**runs("fig08"), **runs("fig06", lambda _, f: 10.0 / f)},
    ),
    "C2a": (
        {
            **runs("fig08", within(1.0, 9.9)),
            **runs("fig06", lambda k, _: 5.0 if k < 10.0 else NAN),
            **runs("fig13", lambda _, k: 5.0 if k < 10.0 else NAN),
        },
        {**runs("fig08"), **runs("fig14", 5.0)},
    ),
    "C2b": (
        {**runs("fig13", falling), **runs("fig06", lambda k, _: 10.0 / k)},
        {**runs("fig13", rising), **runs("fig06", rising)},
    ),
    # Single cells beyond the area are no peak.
    "C2c": (
        runs("fig14", lambda v, k: 5.0 if k < 10.0 + v else NAN),
        runs("fig14", lambda v, k: 5.0 if k < 10.0 or 25.0 < k - v < 26.0 else NAN),
    ),
    "C2d": (
        {**runs("fig14", within(1.0, 20.0)), **runs("fig06", lambda k, _: 5.0 if k < 9 else NAN)},
        {**runs("fig14"), **runs("fig06")},
    ),
    "C3": (
        {
            **runs("fig08", lambda v, k: 5.0 if k > 3.0 + v else NAN),
            **runs("fig14", lambda v, k: 5.0 if k > (3.0 if v < 1.0 else 8.0) else NAN),
        },
        {**runs("fig08"), **runs("fig14", lambda v, k: 5.0 if k > 20.0 - v else NAN)},
    ),
    "C4": (
        runs("fig06", lambda k, f: 5.0 + f / k),
        runs("fig06", lambda k, f: 5.0 + 1.0 / (f * k)),
    ),
    "C7": (
        {**runs("fig13", within(5.0, 20.0)), **runs("fig14", within(10.0, 25.0))},
        {**runs("fig13", within(2.0, 12.0)), **runs("fig14", within(14.0, 25.0))},
    ),
    "C8": (
        {**runs("fig13", within(5.0, 25.0)), **runs("fig14", within(5.0, 25.0))},
        {**runs("fig13", within(5.0, 6.0)), **runs("fig14", within(5.0, 6.0))},
    ),
    "C8d": ({**Course().datasets, **runs("fig06")}, runs("fig06", insertion=IN_SLOT.JAMMED)),
    "C8c": ({**Course().datasets, **runs("fig06")}, runs("fig06", tau_corners_inside=NAN)),
}
