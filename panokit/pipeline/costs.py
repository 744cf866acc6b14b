"""What the stages cost, as they were measured, and what a plan is made from.

Processor seconds are of one core, one thread; bytes are what stays on disk. A cost has a part that
is the same for every item and one that grows with the pixels of its pictures.
"""

from dataclasses import dataclass

# Two x86-64 cores of a virtual machine, no graphics processor; the settings' defaults.
MEASURED = "2026-11-22 on a virtual x86-64 core, with the embedded city"


@dataclass(frozen=True, slots=True, kw_only=True)
class StageCost:
    """What one item of a stage takes.

    Attributes:
        unit: What an item is.
        cpu_s: Processor seconds, whatever the size.
        bytes: On disk, whatever the size.
        pixel_cpu_s: Processor seconds of a picture of `reference_px`.
        pixel_bytes: Bytes of a picture of `reference_px`.
        reference_px: The width that was measured.
    """

    unit: str = "panorama"
    cpu_s: float = 0.0
    bytes: float = 0.0
    pixel_cpu_s: float = 0.0
    pixel_bytes: float = 0.0
    reference_px: int = 4096


# Pictures of 4096x2048 px, maps of 1024x512 px, the shipped expansion model.
COSTS: dict[str, StageCost] = {
    "fetch": StageCost(cpu_s=0.01, pixel_cpu_s=0.06, pixel_bytes=0.69e6),
    "stitch": StageCost(pixel_cpu_s=0.49, pixel_bytes=1.83e6),
    "inpaint": StageCost(pixel_cpu_s=2.5, pixel_bytes=1.86e6),
    "expand": StageCost(cpu_s=1.5, pixel_cpu_s=0.8, pixel_bytes=5.27e6, reference_px=1024),
    "qa": StageCost(cpu_s=0.4, bytes=0.35e6),
    "probes": StageCost(cpu_s=0.1, pixel_cpu_s=0.15, pixel_bytes=5.32e6, reference_px=1024),
    "references": StageCost(unit="rendered map", cpu_s=25.0, bytes=0.4e6),
}
# One sample with all its members, by renderer; Mitsuba with 64 paths per pixel.
SAMPLE_COSTS: dict[str, StageCost] = {
    "analytic": StageCost(unit="sample", pixel_cpu_s=0.15, pixel_bytes=0.3e6, reference_px=64),
    "mitsuba": StageCost(
        unit="sample", cpu_s=0.2, pixel_cpu_s=0.21, pixel_bytes=0.6e6, reference_px=128
    ),
    "blender": StageCost(unit="sample", cpu_s=3.0, pixel_cpu_s=0.43, pixel_bytes=0.6e6,
                         reference_px=128),
}  # fmt: skip
# Start of torch, export to ONNX and the check of what was exported.
TRAIN_START_CPU_S, TRAIN_BYTES = 6.0, 13e6
# Forward, backward and update of one sample by a stereo network of this width and input.
TRAIN_SAMPLE_CPU_S, TRAIN_WIDTH, TRAIN_INPUT_PX = 0.004, 8, 64
# All figures of one prediction.
SCORE_CPU_S, SCORE_BYTES = 0.11, 1.2e3


def at_width(cost: StageCost, width_px: int) -> StageCost:
    """The cost of a picture of another width; half as high, so it goes with the square."""
    scale = (width_px / cost.reference_px) ** 2
    return StageCost(
        unit=cost.unit,
        cpu_s=cost.cpu_s + cost.pixel_cpu_s * scale,
        bytes=cost.bytes + cost.pixel_bytes * scale,
    )
