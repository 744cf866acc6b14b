"""Every threshold of QA, in one class: a stored figure and these settings give its verdict."""

from pydantic import Field

from panokit.settings import Settings

VERSION = "3"


class QaSettings(Settings):
    """What a map must be like to pass.

    The limits were set on captured light probes, one half of the places, so that what a good
    camera rig delivers passes: indoor, overcast and night maps as well as a bare sun.
    docs/ideas/qa-checks.md tells how they do on the other half.
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

    clipped_area_max_percent: float = Field(0.02, ge=0, le=100)
    """Largest share of the sphere on a flat plateau at the map's maximum."""

    clipped_source_max_px: float = Field(3.0, ge=0)
    """Most equally bright pixels, of a map 1024 wide, at the top of a small source."""

    contrast_min: float = Field(0.6, ge=0)
    """Least contrast, as a multiple of that of captured light; a gamma left in gives 0.45."""

    contrast_max: float = Field(2.0, ge=0)
    """Largest contrast, as a multiple of that of captured light; a curve undone twice gives 2.2."""

    source_share_max: float = Field(0.995, ge=0, le=1)
    """Largest share of the light from sources; more leaves no ambient light."""

    twin_share_max: float = Field(0.1, ge=0, le=1)
    """Largest share of the light of the weaker of two small sources that are as good as equal."""

    expansion_gain_min: float = Field(0.9, ge=0)
    """Least energy after expansion over that before; expansion takes no light away."""

    expansion_gain_max: float = Field(300.0, ge=0)
    """Most energy after expansion over that before; a bare sun gives about 20."""

    recorded_light_max_deg: float = Field(4.0, ge=0)
    """Largest angle between the strongest recorded light and the nearest light in the map."""

    light_temperature_min_kelvin: float = Field(1500.0, ge=1000)
    """Least color temperature of the light as a whole; a candle has 1900."""

    light_temperature_max_kelvin: float = Field(30000.0, ge=1000)
    """Largest color temperature of the light as a whole; open shade has 10000 to 20000."""

    sky_temperature_min_kelvin: float = Field(3500.0, ge=1000)
    """Least color temperature of a smooth sky overhead."""

    channel_order_min: float = -0.85
    """Least octaves by which what is above is bluer than what is below; swapped below that."""

    seam_max: float = Field(10.0, ge=0)
    """Largest deviation of the columns at the wrap seam, in standard deviations of all columns."""

    seam_repeat_min: float = Field(0.3, ge=0)
    """Least step across the seam over the steps beside it; a repeated column has none."""

    pole_max: float = Field(0.8, ge=0)
    """Most of the fine detail around a pole that may be left at the pole; a pinwheel has all."""

    tilt_max_deg: float = Field(3.4, ge=0)
    """Largest angle between the map's up and that of its upright lines or of its horizon."""

    uprightness_min: float = -0.5
    """Least octaves of light from above over that from below; upside down below that."""

    sharpness_min: float = Field(0.33, ge=0)
    """Least strength of the finest detail over that twice as coarse; enlarged below that."""

    empty_area_max_percent: float = Field(1.0, ge=0, le=100)
    """Largest share of the sphere that is exactly black: padding, or tiles that never came."""

    hole_area_max_percent: float = Field(0.1, ge=0, le=100)
    """Largest share of the sphere in holes that were found and not filled."""

    filled_area_max_percent: float = Field(25.0, ge=0, le=100)
    """Largest share of the sphere that was made up to fill holes."""

    sun_place_max_deg: float = Field(6.0, ge=0)
    """Largest angle between the map's sun and where it stood by place and time."""

    sun_clock_max_h: float = Field(0.25, ge=0)
    """Largest error of the clock, in hours, that the sun may betray."""

    sun_date_max_deg: float = Field(5.0, ge=0)
    """How far the map's sun may be outside of all its places on a date without a time."""

    plausibility_max: float = Field(4.0, ge=0)
    """Largest distance from the captured maps of the nearest category, 1 being typical."""

    reference_count_min: int = Field(8, ge=2)
    """Fewest reference maps that make a distribution; with fewer no percentile is given."""

    comparison_width_px: int = Field(512, ge=16, multiple_of=2)
    """Maps are compared with their reference at this width, or at the smaller of the two."""
