"""Figures of real probes, against those that another implementation measured."""

import pytest

from panokit.evaluate import probe_set
from panokit.evaluate.predictors import analytic_methods
from panokit.evaluate.scoring import score_picture, take_picture

pytestmark = pytest.mark.data

# Camera A, the decoded picture: energy ratio and irradiance error.
MEASURED = {
    "adams_place_bridge": (0.34, 0.52),
    "aerodynamics_workshop": (0.50, 0.48),
    "aristea_wreck_puresky": (0.88, 0.09),
    "chinese_garden": (0.25, 0.47),
}


@pytest.fixture(autouse=True)
def _full_size(monkeypatch):
    monkeypatch.setattr(probe_set, "PROBE_WIDTH_PX", 1024)


@pytest.mark.parametrize("name", sorted(MEASURED))
def test_decoded_pictures_score_as_they_did_elsewhere(shared_data, name):
    probes = probe_set.find_probes(shared_data / "probes")
    index = [probe.name for probe in probes].index(name)
    probe = probes[index]
    picture = take_picture(probe, probe.radiance(), "A", index=index, fold=0)
    srgb = next(method for method in analytic_methods() if method.name == "sRGB")
    values = score_picture("sRGB", srgb.predictor(0), picture, rolled=False).values
    assert values["energy_ratio"] == pytest.approx(MEASURED[name][0], abs=0.015)
    assert values["irradiance_mean"] == pytest.approx(MEASURED[name][1], abs=0.015)


def test_the_real_list_splits_into_folds_of_whole_places(shared_data):
    probes = probe_set.find_probes(shared_data / "probes")
    folds = probe_set.assign_folds(probes, 5)
    assert len(probes) == 77
    assert min(sum(folds == fold) for fold in range(5)) >= 12
    assert sum(folds == 0) >= 15
