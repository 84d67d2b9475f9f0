"""Stability maps: computed nodes, reliability, and assembly from parts."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr
from scipy.ndimage import distance_transform_edt, maximum_filter

from model import Batch, align
from model.events.outcomes import Outcome
from model.study.config import Axis, Ensemble, RunSettings, Span, load_study, study_path
from model.study.io import DatasetError, write_dataset
from model.study.maps import dataset, starts
from model.study.maps import plan as plans
from model.study.maps.compute import Computation, MapNodes, areas, compute_part
from model.study.maps.dataset import assemble, map_dataset, part_dataset, read_parts
from model.study.maps.plan import MapPlan, map_plan, marks_of, plan_of
from model.study.maps.starts import ALIGNS, FAILS, NOT_TRIED

SETTINGS = RunSettings(readings="consistent", horizon=40.0, tolerance=1e-8)
X = Span(parameter="tilt_stiffness", start=2.0, stop=16.0)
Y = Span(parameter="press_force", start=1.0, stop=9.0)
ENSEMBLE = Ensemble(phases=3, tilts=[1.0, 3.0], every=4)
CELLS = 16


@pytest.fixture(scope="module")
def plan(device) -> MapPlan:
    return plan_of("trial", device, SETTINGS, (X, Y), CELLS, ENSEMBLE)


@pytest.fixture(scope="module", autouse=True)
def _coarse_cells():
    """Use coarse cells of 4, so that the full map is small enough to compute as well."""
    changed = pytest.MonkeyPatch()
    changed.setattr(plans, "COARSE", 4)
    changed.setattr(plans, "LARGEST", 4)
    changed.setattr(starts, "COARSE", 2)
    yield
    changed.undo()


@pytest.fixture(scope="module")
def nodes(plan):
    """The nodes of every step that the whole map computes."""
    return compute_part(plan)


@pytest.fixture(scope="module")
def found(plan, nodes):
    return SimpleNamespace(**assemble(plan, nodes), computed=nodes.nominal.computed)


@pytest.fixture(scope="module")
def full(plan):
    rows, columns = (each.ravel() for each in np.indices(plan.lattice.shape))
    batch = Batch.of(plan.baseline, **plan.swept(rows, columns))
    return align(batch, plan.settings.settings)


def test_unflagged_nodes_equal_the_full_grid(found, full):
    outcome = areas(full.outcome).reshape(found.outcome.shape)
    wrong = areas(found.outcome) != outcome
    assert not (wrong & (found.flagged == 0)).any()
    assert {0, 1} <= set(outcome.ravel().tolist())
    assert found.computed.mean() < 0.9
    tau = full.tau_align.reshape(found.tau_align.shape)
    computed = found.computed
    assert np.array_equal(found.tau_align[computed], tau[computed], equal_nan=True)
    assert np.array_equal(found.outcome[computed], full.outcome.reshape(tau.shape)[computed])


def test_counts_and_levels_match_the_computed_nodes(found, plan):
    count = len(plan.starts())
    assert count == 6
    assert (found.trajectories[found.computed] >= 1).all()
    ensemble = np.zeros_like(found.computed)
    ensemble[::4, ::4] = True
    assert set(found.trajectories[~ensemble].tolist()) <= {0, 1}
    tried = found.trajectories[ensemble] - found.computed[ensemble]
    assert tried.max() == count - 1  # the nominal one is known
    fails = found.outcome[::4, ::4] != Outcome.ALIGNED
    assert fails.any()
    assert not tried.reshape(fails.shape)[fails].any()
    assert not found.reliable_share[::4, ::4][fails].any()
    assert found.level.min() >= 0
    assert found.level.max() == 2
    assert np.isnan(found.tau_error[~found.computed]).all()
    assert not found.sensitive[~found.computed].any()


def test_a_reliable_node_aligns_from_every_start(found, plan):
    """Compute single nodes of the ensemble's lattice, start by start."""
    for row, column in ((0, 16), (8, 8), (16, 0), (4, 12)):
        point = {name: float(value[0]) for name, value in
                 plan.swept(np.array([row]), np.array([column])).items()}  # fmt: skip
        runs = align(
            [plan.baseline.replace(**point, **start) for start in plan.starts()],
            plan.settings.settings,
        )
        aligned = runs.outcome == Outcome.ALIGNED
        reliable = found.reliable_share[row, column] == 1.0
        assert reliable == aligned.all()
        if reliable:
            longest = [tau + 1e-6 for tau in runs.tau_align]
            assert min(longest) <= found.tau_worst[row, column] + 2e-6
            assert found.tau_worst[row, column] <= max(longest)


def test_reliable_nodes_align_and_their_worst_duration_is_the_longest(found):
    reliable = found.reliable == 1
    assert reliable.any()
    assert not reliable.all()
    assert (found.outcome[reliable] == Outcome.ALIGNED).all()
    assert (found.reliable_share[reliable] == 1.0).all()
    assert np.isnan(found.tau_worst[~reliable]).all()


def test_neighbours_try_all_starts_between_them():
    few = starts.alternating((9, 9, 32), phases=16)
    assert (few.sum(axis=2) == 8).all()
    assert (few.reshape(9, 9, 2, 16).sum(axis=2) <= 1).all()  # no phase with both tilts
    for row, column in ((0, 0), (3, 5)):
        assert few[row : row + 4, column].any(axis=0).all()
        assert few[row : row + 2, column : column + 2].any(axis=(0, 1)).all()


def test_beside_a_start_in_phase_are_two_with_every_tilt():
    fails = np.zeros((1, 2, 12), dtype=np.bool_)
    fails[0, 1, 6] = True  # of the second tilt, the first of 6 phases
    _, columns, wanted = np.nonzero(starts.adjacent_in_phase(fails, 6))
    assert set(columns.tolist()) == {1}
    assert wanted.tolist() == [0, 1, 5, 6, 7, 11]


@pytest.fixture
def tried(device, monkeypatch):
    """Try the starts of a map on the given ends, (rows, columns, starts); return (ends, runs)."""

    def tried(aligns, tilts):
        ensemble = Ensemble(phases=16, tilts=tilts, every=1)
        plan = plan_of("trial", device, SETTINGS, (X, Y), len(aligns) - 1, ensemble)
        nodes, runs = MapNodes(plan), []

        def run(_, store, which):
            assert not which[store.columns["end"] != NOT_TRIED].any()
            runs.append(which)
            store.columns["end"][which] = np.where(aligns[which], ALIGNS, FAILS)

        monkeypatch.setattr(Computation, "_run_starts", run)
        kind = np.where(aligns[:, :, 0], Outcome.ALIGNED, Outcome.LEFT_SCENE)
        Computation(plan, nodes).ensemble(nodes.ensemble, SimpleNamespace(kind=kind))
        assert nodes.tried().sum() == nodes.trajectories() == sum(which.sum() for which in runs)
        return nodes.ensemble.columns["end"], np.any(runs, axis=0)

    return tried


def test_few_starts_find_the_nodes_at_which_any_fails(tried, monkeypatch):
    """Every start has a straight border of its own, moving with its phase; islands fail as well."""
    monkeypatch.setattr(starts, "COARSE", 32)
    row, column, phase = np.ogrid[:129, :129, :16]
    border = 40.0 + 0.2 * row + 6.0 * np.cos(2.0 * np.pi * (phase - 5) / 16)
    island = np.hypot(row - 80, column - 100) < 6.0 + 6.0 * np.cos(np.pi * (phase - 9) / 8)
    one = (column > border) & ~island
    aligns = np.concatenate([one, one], axis=2)
    end, runs = tried(aligns, [1.0, 3.0])
    fails = (end == FAILS).any(axis=2) | ~aligns[:, :, 0]
    assert np.array_equal(fails, ~aligns.all(axis=2))
    assert not runs[~aligns[:, :, 0]].any()
    assert not runs[:, :, 0].any()  # the nominal one
    beside = maximum_filter(fails, 3) & aligns[:, :, 0]  # what the nominal start does not tell
    assert runs.sum() < beside.sum() * aligns.shape[2]


def test_nothing_is_tried_where_the_nominal_start_fails_even_if_the_ensemble_lacks_it(tried):
    aligns = np.zeros((17, 17, 16), dtype=np.bool_)
    _, runs = tried(aligns, [2.0])
    assert not runs.any()
    aligns[:, :, 0] = True  # stands for the nominal one as well
    end, runs = tried(aligns, [2.0])
    assert runs[:, :, 0].any()
    assert (end == FAILS).any(axis=2).all()


def test_the_excess_is_that_of_the_nearest_node_whose_starts_all_align():
    end = np.full((1, 5, 2), NOT_TRIED)
    end[0, 0] = ALIGNS
    end[0, 3], end[0, 4, 0] = (ALIGNS, FAILS), ALIGNS
    tau = np.where(end == ALIGNS, [[[7.0, 6.0]]], np.nan)
    nominal = np.array([[5.0, 9.0, 9.0, 9.0, 8.0]])
    found = starts.sum_up_starts(end, tau, np.isfinite(nominal), nominal)
    share, excess, runs = (each[0].tolist() for each in found)
    assert runs == [2, 0, 0, 2, 1]
    assert share == [1.0, 1.0, 1.0, 2.0 / 3.0, 1.0]
    assert excess == [2.0, 2.0, *excess[2:3], 0.0, 0.0]  # the third is as far from both
    assert excess[2] in {0.0, 2.0}
    untried = np.full_like(end, NOT_TRIED), np.full_like(tau, np.nan)
    assert not starts.sum_up_starts(*untried, np.isfinite(nominal), nominal)[1].any()


def test_the_margin_is_the_distance_to_the_nearest_unreliable_node(found):
    reliable = found.reliable == 1
    rows, columns = np.nonzero(~reliable)
    for row, column in ((0, 16), (3, 9), (16, 0)):
        nearest = np.hypot(rows - row, columns - column).min() / CELLS
        assert found.margin[row, column] == pytest.approx(nearest, abs=1e-12)
    assert np.array_equal(found.margin == 0.0, ~reliable)
    assert dataset._margin(np.ones((3, 3), dtype=np.bool_)).min() == math.inf
    assert distance_transform_edt(reliable).max() > 1.0


def test_between_nodes_of_the_ensemble_the_worse_value_holds():
    values = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 1.0, 1.0]])
    finer = dataset._between(np.minimum, values, 2)
    assert finer.shape == (5, 5)
    assert np.array_equal(finer[::2, ::2], values)
    assert finer[0, 3] == finer[1, 4] == finer[1, 3] == 0.0
    assert finer[3, 3] == 1.0


@pytest.mark.parametrize("parts", [1, 2, 3])
def test_parts_and_cores_do_not_change_the_map(plan, nodes, parts, tmp_path):
    paths = [tmp_path / f"{part}.nc" for part in range(parts)]
    for part, path in enumerate(paths):
        done = compute_part(plan, part, parts, cores=1 + part % 2)
        write_dataset(part_dataset(plan, part, parts, done), path)
    again = map_dataset(plan, read_parts(plan, paths), "title")
    xr.testing.assert_identical(again, map_dataset(plan, nodes, "title"))


def test_a_part_of_another_map_is_refused(plan, device, tmp_path):
    path, first = tmp_path / "0.nc", part_dataset(plan, 0, 1, MapNodes(plan))
    other = plan_of("trial", device.replace(friction=0.2), SETTINGS, (X, Y), CELLS, ENSEMBLE)
    for change in ({"config_hash": other.identity}, {"part": 1}, {"parts": 3}, {"figure": "fig14"}):
        write_dataset(first.assign_attrs(change), path)
        with pytest.raises(DatasetError, match=r"0\.nc: is not part 0 of trial; deleted"):
            read_parts(plan, [path])
        assert not path.exists()
    write_dataset(first, path)
    assert not read_parts(plan, [path]).nominal.computed.any()
    with pytest.raises(ValueError, match="part = 2: must be 0 to 1"):
        compute_part(plan, 2, 2)


def test_the_dataset_is_a_chunked_and_compressed_grid(plan, nodes, tmp_path):
    path = tmp_path / "map.nc"
    marks = [("fig06", [3.0], [1.0, 2.0])]
    write_dataset(map_dataset(plan, nodes, "title", marks), path)
    with xr.open_dataset(path) as stored:
        assert stored["tau_align"].dims == ("press_force", "tilt_stiffness")
        assert stored["tau_align"].encoding["zlib"]
        assert {"level", "trajectories", "reliable_share", "margin", "tau_worst"} <= set(stored)
        assert int(stored["trajectories"].sum()) == stored.attrs["trajectories"]
        assert stored["friction"].ndim == 0
        assert stored.attrs["summary"].startswith(f"Results at {(CELLS + 1) ** 2} points over ")
        mesh = stored["tau_align"].plot()
        assert mesh.get_array().size == (CELLS + 1) ** 2
    large = xr.Dataset({"a": (("y", "x"), np.zeros((300, 300)))})
    write_dataset(large, path)
    with xr.open_dataset(path) as stored:
        assert stored["a"].encoding["chunksizes"] == (256, 256)


def test_bad_maps_are_refused(device):
    with pytest.raises(ValueError, match="resolution = 12: must be a power of two"):
        plan_of("trial", device, SETTINGS, (X, Y), 12, None)
    with pytest.raises(ValueError, match="'tilt_stiffness' is varied twice"):
        plan_of("trial", device, SETTINGS, (X, X), 16, None)
    wide = Span(parameter="misalignment", start=0.2, stop=9.0)
    with pytest.raises(ValueError, match=r"misalignment = 9\.0: must be smaller than half_width"):
        plan_of("trial", device, SETTINGS, (X, wide), 16, None)
    uneven = Axis(parameter="press_force", start=1.0, stop=2.0, count=5)
    plan = plan_of("trial", device, SETTINGS, (X, Y), 8, None)
    with pytest.raises(ValueError, match="9 and 5 nodes"):
        MapPlan.model_validate({**plan.model_dump(), "y": uneven.model_dump()})


def test_a_map_without_an_ensemble_has_no_reliable_share(device):
    phases = Span(parameter="phase", start=0.0, stop=6.0)
    plan = plan_of("trial", device, SETTINGS, (X, phases), 4, ENSEMBLE)
    assert plan.ensemble is None
    found = assemble(plan, MapNodes(plan))
    assert set(found) == set(dataset.MAP_VARIABLES)
    assert np.isnan(found["reliable_share"]).all()
    assert np.array_equal(found["reliable"] == 1, found["outcome"] == Outcome.ALIGNED)


def test_the_maps_of_the_study_cover_the_ranges_of_its_figures():
    study = load_study(study_path())
    for name in study.map_names:
        plan = map_plan(study, name)
        plane = study.plane(name)
        assert (plan.x.start, plan.x.stop) == (plane.x.start, plane.x.stop)
        assert plan.cells == (1024 if name in ("fig13", "fig14") else 512)
        assert len(plan.starts()) >= 16
    marks = marks_of(study, "fig13")
    five = study.parameters("fig05")
    assert ("fig05", [five.tilt_stiffness], [five.press_force]) in marks
    swept = study.figures["fig06"].swept
    assert ("fig06", [study.figures["fig06"].family.values[0]], [swept.start, swept.stop]) in marks
