"""Every protocol by name: what it is called, computed by, measured in, and where it is from.

An evaluator asks this table instead of knowing functions, and a figure is quoted with a name of
it. `score` takes what `takes` says:

- "maps": estimate and truth, linear radiance (H, W, 3) of one size, frame and scale;
- "renders": RGBA of a scene under both maps;
- "frames": RGB of a scene under both maps, judged whole;
- "object images": estimate, truth, and the mask of the object;
- "features": two sets of features, (n, d) and (m, d).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib import import_module
from types import MappingProxyType
from typing import Any, Literal

from panokit.errors import UsageError
from panokit.metrics.pairs import Radiance

Takes = Literal["maps", "renders", "frames", "object images", "features"]
Better = Literal["lower", "higher", "near 0", "near 1"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricProtocol:
    """One figure.

    Attributes:
        name: What a figure is quoted with.
        function: Its module below `panokit.metrics` and its name there.
        takes: What `score` is called with.
        unit: Of the figure; "" for ratios.
        better: Which way is better.
        source: Where the definition is from.
        variant: "compat" as published, "fixed" put right, or "native".
        options: Keyword arguments that make the function this protocol.
        part: Which attribute of the function's result it is; "" for the result itself.
    """

    name: str
    function: str
    takes: Takes
    unit: str
    better: Better
    source: str
    variant: Literal["compat", "fixed", "native"] = "native"
    options: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    part: str = ""

    def score(self, *inputs: Any) -> float:
        """The figure of these inputs."""
        return self.part_of(self.result(*inputs))

    def result(self, *inputs: Any) -> Any:
        """What the function returns, of which several protocols may be parts."""
        module, name = self.function.split(":")
        function = getattr(import_module(f"panokit.metrics.{module}"), name)
        return function(*inputs, **self.options)

    def part_of(self, result: Any) -> float:
        """This figure out of a `result`."""
        return float(getattr(result, self.part) if self.part else result)


def _native(
    name: str,
    function: str,
    unit: str,
    better: Better = "lower",
    part: str = "",
    source: str = "panokit-v1",
    **options: Any,
) -> MetricProtocol:
    return MetricProtocol(
        name=name,
        function=function,
        takes="maps",
        unit=unit,
        better=better,
        source=source,
        options=MappingProxyType(options),
        part=part,
    )


def _both(
    name: str,
    function: str,
    takes: Takes,
    parts: Mapping[str, str],
    source: str,
    **options: Any,
) -> list[MetricProtocol]:
    """The protocol as published and put right, for each of its figures and units."""
    return [
        MetricProtocol(
            name="-".join(filter(None, (name, part.replace("_", "-"), variant))),
            function=function,
            takes=takes,
            unit=unit,
            better="higher" if unit == "dB" or part == "ssim" else "lower",
            source=source,
            variant=variant,
            options=MappingProxyType({"variant": variant, **options}),
            part=part,
        )
        for variant in ("compat", "fixed")
        for part, unit in parts.items()
    ]


_THESIS = "Parker 2018, chapter 5"
_PU21 = "Mantiuk and Azimi 2021"
_CRF = "Hanji et al. 2022"
_RELIT_PARTS = {"rmse": "radiance", "si_rmse": "radiance", "angular_deg": "°"}
_SPHERE_PARTS = {**_RELIT_PARTS, "normalized_rmse": ""}

_ROWS: list[MetricProtocol] = [
    _native("l1", "differences:l1", "radiance"),
    _native("relative-l1", "differences:relative_l1", ""),
    _native("mse", "differences:mse", "radiance²"),
    _native("ssd", "differences:ssd", "radiance²"),
    _native("log-rmse", "differences:log_rmse", "decades"),
    _native("si-rmse", "differences:si_rmse", "radiance"),
    _native("si-rmse-rgb", "differences:si_rmse", "radiance", per_channel=True),
    _native("rgb-angular", "differences:rgb_angular_deg", "°"),
    _native("psnr-clip", "differences:psnr_db", "dB", "higher", peak=1.0),
    _native("dssim-sphere", "similarity:dssim_of_maps", "", preset="sphere", encoding="srgb"),
    _native("dssim-wang", "similarity:dssim_of_maps", "", preset="wang", encoding="srgb"),
    _native("irradiance-sh2", "irradiance_error:irradiance_sh_error", ""),
    _native("irradiance-mean", "irradiance_error:irradiance_axis_errors", "", part="mean"),
    _native("irradiance-max", "irradiance_error:irradiance_axis_errors", "", part="max"),
    _native("energy-ratio", "lighting:energy_ratio", "", "near 1"),
    _native("beyond-clip-ratio", "lighting:beyond_clip_ratio", "", "near 1"),
    _native("light-vector", "lighting:light_vector_error_deg", "°"),
    _native("peak", "lighting:peak_error_deg", "°"),
    _native("brightest", "brightest:brightest_deg", "°"),
    _native("sun-energy", "sun_energy:sun_energy_stops", "stops", "near 0"),
    *(
        _native(f"lights-{part.replace('_', '-')}", "light_matching:light_errors", unit, part=part)
        for part, unit in {
            "angle_deg": "°",
            "size_stops": "stops",
            "intensity_stops": "stops",
            "color_deg": "°",
            "missed": "lights",
            "spurious": "lights",
        }.items()
    ),
    *(
        _native(
            f"relit-{scene}-{part.replace('_', '-')}",
            "relit:relit_errors",
            unit,
            part=part,
            scene=scene,
        )
        for scene in ("diffuse", "glossy-0.1", "glossy-0.3", "glossy-0.6", "mirror", "plane")
        for part, unit in _RELIT_PARTS.items()
    ),
    _native("pu21-psnr", "pu21:pu21_psnr", "dB", "higher", source=_PU21),
    _native("pu21-psnr-y", "pu21:pu21_psnr_y", "dB", "higher", source=_PU21),
    _native("pu21-ssim", "pu21:pu21_ssim", "", "higher", source=_PU21),
    _native("pu21-crf-psnr", "pu21:pu21_crf_psnr", "dB", "higher", source=_CRF),
    *(
        MetricProtocol(
            name=name,
            function=function,
            takes="maps",
            unit=unit,
            better="lower",
            source=_THESIS,
            variant="compat",
            options=MappingProxyType(options),
        )
        for name, function, unit, options in (
            ("thesis-mse", "differences:mse", "radiance²", {"weighting": "pixel"}),
            ("thesis-ssd", "differences:ssd", "radiance²", {"weighting": "pixel"}),
            (
                "thesis-dssim",
                "similarity:dssim_of_maps",
                "",
                {"preset": "thesis", "encoding": "linear"},
            ),
            (
                "thesis-dssim-log",
                "similarity:dssim_of_maps",
                "",
                {"preset": "thesis", "encoding": "log"},
            ),
            ("thesis-brightest-luma", "brightest:brightest_px", "px", {"wrap": "none"}),
            (
                "thesis-brightest-rgb",
                "brightest:brightest_px",
                "px",
                {"wrap": "none", "reading": "rgb-mean"},
            ),
        )
    ),
    *_both("spheres", "spheres:sphere_errors", "renders", _SPHERE_PARTS, "StyleLight 2022"),
    *_both(
        "array",
        "sphere_array:array_errors",
        "frames",
        {**_RELIT_PARTS, "psnr_db": "dB"},
        "Weber et al. 2022",
    ),
    *_both(
        "light-direction",
        "light_direction:light_direction_error_deg",
        "maps",
        {"": "°"},
        "EnvMapNet 2021",
    ),
    *_both("frechet", "frechet:frechet_distance", "features", {"": ""}, "EnvMapNet 2021"),
    *_both("orb-hdr", "orb:orb_psnr_db", "object images", {"": "dB"}, "Stanford-ORB", preset="hdr"),
    *_both("orb-ldr", "orb:orb_psnr_db", "object images", {"": "dB"}, "Stanford-ORB", preset="ldr"),
    *_both(
        "owl",
        "owl:score_owl",
        "object images",
        {"psnr_db": "dB", "ssim": ""},
        "Objects With Lighting",
    ),
]

PROTOCOLS: Mapping[str, MetricProtocol] = MappingProxyType({row.name: row for row in _ROWS})


def protocol(name: str) -> MetricProtocol:
    """The protocol of this name.

    Raises:
        UsageError: If there is none.
    """
    if name not in PROTOCOLS:
        near = ", ".join(get_close_matches(name, PROTOCOLS, cutoff=0.4)) or "none"
        raise UsageError(
            f"There is no protocol {name!r}; alike are: {near}. All are in "
            "panokit.metrics.PROTOCOLS."
        )
    return PROTOCOLS[name]


def native_scores(estimate: Radiance, truth: Radiance) -> dict[str, float]:
    """All figures of the set "panokit-v1" and the PU21 figures, by name.

    Args:
        estimate: (H, W, 3), linear, 2:1, on the truth's scale (`panokit.metrics.alignment`);
            in units of the clip level, which PSNR and DSSIM take as their peak.
        truth: As `estimate`.
    """
    results: dict[tuple[str, str], Any] = {}
    scores = {}
    for name, row in PROTOCOLS.items():
        if row.variant != "native":
            continue
        call = row.function, repr(row.options)
        if call not in results:
            results[call] = row.result(estimate, truth)
        scores[name] = row.part_of(results[call])
    return scores
