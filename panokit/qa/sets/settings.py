"""What sets of maps are compared by."""

from pydantic import Field

from panokit.settings import Settings


class SetSettings(Settings):
    """The rules by which a set is said to add to the reference, or to distort it."""

    seed: int = Field(0, ge=0)
    """Of permutations, bootstraps and drawings: the same seed gives the same figures."""

    permutations: int = Field(1999, ge=99)
    """How often the labels of the sets are shuffled for a p value. With fewer than 500 no single
    figure among 25 can be said to differ."""

    resamples: int = Field(1000, ge=100)
    """How often a bootstrap draws the scenes anew for an interval."""

    maps_max: int = Field(2000, ge=16)
    """Of larger sets so many maps are drawn for the tests; every map has its figures."""

    false_discovery: float = Field(0.05, gt=0, lt=1)
    """The share of false alarms accepted among the figures that are said to differ."""

    shift_min: float = Field(0.25, ge=0)
    """Least shift of the median, in interquartile ranges of the reference, that distorts."""

    same_within: float = Field(0.5, gt=0)
    """A figure is the same if the interval of the shift stays within so many of these ranges."""

    narrower_max: float = Field(0.67, gt=0, lt=1)
    """A spread under this share of the reference's, interval and all, is variety lost."""

    outside_expected: float = Field(0.1, gt=0, lt=1)
    """The share of maps outside the reference's 5 to 95 % range that the reference has itself."""

    neighbors: int = Field(5, ge=1)
    """The k of the k nearest neighbors in precision, recall, density and coverage."""
