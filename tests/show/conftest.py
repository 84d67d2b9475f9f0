"""What the tests of figures and report share."""

from collections.abc import Callable

import pytest

from model.study.config import Curves, Family, Map, Study, load_study, study_path


@pytest.fixture(scope="session")
def small_study() -> Callable[[int, int], Study]:
    """The study of the project with two curves of ``points`` and maps of ``cells`` squared."""

    def make(points: int, cells: int) -> Study:
        full = load_study(study_path())
        small = dict(full.figures)
        for name, spec in full.figures.items():
            if isinstance(spec, Curves):
                swept = spec.swept.model_copy(update={"count": points})
                few = Family(parameter=spec.family.parameter, values=spec.family.values[:2])
                small[name] = spec.model_copy(update={"swept": swept, "family": few})
            elif isinstance(spec, Map):
                x, y = (axis.model_copy(update={"count": cells}) for axis in (spec.x, spec.y))
                small[name] = spec.model_copy(update={"x": x, "y": y})
        return full.model_copy(update={"figures": small})

    return make
