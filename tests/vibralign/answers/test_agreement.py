"""Commands that answer one question give one answer: random devices, asked in every way.

Each device is a worked one with its quantities changed at random, as a file with tolerances. The
questions are whether it goes in from every start, how fast it aligns from one start, and how many
devices within its tolerances go in. The page's engine is run as the page runs it, as WebAssembly.
"""

import base64
import gzip
import json
import math
import re
from collections.abc import Collection
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
import xarray as xr
import yaml

from model.engine.results import RunResult
from model.events.outcomes import Outcome
from model.physics.approach import Start
from model.physics.parameters import PARAMETER_NAMES
from model.physics.quantities import FORCE
from model.physics.tables import vars_of
from model.physics.units import device as device_of
from model.runs import in_browser
from model.runs.in_browser import Module, interface
from model.runs.simulate import simulate_once
from model.sweeps.starts import Starts
from study.config import load_study, study_path
from tests.model.runs.browser import Browser
from tests.vibralign.explorer.scripts import NODE, evaluate
from vibralign import (
    ALIGNMENT,
    INSERTION,
    Batch,
    Settings,
    load_device,
    reliable_at,
    simulate,
)
from vibralign.answers import yields
from vibralign.answers.assumptions import assumptions
from vibralign.answers.cases import cases_of
from vibralign.answers.design import as_printed
from vibralign.answers.design_trials import MEASURES, Trials
from vibralign.answers.reliability import FORCES, run_devices
from vibralign.answers.si import si_words
from vibralign.commands import main as cli
from vibralign.commands import sheet
from vibralign.device import StatedDevice
from vibralign.device.mouth import as_parameters, judged
from vibralign.device.runs import of_device
from vibralign.plots import device_sheet

SQUARE = Path(__file__).resolve().parents[2] / "square"
COUNT, MANY = 3, 60
TILTS = (None, "0.2 deg", "-0.1 deg ± 0.2 deg", "0.1 deg σ 0.1 deg")
APPROACHES = (
    {"approach_speed": "sudden"},
    {"approach_speed": "20 mm/s", "vibrator": "still"},
    {"approach_speed": "30 mm/s", "vibrator": "running"},
)
VARIED = ("press_force", "frequency", "mass", "amplitude", "tilt_stiffness", "friction")
HORIZON = 0.4  # s
NUMBER = r"\d+(?:\.\d+)?(?:e[-+]\d+)?"
ROUGH = ["--tolerance", "1e-6", "--horizon", f"{HORIZON} s"]


def written(folder: Path, number: int) -> Path:
    """Write a random device: square or round, lowered or not, tilted, with chamfers."""
    rng = np.random.default_rng(4100 + number)
    stated = load_device(SQUARE / "devices" / ("pin.yaml", "peg.yaml", "shaft.yaml")[number % 3])
    quantities = dict(stated.quantities)
    for name in VARIED:
        quantities[name] = float(f"{quantities[name] * np.exp(rng.normal(0.0, 0.3)):.4g}")
    lines: dict[str, object] = dict(quantities) | {"materials": stated.materials}
    lines["shape"] = ("square", "round")[number % 2]
    lines |= {"friction": f"{quantities['friction']} ± 10 %", "mass": f"{quantities['mass']} ± 5 %"}
    lines |= {"press_force": f"{quantities['press_force']} ± 5 %"}
    if TILTS[number % 4] is not None:
        lines["gripper_tilt"] = TILTS[number % 4]
    if number % 4 == 3:
        play = quantities["clearance"] * quantities["half_width"]
        chamfer = 0.1 * (quantities["misalignment"] - play)
        lines |= {"peg_chamfer": chamfer, "hole_chamfer": 2.0 * chamfer}
    lines |= APPROACHES[number % 3]
    path = folder / f"device{number}.yaml"
    path.write_text(yaml.safe_dump(lines, allow_unicode=True), encoding="utf-8")
    return path


def said(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict:
    capsys.readouterr()
    assert cli.main([*arguments, *ROUGH, "--json"]) in (cli.DONE, cli.FAILED)
    return json.loads(capsys.readouterr().out)


@pytest.fixture
def _no_advice(monkeypatch: pytest.MonkeyPatch, _no_leeways: None) -> None:
    """Leave out what is not asked here: leeways, Sobol' indices, pictures.

    Without wasmtime the page's engines are not run, nor made.
    """
    monkeypatch.setattr(yields, "sobol_indices_of", lambda *_, **__: ())
    if not find_spec("wasmtime"):
        monkeypatch.setattr(
            in_browser, "module_for", lambda shape, scene: Module(b"one", interface(scene, shape))
        )
    monkeypatch.setattr(sheet, "_COUNT", 3)
    monkeypatch.setattr(device_sheet, "_picture", lambda _: "")


@pytest.mark.usefixtures("_no_advice")
@pytest.mark.parametrize(
    "numbers", [range(COUNT), pytest.param(range(COUNT, MANY), marks=pytest.mark.nightly)], ids=str
)
def test_every_command_gives_the_same_answer(numbers, tmp_path, capsys):
    verdicts = [agreed(written(tmp_path, n), tmp_path, capsys) for n in numbers]
    assert {True, False} == set(verdicts)  # devices of both kinds were asked


def agreed(path: Path, folder: Path, capsys: pytest.CaptureFixture[str]) -> bool:
    """Ask all commands of one device, compare, and return whether it is reliable."""
    file = ["--device", str(path)]
    page, out = folder / "sheet.html", folder / "map.nc"
    assessed = said(capsys, "assess", *file, "--devices", "16")
    reliable = assessed["aligned"] == assessed["starts"]
    assert assessed["verdict"].startswith("reliable" if reliable else "not reliable")
    device = load_device(path)
    own = {**device.values, **device.quantities}
    settings = Settings(tolerance=1e-6, horizon=HORIZON / device.units.time, scene=INSERTION)
    scene, success, known = ["--scene", "insertion"], Outcome.INSERTED, "until inserted"
    if device.is_chamfered:
        scene, success, known = [], Outcome.ALIGNED, "until alignment"

    # Python: the same device, start, scene and verdict.
    assert assessed["shape"] == device.shape
    assert (
        assessed["assumptions"]["start"]
        == assumptions(device.parameters, device.run_settings(settings, device.units), device)[
            "start"
        ]
    )
    assert reliable_at(device, settings, mass=[own["mass"]]).tolist() == [reliable]
    run = simulate(device, settings)
    told = said(capsys, "simulate", *file, *scene)
    assert told["outcome"] == run.outcome.name.lower()
    aligns = math.nan if told["tau_align"] is None else told["tau_align"]
    assert aligns == pytest.approx(run.tau_align * device.units.time, nan_ok=True)
    of_run = {place: getattr(run, name) for place, name in FORCES.items()}
    newton = device.units.force
    for place, name in FORCES.items():
        assert told[name] == pytest.approx(of_run[place] * newton)
    assert told["contact_force_max"] == pytest.approx(run.contact_force_max * newton)
    assert max(of_run.values()) == run.contact_force_max
    assert told["forces_known"].startswith(known)
    own_values = {"mass": np.array([own["mass"]])}
    python = run_devices(device, own_values, starts_of_study(device), settings)
    assert assessed["contact_force_max"] == pytest.approx(python.force[0], rel=1e-3)
    assert assessed["contact_force_max"] >= 0.99 * run.contact_force_max * newton
    for place, each in assessed["forces"].items():
        assert each == pytest.approx(python.forces[place][0], rel=1e-3, abs=1e-9)
    if reliable:
        times = run.tau_align * device.units.time
        assert assessed["tau_best"] * 0.999 <= times <= assessed["tau_worst"] * 1.001
    if assessed["failing_start"]:
        sets = [w for n, v in assessed["failing_start"].items() for w in ("--set", f"{n}={v!r}")]
        failing = said(capsys, "simulate", *file, *scene, *sets)
        assert failing["outcome"] != success.name.lower()

    # A map with the device at its middle node; mass and amplitude are units of the device.
    spans = {name: (0.8 * own[name], 1.2 * own[name]) for name in ("mass", "amplitude")}
    axes = [word for side, (name, ends) in zip("xy", spans.items(), strict=True)
            for word in (f"--{side}", name, *map(repr, ends))]  # fmt: skip
    assert cli.main(["map", *file, *ROUGH, *axes, "--resolution", "3", "--out", str(out)]) == 0
    least = load_device(path, {name: low for name, (low, _) in spans.items()})
    with xr.open_dataset(out) as stored:
        assert bool(stored["reliable"][1, 1]) is reliable
        inserted = stored["outcome"].values[1, 1] == success
        assert inserted == (run.outcome == success)
        if inserted:
            seconds = float(stored["tau_align"][1, 1])
            assert seconds == pytest.approx(run.tau_align * device.units.time, rel=1e-4)
        force = stored["contact_force_max"]
        assert float(force[1, 1]) == pytest.approx(run.contact_force_max * newton, rel=0.01)
        assert force.attrs["units"] == "N"
        assert force.attrs["comment"].startswith(f"from the stated start, {known}")
        told, varying = json.loads(stored.attrs["assumptions"]), {"goal", "base", "horizon"}
        for name, words in assessed["assumptions"].items():
            at_corners = name in varying and told[name].startswith("varies over the map")
            assert at_corners or alike(told[name], words)
        at_least = reliable_at(least, replace(settings, horizon=HORIZON / least.units.time))
        assert bool(stored["reliable"][0, 0]) is bool(at_least[0])

    # The sheet, and the page that runs the device.
    if device.vibrator == "still":
        assert cli.main(["assess", *file, *ROUGH, "--devices", "16", "--sheet", str(page)]) == 0
        sheet_text = page.read_text(encoding="utf-8")
        assert assessed["verdict"] in sheet_text
        for place, each in assessed["forces"].items():
            assert not each or f"{si_words(each, FORCE, 3)} at the {place}" in sheet_text
        if device.shape == "round":
            assert f"{si_words(assessed['tip_force_max'], FORCE, 3)} at each tip" in sheet_text
    assert cli.main(["explore", *file, *ROUGH, *scene, "--out", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    # The page's own engine makes one run, at the tolerance itself: no estimate refines it.
    once = of_device(
        simulate_once(device.parameters, device.run_settings(settings, device.units)), device
    )
    for shown, of in zip(on_page(text, device.shape), (run, once), strict=False):
        for name in ("tau_align", *FORCES.values()):
            expected = pytest.approx(getattr(of, name), rel=1e-6, nan_ok=True)
            assert shown[name] == expected
    assert f'"forces_known": "{known}' in text
    for name in ("base", "start", "horizon"):
        assert assessed["assumptions"][name] in text

    # What a design says of a setting is what assess says of it.
    setting = {name: own[name] for name in ("press_force", "frequency")}
    assert setting == {name: as_printed(v, 0.0, math.inf) for name, v in setting.items()}
    starts = starts_of_study(device, device.tolerances)
    free = {name: (0.5 * value, 2.0 * value) for name, value in setting.items()}
    check = Trials(replace(device, free=free), starts, settings, devices=16).check(setting)
    if check.devices == assessed["yield"]["devices"]:
        assert check.forces == pytest.approx(assessed["yield"]["forces"], rel=1e-6)
        assert check.row[2 + MEASURES.index("contact_force")] == max(check.forces.values())
    assert check.going_in == assessed["yield"]["going_in"] or not reliable
    assert (check.row[0] == 1.0) is (reliable and assessed["yield"]["share"] == 1.0)
    return reliable


def alike(words: str, others: str) -> bool:
    """Return whether words are the same, and their numbers to the last of four digits."""
    numbers = [[float(each) for each in re.findall(NUMBER, text)] for text in (words, others)]
    same = re.sub(NUMBER, "", words) == re.sub(NUMBER, "", others)
    return same and numbers[0] == pytest.approx(numbers[1], rel=1e-3)


def starts_of_study(device: StatedDevice, varied: Collection[str] = ()) -> Starts:
    return cases_of(device, load_study(study_path()).maps.ensemble, varied=varied)


def on_page(text: str, shape: str) -> list[dict[str, float]]:
    """Return the results of a page's device: by Python, by the page's engine and its scripts."""
    model = json.loads(text.partition('id="model">')[2].partition("</script>")[0])
    values = {name: v for name, v in model["baseline"].items() if v is not None}
    control = model["control"]
    settings = Settings(
        tolerance=control["tolerance"],
        horizon=control["horizon"],
        start=get_args(Start)[int(control["start"])],
        scene=INSERTION if "inserted" in model["interface"]["events"] else ALIGNMENT,
        shape=model["interface"]["shape"],
    )
    assert settings.shape == shape
    parameters = device_of(as_parameters(values)).parameters
    if NODE:
        by_page = evaluate({**model, "engine": None}, "asParameters(MODEL.baseline, MODEL)")
        assert tuple(by_page) == PARAMETER_NAMES
        for name in PARAMETER_NAMES:
            value = getattr(parameters, name)
            assert by_page[name] == (value if value is None else pytest.approx(value, rel=1e-12))
    names = ("tau_align", "tilt_max", "tilt_at_alignment", *FORCES.values())
    run = simulate(parameters, settings)
    found = [{name: float(getattr(run, name)) for name in names}]
    if find_spec("wasmtime"):
        binary = gzip.decompress(base64.b64decode(model["engine"]))
        given = np.array([[each[0] for each in Batch.stack([parameters]).values.values()]])
        results, _ = Browser(binary, model["interface"]).run(given, rows=0, **control)
        by_name = RunResult(*results[0])._asdict()
        found.append({name: by_name[name] for name in names})
    if not NODE:
        return [
            dict(judged(*each, chamfered="hole_chamfer" in values))
            for each in (
                ({n: np.array(v) for n, v in one.items()}, vars_of(parameters)) for one in found
            )
        ]
    shown = [{n: v if np.isfinite(v) else None for n, v in one.items()} for one in found]
    said = evaluate({**model, "engine": None, "found": shown},
                    "MODEL.found.map((each) => judged(each, MODEL.baseline))")  # fmt: skip
    return [{n: math.nan if v is None else v for n, v in one.items()} for one in said]
