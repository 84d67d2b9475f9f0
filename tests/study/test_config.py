"""The configuration is refused with the key's path, the value and the rule."""

import copy
import functools
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml

from model.physics.parameters import Parameters
from study.config import (
    ConfigError,
    check_study,
    load_study,
    read_study,
    study_path,
)
from study.plans import sweep_of
from vibralign.device.paper import baseline

PROJECT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def stated() -> dict[str, Any]:
    return read_study(study_path())


@pytest.fixture
def mapping(stated: dict[str, Any]) -> dict[str, Any]:
    return copy.deepcopy(stated)


MISSING = object()
REFUSED = [
    ("structure.inertia", MISSING, ["structure.inertia: missing"]),
    ("figures.fig09", MISSING, ["identification.operating_points", "'fig09'"]),
    ("results_rot", "x", ["results_rot", "unknown key", "results_root"]),
    ("settings.horizon", "long", ["settings.horizon = 'long'", "number"]),
    ("settings.tolerance", "1e-10", ["settings.tolerance = '1e-10'", "write 1.0e-10"]),
    ("settings.readings", "prinetd", ["settings.readings = 'prinetd'", "'printed'"]),
    ("settings.readings", {"friction_lw": "printed"}, ["friction_lw", "friction_law"]),
    ("jamming.held", {"friction": 0.1}, ["jamming.held.friction", "is varied in the same figure"]),
    ("jamming.clearance.values", [-0.1], ["jamming", "clearance"]),
    ("structure.inertia", -1.0, ["structure.inertia = -1.0", "> 0"]),
    ("structure.friction", 0.1, ["friction", "both structure and operating_point"]),
    (
        "figures.fig99",
        {"kind": "schematic", "title": "t", "caption": "s"},
        ["figures.fig99.kind = 'schematic'", "study/schematics/fig99.py"],
    ),
    (
        "figures.figure_15",
        {"kind": "history", "title": "t", "caption": "s"},
        ["fig and two digits"],
    ),
    ("figures.fig06.kind", "mapp", ["figures.fig06", "mapp", "'curves'"]),
    ("figures.fig06.swept.start", 20.0, ["figures.fig06.swept", "start = 20.0", "stop = 20.0"]),
    ("figures.fig06.swept.parameter", "press", ["figures.fig06.swept.parameter", "press_force"]),
    ("figures.fig06.family.values", [5.0, 5.0], ["figures.fig06.family", "differ"]),
    ("figures.fig06.held.press_force", 1.0, ["figures.fig06.held.press_force", "varied"]),
    ("figures.fig06.held.misalignment", 9.0, ["figures.fig06: misalignment = 9.0"]),
    ("accuracy.sets", 0, ["accuracy.sets = 0", "equal to 1"]),
    ("accuracy.ranges.press", {"low": 1.0, "high": 2.0}, ["accuracy.ranges", "press_force"]),
    ("accuracy.ranges.friction.low", 1.0, ["accuracy.ranges.friction", "low = 1.0", "high = 0.5"]),
    ("accuracy.ranges.inertia.zero", 0.1, ["accuracy.ranges.inertia = 0.0", "> 0"]),
    ("figures.fig13.y.parameter", "tilt_stiffness", ["figures.fig13", "varied twice"]),
    ("maps.planes.stiffnesses.x.start", -1.0, ["planes.stiffnesses", "lateral_stiffness = -1.0"]),
    ("maps.planes.stiffnesses.held.tilt_stiffness", 1.0, ["tilt_stiffness: is varied in the same"]),
    ("precision.cases.aligned.figure", "fig01", ["precision.cases.aligned", "'fig01'", "fig05"]),
    ("precision.cases.aligned.at.frictoin", 0.1, ["cases.aligned.at", "frictoin", "'friction'"]),
    ("precision.hard.base.stiffness", [0.0], ["cases.base_0", "contact_stiffness = 0.0", "> 0"]),
    ("precision.hard.independent", ["slw"], ["independent", "slw", "slow"]),
    ("evidence.others", {"wdie": {}}, ["others.wdie", "'wide'", "wdie.fig05.friction: missing"]),
    ("evidence.others", {"wide": {"widht": 1.0}}, ["others.wide.widht: no unknown"]),
    ("precision.ladder.tolerances", [1e-3, 1e-2], ["[0.001, 0.01]", "must fall"]),
    ("precision.ladder.true_tolerance", 1e-9, ["true_tolerance = 1e-09", "smaller than all"]),
]


@pytest.mark.parametrize(("path", "value", "named"), REFUSED)
def test_a_fault_is_named_with_its_path_value_and_rule(mapping, path, value, named):
    *parents, last = path.split(".")
    part = functools.reduce(dict.__getitem__, parents, mapping)
    if value is MISSING:
        del part[last]
    else:
        part[last] = value
    with pytest.raises(ConfigError) as refused:
        check_study(mapping, "config")
    message = str(refused.value)
    assert message.startswith("config: ")
    for words in named:
        assert words in message


def test_every_fault_is_reported_at_once(mapping):
    mapping["structure"]["inertia"] = -1.0
    mapping["figures"]["fig08"]["held"]["friction"] = -2.0
    with pytest.raises(ConfigError) as refused:
        check_study(mapping)
    assert len(str(refused.value).splitlines()) == 2


def test_a_section_is_read_from_the_file_of_its_name_beside(mapping, tmp_path):
    maps = mapping.pop("maps")
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(mapping))
    with pytest.raises(ConfigError, match="maps: missing"):
        load_study(tmp_path / "study.yaml")
    (tmp_path / "maps.yaml").write_text(yaml.safe_dump({"maps": maps}))
    assert load_study(tmp_path / "study.yaml") == load_study(study_path())
    (tmp_path / "maps.yaml").write_text(yaml.safe_dump({"maps": maps, "accuracy": {}}))
    with pytest.raises(ConfigError, match="must state 'maps', and no other"):
        load_study(tmp_path / "study.yaml")


def test_the_study_is_as_large_as_it_must_be():
    """The floors set for the study: 3 curves of 200 points, maps of 200 x 200 nodes."""
    study = load_study(study_path())
    for name in study.named("curves"):
        assert len(study.figures[name].family.values) >= 3
        assert study.figures[name].swept.count >= 200
    for name in study.named("map"):
        assert min(study.figures[name].x.count, study.figures[name].y.count) >= 200


def test_the_accuracy_law_holds_every_value_of_the_study():
    study = load_study(study_path())
    ranges, missed = study.accuracy.ranges, []
    defaults = {field.name: field.default for field in fields(Parameters)}
    for figure in study.computed:
        sweep = sweep_of(study, figure)
        values = {name: [value] for name, value in sweep.parameters.items()}
        values |= {dimension.parameter: dimension.values for dimension in sweep.dimensions}
        for name, stated in values.items():
            law = ranges.get(name)
            for value in stated:
                if law is None:  # not drawn: the same default everywhere
                    assert value == defaults[name]
                elif not (law.low <= value <= law.high or (value == 0.0 and law.zero > 0.0)):
                    missed.append((figure, name, value))
    assert missed == []


def test_an_axis_has_both_ends_and_equal_steps():
    axis = load_study(study_path()).figures["fig07"].swept
    assert axis.values[0] == axis.start
    assert axis.values[-1] == axis.stop
    steps = {round(b - a, 9) for a, b in zip(axis.values, axis.values[1:], strict=False)}
    assert len(steps) == 1


def test_the_baseline_is_the_configuration_and_the_defaults_of_the_parameters():
    study = load_study(study_path())
    assert baseline() == study.baseline
    stated = {**study.structure, **study.operating_point}
    assert baseline() == Parameters(**stated)


def values_of(section: dict[str, Any]) -> set[str]:
    """Names of all values in a section, whatever they are nested in."""
    found = set()
    for name, value in section.items():
        found |= values_of(value) if isinstance(value, dict) else {name}
    return found


def test_smoke_changes_only_sizes() -> None:
    """config/smoke.yaml laid over config.yaml: the same study but for counts, chunks and rungs."""
    smoke = yaml.safe_load((PROJECT / "config" / "smoke.yaml").read_text(encoding="utf-8"))
    del smoke["results_root"]
    assert {name: values_of(section) for name, section in smoke.items()} == {
        "figures": {"count", "chunks"},
        "maps": {"count", "chunks", "phases", "every"},
        "evidence": {"near", "assumptions"},
        "accuracy": {"sets", "chunks", "sets_a_job"},
        "precision": {
            "tolerances", "max_evaluations", "independent",
            "stiffness", "damping", "until",
        },
        "jamming": {"count"},
        "identification": {"drawn", "moved", "refined"},
    }  # fmt: skip


def test_the_map_of_a_round_peg_is_fig13_but_for_shape_and_nodes():
    study = load_study(study_path())
    plane, round_one = sweep_of(study, "fig13"), sweep_of(study, "fig13_round")
    assert round_one.settings == plane.settings.model_copy(update={"shape": "round"})
    assert round_one.parameters == plane.parameters
    for one, other in zip(round_one.dimensions, plane.dimensions, strict=True):
        assert (one.parameter, one.start, one.stop) == (other.parameter, other.start, other.stop)
    assert "shape" not in plane.settings.model_dump()  # the identity of a figure stays
