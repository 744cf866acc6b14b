"""What the stages cost, as they were measured, and what a plan is made from.

Measured 2026-11-22 on two x86-64 cores of a virtual machine (no graphics processor), with the
embedded city: panoramas of 4096x2048 px, maps of 1024x512 px, the shipped expansion model and the
settings' defaults. Processor seconds of one core; they grow with pixels as the comments say.
"""

from dataclasses import dataclass

MEASURED = "2026-11-22, two x86-64 cores of a virtual machine, embedded city, 4096x2048 px"


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCost:
    """What one item of a stage takes.

    Attributes:
        cpu_s: Processor seconds.
        bytes: That stay on disk.
        unit: What an item is.
        per_pixel: Whether both grow with the pixels of a picture, or of a map.
        reference_px: The width that they were measured at.
    """

    cpu_s: float
    bytes: float
    unit: str = "panorama"
    per_pixel: bool = False
    reference_px: int = 4096


COSTS: dict[str, StageCost] = {
    "fetch": StageCost(cpu_s=0.05, bytes=0.68e6, per_pixel=True),
    "stitch": StageCost(cpu_s=0.36, bytes=1.9e6, per_pixel=True),
    "inpaint": StageCost(cpu_s=2.4, bytes=1.9e6, per_pixel=True),
    "expand": StageCost(cpu_s=1.1, bytes=5.3e6, per_pixel=True, reference_px=1024),
    "qa": StageCost(cpu_s=0.5, bytes=0.25e6),
    "probes": StageCost(cpu_s=0.25, bytes=5.4e6, per_pixel=True, reference_px=1024),
    "references": StageCost(cpu_s=26.0, bytes=0.4e6, unit="rendered map"),
    "dataset": StageCost(cpu_s=0.0, bytes=0.0, unit="dataset"),
    "train": StageCost(cpu_s=0.0, bytes=20e6, unit="model"),
    "evaluate": StageCost(cpu_s=0.3, bytes=2e3, unit="sample"),
}
# Processor seconds and bytes of one sample, by renderer; they grow with the pictures' pixels.
SAMPLE_COSTS: dict[str, StageCost] = {
    "analytic": StageCost(cpu_s=0.9, bytes=0.25e6, unit="sample", per_pixel=True, reference_px=64),
    "mitsuba": StageCost(cpu_s=0.65, bytes=0.6e6, unit="sample", per_pixel=True, reference_px=128),
    "blender": StageCost(cpu_s=6.0, bytes=0.6e6, unit="sample", per_pixel=True, reference_px=128),
}
# Forward, backward and update of one sample of 64x64 px by a stereo network of width 8.
TRAIN_SAMPLE_CPU_S = 0.004
TRAIN_WIDTH, TRAIN_INPUT_PX = 8, 64


def at_width(cost: StageCost, width_px: int) -> StageCost:
    """The cost of a picture of another width; half as high, so it goes with the square."""
    if not cost.per_pixel:
        return cost
    scale = (width_px / cost.reference_px) ** 2
    return StageCost(cpu_s=cost.cpu_s * scale, bytes=cost.bytes * scale, unit=cost.unit)
