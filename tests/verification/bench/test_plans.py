"""Plans: numbers only, so that a change of wording computes nothing anew."""

import pytest

from study.config import Study, load_study, study_path
from verification.bench.plans import precision_plan


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(study_path())


def with_case(study: Study, **changes: object) -> Study:
    cases = study.precision.cases
    cases = cases | {"aligned": cases["aligned"].model_copy(update=changes)}
    precision = study.precision.model_copy(update={"cases": cases})
    return study.model_copy(update={"precision": precision})


def test_wording_is_no_part_of_a_plan(study: Study) -> None:
    plan = precision_plan(study)
    assert precision_plan(with_case(study, title="x", reason="y")).identity == plan.identity
    other = precision_plan(with_case(study, at={"friction": 0.03}))
    assert other.identity != plan.identity
    assert other.cases["aligned"].parameters["friction"] == 0.03
