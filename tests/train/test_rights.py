"""What may not be trained with is refused, unless the user has a right of their own."""

import csv

import numpy as np
import pytest

from panokit.capture import Capture, License, license_from_spdx, require_right_to_train
from panokit.envmap import EnvironmentMap
from panokit.errors import LicenseError
from panokit.io import write_environment_map
from panokit.train.probes import check_rights, read_probes

OPEN = license_from_spdx("CC-BY-4.0", "me")
GOOGLE = License(id="google-maps-platform", attribution="Google Maps")


def picture(name, terms):
    return Capture(provider="t", id=name, license=terms)


def test_open_licenses_pass():
    require_right_to_train([picture("a", OPEN)])
    require_right_to_train([])


def test_terms_that_forbid_it_are_refused_by_name():
    pictures = [picture("a", OPEN), picture("b", GOOGLE), picture("c", GOOGLE)]
    with pytest.raises(LicenseError) as caught:
        require_right_to_train(pictures)
    assert "t-b and 1 more: the license 'google-maps-platform'" in str(caught.value)
    assert "--own-right" in str(caught.value)
    with pytest.raises(LicenseError):
        require_right_to_train(pictures, own_right="  ")
    require_right_to_train(pictures, own_right="agreement with Google of 2026-01-05")


@pytest.fixture
def folder(tmp_path):
    """Two probes: one with a record, one without."""
    rows = []
    for name, capture in (("known", picture("b", GOOGLE)), ("bare", None)):
        envmap = EnvironmentMap(radiance=np.ones((32, 64, 3), np.float32), capture=capture)
        write_environment_map(envmap, tmp_path / f"{name}.exr")
        row = {"name": name, "file": f"{name}.exr", "category": "urban", "split_group": name}
        rows.append({**row, "sha256": "0" * 64, "usable_for": "training"})
    (tmp_path / "bare.json").unlink()
    with (tmp_path / "manifest.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    return tmp_path


def test_training_looks_at_the_records(folder):
    probes = read_probes(folder)
    with pytest.raises(LicenseError, match="t-b: the license"):
        check_rights(probes)
    check_rights(probes, own_right="mine")
    check_rights([probe for probe in probes if probe.name == "bare"])
