"""Every threshold of QA, in one class: a stored figure and these settings give its verdict."""

from pydantic import Field

from panokit.settings import Settings

VERSION = "2"


class QaSettings(Settings):
    """What a map must be like to pass.

    The limits were set on captured light probes, so that what a good camera rig delivers
    passes: indoor, overcast and night maps as well as a bare sun.
    """

    energy_min: float = Field(1e-6, ge=0)
    """Least mean radiance over the sphere; below it the map is black."""

    ledger_error_max: float = Field(1e-4, ge=0)
    """Largest relative difference between the energy recorded by a stage and that of the file."""

    dynamic_range_min_stops: float = Field(3.0, ge=0)
    """Least number of stops between the median and the peak of luminance."""

    dynamic_range_max_stops: float = Field(30.0, ge=0)
    """Most stops between the median and the peak; more means a broken scale, not a bright sun."""

    top_share_min: float = Field(0.003, ge=0, le=1)
    """Least share of the energy in the brightest 0.1 % of the sphere; a uniform map has 0.001."""

    top_share_max: float = Field(0.99, ge=0, le=1)
    """Largest share of the energy in the brightest 0.1 % of the sphere."""

    seam_max: float = Field(2.6, ge=0)
    """Largest step across the wrap seam, as a multiple of the steps between columns beside it."""

    pole_max: float = Field(0.8, ge=0)
    """Most of the fine detail around a pole that may be left at the pole; a pinwheel has all."""

    clipped_area_max_percent: float = Field(0.02, ge=0, le=100)
    """Largest share of the sphere on a flat plateau at the map's maximum."""

    reference_count_min: int = Field(8, ge=2)
    """Fewest reference maps that make a distribution; with fewer no percentile is given."""

    comparison_width_px: int = Field(512, ge=16, multiple_of=2)
    """Maps are compared with their reference at this width, or at the smaller of the two."""
