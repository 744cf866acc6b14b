import numpy as np
import pytest

from panokit.errors import ImageError
from panokit.io.finite import check_finite, repaired


def test_counts_and_cause_are_told():
    broken = np.array([1.0, np.nan, np.inf, -np.inf, -2.0], np.float32)
    with pytest.raises(ImageError, match=r"a\.exr has 1 nan, 2 inf, 2 negative.*A cause\.") as e:
        check_finite(broken, "a.exr", "A cause.")
    assert e.value.values == {"nan": 1, "inf": 2, "negative": 2}
    check_finite(np.array([-1.0, 5.0]), "a.exr")  # negative alone is a color out of gamut
    check_finite(np.empty(0), "a.exr")


def test_repair_takes_the_ends_of_what_is_finite():
    broken = np.array([1.0, np.nan, np.inf, -np.inf, -2.0, 7.0], np.float32)
    np.testing.assert_array_equal(repaired(broken), [1, 0, 7, -2, -2, 7])
    np.testing.assert_array_equal(repaired(np.full(3, np.nan, np.float32)), 0)
