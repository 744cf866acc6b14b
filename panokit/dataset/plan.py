"""Draw a sample: everything that is random about it, from the seed and its number."""

from collections.abc import Mapping

import numpy as np

from panokit.dataset.lights import LIGHT_WIDTH_PX
from panokit.dataset.materials import draw_material
from panokit.dataset.sample import SamplePlan
from panokit.dataset.settings import DatasetSettings, Range
from panokit.dataset.splits import split_of_index
from panokit.dataset.stock import FOLDER, Stock


def draw_plan(settings: DatasetSettings, stock: Stock, index: int, attempt: int = 0) -> SamplePlan:
    """The plan of sample `index`, the same wherever and whenever it is drawn.

    Args:
        settings: Of the dataset.
        stock: What there is to draw from.
        index: From 0.
        attempt: How many plans of this sample were rejected before; each draws anew. The split
            stays.
    """
    rng = np.random.default_rng([settings.seed, index, attempt])
    split = split_of_index(settings, index)
    lights = stock.lights_of[split]
    probe_id = lights[int(rng.integers(len(lights)))]
    object_id = _draw_object(rng, settings, stock.objects_of[split])
    parts = stock.objects.load(object_id).part_count
    count = int(rng.integers(1, min(parts, settings.objects.materials) + 1))
    materials = tuple(draw_material(rng, settings.objects) for _ in range(count))
    # Each material is on some part; which is on the others is left to chance.
    of_part = [*range(count), *rng.integers(count, size=parts - count).tolist()]
    return SamplePlan(
        index=index,
        attempt=attempt,
        split=split,
        object_id=object_id,
        probe_id=probe_id,
        materials=materials,
        material_of_part=tuple(int(number) for number in rng.permutation(of_part)),
        # Whole pixels: turning the map is then an exact roll.
        yaw_deg=float(rng.integers(LIGHT_WIDTH_PX)) * 360.0 / LIGHT_WIDTH_PX,
        tilt_deg=float(rng.uniform(0, settings.light.tilt_deg)),
        tilt_toward_deg=float(rng.uniform(0, 360)),
        exposure_stops=float(rng.normal(0, settings.light.exposure_stops)),
        on_floor=bool(rng.random() < settings.floor_share),
        object_turn_deg=float(rng.uniform(0, 360)),
        baseline_m=_draw(rng, settings.rig.baseline_m),
        fill=_draw(rng, settings.rig.fill),
        pitch_deg=_draw(rng, settings.rig.pitch_deg),
        roll_deg=float(rng.uniform(-settings.rig.roll_deg, settings.rig.roll_deg)),
        render_seed=int(rng.integers(2**31)),
    )


def _draw_object(
    rng: np.random.Generator, settings: DatasetSettings, by_kind: Mapping[str, tuple[str, ...]]
) -> str:
    """One of the ids: of a mesh from the folder as often as asked, else of each kind alike."""
    kinds = [kind for kind in by_kind if kind != FOLDER]
    take_mesh = bool(rng.random() < settings.objects.mesh_share)
    if not kinds or (take_mesh and FOLDER in by_kind):
        chosen = by_kind[FOLDER]
    else:
        chosen = by_kind[kinds[int(rng.integers(len(kinds)))]]
    return chosen[int(rng.integers(len(chosen)))]


def _draw(rng: np.random.Generator, limits: Range) -> float:
    return float(rng.uniform(*limits))
