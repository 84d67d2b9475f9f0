"""A study in one call: the runs of ``align`` as a dataset in SI units."""

import json
import logging
import threading
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import vibralign
from vibralign import (
    Outcome,
    Settings,
    align,
    assess,
    baseline,
    load_device,
    reliable_at,
    simulate,
    sweep,
    yield_of,
)
from vibralign.answers.design import search
from vibralign.answers.design_trials import Trials
from vibralign.device.batches import devices_of

SQUARE = Path(__file__).parents[1] / "square"
PEG = SQUARE / "peg.yaml"
BRASS = SQUARE / "devices" / "peg.yaml"  # with base and tolerances
QUICK = Settings(tolerance=1e-7)
STARTS = [{"phase": 0.0, "initial_tilt": 0.001}]


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    """Over a unit of the device, and over a force on which the contact stiffness depends."""
    return sweep(BRASS, QUICK, mass=[0.25, "300 g", 0.35], press_force="4 to 28 N", points=5)


@pytest.fixture(scope="module")
def pressed(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("pressed") / "pressed.yaml"
    path.write_text(
        PEG.read_text(encoding="utf-8").replace(
            "approach_speed: sudden", "vibrator: still\napproach_speed: 3 mm/s"
        ),
        encoding="utf-8",
    )
    return path


# ------------------------------------------------------------------------------------ the numbers


def test_each_node_is_the_run_of_its_device(found):
    peg = load_device(BRASS)
    assert dict(found.sizes) == {"mass": 3, "press_force": 5}
    assert found.press_force.values.tolist() == [4.0, 10.0, 16.0, 22.0, 28.0]
    assert {Outcome.ALIGNED, Outcome.SETTLED} <= {*found.outcome.values.ravel()}
    for place in np.ndindex(3, 5):
        node = found.isel(mass=place[0], press_force=place[1])
        one = peg.at({"mass": float(node.mass), "press_force": float(node.press_force)})
        run, units = align([one.parameters], QUICK), one.units
        assert (node.outcome, node.sensitive) == (run.outcome[0], run.sensitive[0])
        for name, unit in [
            ("tau_align", units.time), ("tau_error", units.time), ("tilt_max", 1.0),
            ("contact_force_max", units.force), ("side_force_max", units.force),
        ]:  # fmt: skip
            expected = getattr(run, name)[0] * unit
            np.testing.assert_allclose(node[name], expected, rtol=1e-14, err_msg=name)


def varied(rng, own, size):
    return own * rng.choice([1.0, 0.9, 1.03], size)


@pytest.mark.parametrize("path", [PEG, *sorted((SQUARE / "devices").glob("*.yaml"))], ids=str)
def test_many_devices_at_once_are_those_made_one_by_one(path):
    """Computed quantities follow the others, to the bit; a device's own value is no change."""
    stated, rng, size = load_device(path), np.random.default_rng(3), 8
    own = {**stated.values, **stated.quantities}
    for _ in range(40):
        names = rng.choice(list(own), 3, replace=False).tolist()
        values = {name: varied(rng, own[name], size) for name in names}
        rows = [{n: float(v[i]) for n, v in values.items() if v[i] != own[n]} for i in range(size)]
        try:
            each = [stated.at(row) for row in rows]
        except ValueError:  # such as a damping and its ratio
            with pytest.raises(ValueError):  # noqa: PT011 - of the same kind
                devices_of(stated, values)
            continue
        batch, units = devices_of(stated, values)
        assert [batch[i] for i in range(size)] == [one.parameters for one in each]
        assert units == [one.units for one in each]


def test_a_horizon_in_seconds_holds_for_devices_of_every_mass():
    found = sweep(PEG, QUICK, mass=[0.2, 0.4], scene="insertion", horizon="90 ms")
    for mass, node in zip((0.2, 0.4), (found.isel(mass=0), found.isel(mass=1)), strict=True):
        device = load_device(PEG).changed(mass=mass)
        run = simulate(device, QUICK, scene="insertion", horizon="90 ms")
        assert int(node.outcome) == run.outcome
        np.testing.assert_allclose(node.tau_inserted, run.tau_inserted * device.units.time)
    assert {*found.outcome.values.tolist()} == {Outcome.INSERTED, Outcome.HORIZON_REACHED}


def test_one_point_has_no_dimension():
    one = sweep(PEG, frequency="60 Hz")
    assert one.tau_align.shape == ()
    assert float(one.frequency) == 60.0


# ------------------------------------------------------------------------ what stands beside them


def test_flags_units_and_attributes(found, tmp_path):
    outcome = found.outcome.attrs
    meanings = dict(zip(outcome["flag_values"], outcome["flag_meanings"].split(), strict=True))
    assert meanings == {int(each): str(each) for each in Outcome}
    assert found.sensitive.attrs["flag_meanings"] == "regular sensitive"
    assert (found.tau_error.attrs["units"], found.mass.attrs["units"]) == ("s", "kg")
    assert float(found.half_width) == 5e-3
    assert "contact_stiffness" not in found  # follows the press force
    assert found.attrs["shape"] == "square"
    assert found.attrs["product_version"] == vibralign.__version__
    assert found.attrs["device"] == str(BRASS)
    assumed = json.loads(found.attrs["assumptions"])
    assert "from steel on brass" in assumed["base"]
    assert {"start", "goal", "horizon", "precision", "tolerances"} < assumed.keys()
    found.to_netcdf(tmp_path / "study.nc")
    with xr.open_dataset(tmp_path / "study.nc", decode_timedelta=False) as stored:
        xr.testing.assert_identical(stored.load(), found)


# ----------------------------------------------------------------------- one meaning in every call


def test_a_device_means_the_same_everywhere(pressed):
    """A path, the device, a list of it, its parameters with its start."""
    device = load_device(pressed)
    run = simulate(device.parameters, QUICK, start="still")
    sudden = device.changed(approach_speed="sudden")
    assert run.tau_align != simulate(sudden, QUICK).tau_align
    for given in (pressed, str(pressed), device):
        assert simulate(given, QUICK) == run
        (time,) = align(given, QUICK).tau_align
        assert time == align([given], QUICK).tau_align[0] == pytest.approx(run.tau_align, abs=1e-6)
        seconds = float(sweep(given, QUICK).tau_align)
        assert seconds == pytest.approx(time * device.units.time, rel=1e-14)
    mixed = align([PEG, pressed, sudden.parameters, load_device(PEG)], QUICK)
    assert mixed.tau_align[0] == mixed.tau_align[2] == mixed.tau_align[3] != mixed.tau_align[1]
    assert mixed.tau_align[1] == time


def test_assessments_start_as_the_file_states(pressed):
    device = load_device(pressed)
    settings = Settings(scene=vibralign.INSERTION, tolerance=1e-6)
    stated, other = (assess(each, settings, vary=False) for each in (pressed, PEG))
    assert stated != other
    explicit = Settings(scene=vibralign.INSERTION, tolerance=1e-6, start="still")
    assert stated == assess(device, explicit, vary=False)
    forces = ["8 N", 10.0, 28.0]
    verdicts = [reliable_at(each, settings, press_force=forces) for each in (pressed, device)]
    assert verdicts[0].tolist() == verdicts[1].tolist()


def test_devices_have_a_dimension_of_their_own():
    both = [load_device(PEG), load_device(PEG, {"friction": "0.3"})]
    found = sweep(both, QUICK, frequency=[40, 50])
    assert found.device.values.tolist() == [str(PEG), f"{PEG}, with friction=0.3"]
    assert found.tau_align.dims == ("device", "frequency")
    assert found.friction.values.tolist() == [0.15, 0.3]
    for i, one in enumerate(both):
        np.testing.assert_array_equal(
            found.outcome[i], sweep(one, QUICK, frequency=[40, 50]).outcome
        )


def test_devices_keep_their_own_attributes_and_assumptions(pressed, tmp_path):
    """One is lowered first, one has another base; what they share is said once."""
    apart = [sweep(each, QUICK, frequency=[40, 50]) for each in (pressed, BRASS)]
    found = sweep([pressed, BRASS], QUICK, frequency=[40, 50])
    assert found.start.values.tolist() == ["still", "simultaneous"]
    assert found.assumptions.values.tolist() == [each.attrs["assumptions"] for each in apart]
    assert found.attrs["shape"] == "square"
    assert not {"start", "assumptions", "device"} & set(found.attrs)
    found.to_netcdf(tmp_path / "study.nc")
    with xr.open_dataset(tmp_path / "study.nc", decode_timedelta=False) as stored:
        xr.testing.assert_identical(stored.load(), found)


REFUSED = {
    "a name": ({"frequncy": [1, 2]}, "'frequncy'. Did you mean 'frequency'"),
    "a unit": ({"frequency": "20..150 N"}, "must be in Hz"),
    "a falling range": ({"frequency": "150..20 Hz"}, "must rise"),
    "a value twice": ({"frequency": [20, "20 Hz"]}, "distinct"),
    "no value": ({"frequency": []}, "at least one"),
    "a tolerance": ({"press_force": ["10 N ± 1 N"]}, "no tolerance"),
    "a number without a number": ({"press_force": [None]}, "not filled in"),
    "a value outside its rule, in metres": ({"misalignment": "0.3..60 mm"}, "= 0.06"),
    "a part that is not pressed": ({"press_force": [4, -8]}, "press_force"),
    "a part that starts inside the hole": ({"misalignment": "0.01..0.5 mm"}, "already inside"),
    "a horizon without a unit": ({"horizon": 3}, "such as '1 s'"),
    "one point": ({"frequency": "20..150 Hz", "points": 1}, "points = 1"),
    "no cores": ({"cores": 0}, "cores = 0"),
}  # fmt: skip


@pytest.mark.parametrize(("axes", "words"), REFUSED.values(), ids=list(REFUSED))
def test_what_is_refused(axes, words):
    with pytest.raises(ValueError, match=r"^[^\n]*$") as refusal:
        sweep(PEG, **axes)
    assert words in str(refusal.value)


@pytest.mark.parametrize("call", [simulate, align, lambda *a, **k: align([*a], **k)])
def test_a_quantity_among_the_settings_is_told_its_place(call):
    change = r"quantity of the device.* load_device\(file, {'amplitude': '1.4 mm'}\).* sweep\("
    for device in (PEG, load_device(PEG), baseline()):
        with pytest.raises(ValueError, match=change):
            call(device, amplitude="1.4 mm")
    # The places that the message names take it.
    own = load_device(PEG, {"amplitude": "1.4 mm"})
    assert own.units == load_device(PEG).changed(amplitude="1.4 mm").units
    assert sweep(PEG, QUICK, amplitude="1.4 mm").tau_align.equals(sweep(own, QUICK).tau_align)


def test_devices_that_do_not_fit():
    for call in (sweep, reliable_at, assess, yield_of, vibralign.design):
        with pytest.raises(TypeError, match="got Parameters, which only simulate and align run"):
            call(baseline())
    with pytest.raises(TypeError, match="got Parameters"):
        sweep([PEG, baseline()])
    with pytest.raises(ValueError, match="no device"):
        sweep([])
    with pytest.raises(TypeError, match="got dict"):
        sweep({"mass": 0.3})


def test_a_changed_device_reads_units():
    peg = load_device(BRASS)
    changed = peg.changed(press_force="12 N", friction="0.2 ± 0.01")
    assert changed.parameters == peg.changed(press_force=12.0, friction=0.2).parameters
    assert changed.tolerances["press_force"] == peg.tolerances["press_force"]
    assert changed.tolerances["friction"].width == 0.01
    with pytest.raises(ValueError, match="must be in N"):
        peg.changed(press_force="12 mm")


# ------------------------------------------------------------------------ progress and interruption


def design(**_):
    device = load_device(BRASS)
    search(Trials(device, STARTS * 64, Settings(scene=vibralign.INSERTION)), 10**6, 64)


LONG = {"may_settle": False, "horizon": 1e9, "max_evaluations": 10**12}
NEVER = {"press_force": np.linspace(4.0, 8.0, 4000)}  # too strong: none aligns
STRONG = {"press_force": np.linspace(40.0, 80.0, 4000)}  # of the peg, in N
CALLS = {
    "simulate": lambda: simulate(baseline().replace(press_force=4.0), **LONG),
    "align": lambda: align(vibralign.Batch.of(baseline(), **NEVER), **LONG),
    "sweep": lambda: sweep(PEG, **STRONG, **{**LONG, "horizon": "1e7 s"}),
    "reliable_at": lambda: reliable_at(PEG, Settings(**LONG), **STRONG),
    "assess": lambda: assess(PEG, Settings(**LONG)),
    "yield_of": lambda: yield_of(BRASS, devices=2**12),
    "design": design,
}


class Interrupting(logging.Handler):
    """Ctrl-C at the first message."""

    def emit(self, record):
        self.words = record.getMessage()
        raise KeyboardInterrupt


@pytest.mark.parametrize("call", CALLS.values(), ids=list(CALLS))
def test_every_call_tells_its_progress_and_stops_at_once_when_interrupted(call):
    log, handler = logging.getLogger("vibralign"), Interrupting()
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        log.removeHandler(handler)
        log.setLevel(logging.NOTSET)
    assert handler.words.endswith(" runs")
    for each in threading.enumerate():
        if each.name.startswith("ThreadPoolExecutor"):
            each.join(60.0)  # runs stop after their present step, not in an hour
            assert not each.is_alive()
