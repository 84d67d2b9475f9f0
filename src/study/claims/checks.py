"""The checks of the entries: each yields part, curve or figure ("" for the whole), and number.

``claims.yaml`` has the words, limits and reasons. A curve that the paper names must have aligned
points, others are left out where they have too few (``judged``).
"""

from collections.abc import Callable, Iterator

import numpy as np

from model.events.outcomes import Unvibrated
from study.claims.data import Array, Curve, Figure, Figures, Flags, MissingDataError
from study.claims.measures import (
    FEWEST,
    NAN,
    SEEN,
    Trace,
    back,
    change,
    edge_shift,
    fast_rectangle,
    general,
    judged,
    largest_area,
    line,
    median,
    minimum,
    moves,
    one,
    order,
    ratio,
    rise,
    share,
    slopes,
    traces,
    width,
)

Numbers = Iterator[tuple[str, str, float]]
RISES, FALLS = 1.0, -1.0
_CURVES = tuple(f"fig{number:02}" for number in range(6, 13))
_MOMENTS = 400  # at which a history is sampled


# --- The regime -----------------------------------------------------------------------------------


def _of_aligned(of: Figures, flags: Callable[[Curve], Flags]) -> Numbers:
    """Yield the share of the aligned runs of Figs. 6 to 12 that have a flag, and that of Fig. 5."""
    runs = [of[name].whole for name in _CURVES]
    yield "all", "Figs. 6 to 12", share(np.concatenate([flags(r)[r.aligned] for r in runs]))
    own = of["fig05"].whole
    yield "one", "Fig. 5", share(flags(own)[own.aligned])


def l02(of: Figures) -> Numbers:
    yield from _of_aligned(of, lambda runs: runs.result("unvibrated") != Unvibrated.ALIGNS)


def l05(of: Figures) -> Numbers:
    yield from _of_aligned(of, lambda runs: runs.result("separations") == 0)


def l13(of: Figures) -> Numbers:
    def rests(runs: Curve) -> Flags:
        tilted = np.abs(runs.result("unvibrated_tilt")) >= 0.001
        return np.asarray((runs.result("unvibrated") == Unvibrated.RESTS) & tilted)

    yield "all", "", next(_of_aligned(of, rests))[2]


def l14(of: Figures) -> Numbers:
    still, vibrated = (each.result("x_end") for each in of["locked"].curves)
    stays = np.abs(vibrated - still) <= 0.05 * 0.2
    yield "all", "", share(stays)
    yield "one", "Fig. 5", float(stays[0])


# --- Fig. 5 ---------------------------------------------------------------------------------------


def _sampled(figure: Figure, name: str) -> Array:
    """Return a trace until alignment at equidistant moments, as means over an excitation period.

    It is empty for a part that does not align, and raw over fewer than three periods.
    """
    time, tau = figure.course["time"], figure.whole.tau
    if not np.isfinite(tau).all():
        return np.empty(0)
    values = np.interp(np.linspace(0.0, tau[0], _MOMENTS), time, figure.course[name])
    period = 2.0 * np.pi / figure.held["frequency"] / tau[0]
    if period > 1.0 / 3.0:
        return values
    wide = max(1, round(period * _MOMENTS))
    return np.convolve(values, np.full(wide, 1.0 / wide), mode="valid")


def l03(of: Figures) -> Numbers:
    for name, symbol, sign in (("x", "x", FALLS), ("tilt", "φ", RISES), ("y", "y", FALLS)):
        along = sign * _sampled(of["fig05"], name)
        span = float(np.ptp(along)) if along.size else NAN
        yield "moves", symbol, (along[-1] - along[0]) / span if span > 0.0 else NAN
        fall = (np.maximum.accumulate(along) - along).max() if span > 0.0 else NAN
        yield "back", symbol, float(fall / span)


def l04(of: Figures) -> Numbers:
    run, course = of["fig05"].whole, of["fig05"].course
    if not run.aligned.all():
        yield "inside", "", NAN
        return
    tau = float(run.tau[0])
    time, force = course["time"], course["contact_force"]
    begin = max(0.0, tau - 2.0 * np.pi / of["fig05"].held["frequency"])
    moments = np.linspace(begin, tau, _MOMENTS)
    usual = float(np.interp(moments, time, force).mean())
    strong = time[(time <= tau) & (force >= 0.5 * usual)]
    after = force[(time > tau) & (time <= 1.05 * tau)]
    yield "inside", "", float(run.result("tau_corners_inside")[0] / tau - 1.0)
    yield "drops", "", float((tau - strong[-1]) / tau) if strong.size else NAN
    yield "stays", "", float(after.max(initial=0.0))
    tilt = float(run.result("tilt_at_alignment")[0])
    yield "tilt", "", tilt
    yield "some tilt", "", tilt


# --- Curves ---------------------------------------------------------------------------------------


def _general(found: list[Trace], sign: float) -> Numbers:
    passing, against = general(found, sign)
    yield "most", "", passing
    yield "none against", "", against


def _trend(trace: Trace, sign: float, part: str, where: str) -> Numbers:
    yield part, where, change(trace, sign)
    yield f"{part}, back", where, back(trace, sign)


def l07(of: Figures) -> Numbers:
    yield from _general([*judged(of["fig08"]), *judged(of["fig09"])], FALLS)


def l08(of: Figures) -> Numbers:
    best = [median([minimum(each)[0] for each in judged(of[n])]) for n in ("fig06", "fig12")]
    yield "apart", "", abs(best[0] - best[1])


def l15(of: Figures) -> Numbers:
    found = judged(of["fig07"])
    yield from _general(found, RISES)
    yield "bends", "", share(slopes(each, 0.1) >= 1.25 for each in found)
    rises = [rise(each, 0.01, 0.3) for each in found]
    yield "differs", "", ratio(max(rises), min(rises))


def l16(of: Figures) -> Numbers:
    found = judged(of["fig07"])
    soft, hard = ([t for t in found if (t.at < 3.0) is below] for below in (True, False))
    if not soft or not hard:
        raise MissingDataError("Fig. 7 has no curves on both sides of f0 = 3")
    for each in soft:
        yield "rises", f"f0 = {each.at:g}", rise(each, 0.01, 0.15)
        yield "less beyond", f"f0 = {each.at:g}", slopes(each, 0.15)
    usual = [median([rise(each, 0.01, 0.15) for each in part]) for part in (soft, hard)]
    yield "more", "", ratio(*usual)


def l17(of: Figures) -> Numbers:
    found = traces(of["fig09"])
    common = sorted(set.intersection(*({*each.x.tolist()} for each in found)))
    if len(common) < FEWEST:
        raise MissingDataError(f"only {len(common)} k_φ at which all curves of Fig. 9 align")
    drops = [
        float(np.subtract(*np.interp([common[0], common[-1]], each.x, each.y))) for each in found
    ]
    yield "more", "", ratio(drops[-1], drops[0]) if drops[-1] > 0.0 else NAN
    for each, lower, higher in zip(found[1:], drops, drops[1:], strict=False):
        yield "in order", f"f0 = {each.at:g}", ratio(higher, lower) if lower > 0.0 else float("inf")


def l18(of: Figures) -> Numbers:
    yield from _general(judged(of["fig11"]), FALLS)


def l19(of: Figures) -> Numbers:
    lines = [line(each) for each in judged(of["fig11"])]
    yield "straight", "", share(departure <= SEEN for _, departure in lines)
    fitted = np.array([slope for slope, _ in lines])
    yield "alike", "", float(np.abs(fitted / fitted.mean() - 1.0).max())


def l21(of: Figures) -> Numbers:
    soft, stiff = (
        [each for each in of["fig06"].curves if each.at in values]
        for values in ((5.0, 7.0), (10.0, 20.0))
    )
    for each in stiff:
        where = f"k_φ = {each.at:g}"
        yield "limited", where, 1.0 - float(each.aligned[-1]) if each.aligned.any() else NAN
    yield "narrower", "", order(soft, stiff)


def l22(of: Figures) -> Numbers:
    found = traces(of["fig06"])
    soft = [one(found, value) for value in (5.0, 7.0)]
    slow = np.concatenate([each.y[each.x < 2.0] for each in soft])
    others = np.concatenate(
        [each.y[(each.x <= 5.0) & ~((each.x < 2.0) & (each.at in (5.0, 7.0)))] for each in found]
    )
    yield "slower", "", ratio(median(slow), median(others))
    for each in soft:
        yield from _trend(each.between(0.0, 10.0), FALLS, "falls", f"k_φ = {each.at:g}")


def l23(of: Figures) -> Numbers:
    found = traces(of["fig06"])
    for value in (10.0, 20.0):
        where, first = f"k_φ = {value:g}", moves(one(found, value))[:3]
        is_so = [sign for sign, _, _ in first] == [FALLS, RISES, FALLS]
        yield "order", where, float(is_so)
        yield "early", where, first[1][2] if is_so else NAN
        yield "small", where, first[1][2] - first[1][1] if is_so else NAN


def l24(of: Figures) -> Numbers:
    yield "one", "", max(minimum(each)[1] for each in judged(of["fig12"]))


def l25(of: Figures) -> Numbers:
    curves = of["fig08"].curves
    slow, fast = ([c for c in curves if (c.at < 10.0) is below] for below in (True, False))
    yield "wider", "", order(slow, fast)


def l26(of: Figures) -> Numbers:
    def turns(curve: Curve) -> bool:
        aligned, tilt = curve.aligned, np.abs(curve.result("tilt_max"))
        soft = np.arange(aligned.size) < int(np.argmax(aligned))
        return ratio(median(tilt[soft]), median(tilt[aligned])) >= 1.0 + SEEN

    kept = {each.at for each in judged(of["fig08"])}
    yield "most", "", share(turns(each) for each in of["fig08"].curves if each.at in kept)


def l27(of: Figures) -> Numbers:
    for curve in of["fig09"].curves:
        if curve.at >= 2.5:
            below = np.flatnonzero(curve.x < 10.0)[:-1]
            yield "none", f"f0 = {curve.at:g}", share(curve.aligned[below])


def l28(of: Figures) -> Numbers:
    yield from _general(judged(of["fig10"]), RISES)


def l29(of: Figures) -> Numbers:
    tau, tilt = (
        one(traces(of["fig09"], name), 1.0).between(10.0, np.inf)
        for name in ("tau_align", "tilt_max")
    )
    yield "longer", "", ratio(median(tau.y[tau.x <= 15.0]), median(tau.y[tau.x > 15.0]))
    yield from _trend(tilt, FALLS, "tilts less", "")
    stiffest = tilt.x >= tilt.x[0] + 2.0 / 3.0 * np.ptp(tilt.x) if tilt.x.size else []
    yield "small", "", median(tilt.y[stiffest]) - 0.001 if tilt.x.size else NAN
    yield from _trend(tau, FALLS, "falls", "")


def l30(of: Figures) -> Numbers:
    rows: dict[float, list[float]] = {}
    for each in traces(of["fig08"]):
        for x, y in zip(each.x.tolist(), each.y.tolist(), strict=True):
            rows.setdefault(x, []).append(y)
    several = [row for row in rows.values() if len(row) > 1]
    yield "apart", "", share(max(row) >= (1.0 + SEEN) * min(row) for row in several)


# --- Maps -----------------------------------------------------------------------------------------


def l01(of: Figures) -> Numbers:
    for name in ("fig13", "fig14"):
        columns, where = of[name].columns, _words(name)
        yield "matched", where, max(edge_shift(columns, end) for end in (np.min, np.max))
        yield "only", where, 1.0 - share(of[name].whole.aligned)


def l06(of: Figures) -> Numbers:
    rows = of["fig14"].curves
    slow, fast = ([r for r in rows if (r.at <= 1.0) is below] for below in (True, False))
    yield "order", "", order(slow, fast)
    usual = [median([width(each)[0] for each in part]) for part in (slow, fast)]
    yield "wider", "", ratio(*usual)


def l09(of: Figures) -> Numbers:
    for name in ("fig13", "fig14"):
        where, aligned = _words(name), share(of[name].whole.aligned)
        together, holes = largest_area(of[name].cells)
        yield "both", where, min(aligned, 1.0 - aligned)
        yield "one", where, together
        yield "without holes", where, holes


def l10(of: Figures) -> Numbers:
    for name in ("fig13", "fig14"):
        figure = of[name]
        tau = np.where(figure.cells == 1, figure.results["tau_align"], np.inf)
        yield "fast", _words(name), fast_rectangle(figure.cells, tau, 0.05)


def l11(of: Figures) -> Numbers:
    rows = of["fig13"].curves
    if rows[-1].at <= 10.0:
        raise MissingDataError("the axis of Fig. 13 ends at f0 = 10")
    beyond = [row.aligned for row in rows if row.at > 10.0]
    yield "none beyond", "", share(np.concatenate(beyond))
    yield "up to", "", share(bool(row.aligned.any()) for row in rows if row.at <= 10.0)


def l12(of: Figures) -> Numbers:
    columns = [each.aligned for each in of["fig13"].columns if each.aligned.any()]
    yield "most", "", share(share(~each) >= SEEN for each in columns)


def l20(of: Figures) -> Numbers:
    rows = [each for each in of["fig14"].curves if each.aligned.any()]
    yield "peak", "", share(not each.aligned[-1] for each in rows)
    yield "moves", "", edge_shift(rows, np.max)


def _words(name: str) -> str:
    """Return "Fig. 6" for "fig06"."""
    return f"Fig. {int(name[3:])}"
