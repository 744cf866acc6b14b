"""What samples are drawn from: objects and lights, each in one split only."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from panokit.dataset.lights import Lights, digest_of_file_list, open_lights
from panokit.dataset.objects.catalog import ObjectCatalog, open_catalog
from panokit.dataset.objects.folder import PREFIX
from panokit.dataset.sample import SPLITS
from panokit.dataset.settings import DatasetSettings
from panokit.dataset.splits import assign_splits, group_by_shared_keys
from panokit.provenance import digest_of

FOLDER = PREFIX.rstrip("/")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stock:
    """Objects and lights with their splits.

    Attributes:
        objects: The catalog of objects.
        lights: The maps.
        objects_of: Split -> kind -> ids of its objects; meshes of a folder are of the kind
            "folder".
        lights_of: Split -> ids of its lights.
        digest: Of everything that samples are drawn from.
    """

    objects: ObjectCatalog
    lights: Lights
    objects_of: dict[str, dict[str, tuple[str, ...]]]
    lights_of: dict[str, tuple[str, ...]]
    digest: str


def open_stock(
    settings: DatasetSettings, probes: Sequence[Path], *, packed: Path | None = None
) -> Stock:
    """The objects and lights of a dataset, split by place and by object.

    Args:
        settings: Of the dataset.
        probes: Where the light is from, see `panokit.dataset.lights.open_lights`.
        packed: A folder in which maps are kept at their working size, or None.

    Raises:
        UsageError: If there is no light, or too few places or objects to split.
        LicenseError: If a map may not be trained with.
    """
    objects = open_catalog(settings.objects)
    lights = open_lights(
        probes,
        own_right=settings.light.own_right,
        selection=Path(settings.light.selection) if settings.light.selection else None,
        packed=packed,
    )
    place_split = assign_splits([light.place for light in lights.all.values()], settings, "places")
    object_groups = group_by_shared_keys(
        {id: [f"content:{objects.digest(id)}"] for id in objects.ids()}
    )
    object_split = assign_splits(list(object_groups.values()), settings, "objects")
    return Stock(
        objects=objects,
        lights=lights,
        objects_of={
            split: _by_kind(id for id in objects.ids() if object_split[object_groups[id]] == split)
            for split in SPLITS
        },
        lights_of={
            split: tuple(
                id for id, light in lights.all.items() if place_split[light.place] == split
            )
            for split in SPLITS
        },
        digest=digest_of(
            [
                digest_of_file_list(lights),
                [[id, objects.digest(id)] for id in objects.ids()],
            ]
        ),
    )


def _by_kind(ids: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """Ids by what stands before their last number, kinds in the order of the alphabet."""
    kinds: dict[str, list[str]] = {}
    for id in ids:
        kind = FOLDER if id.startswith(PREFIX) else id.rpartition("-")[0]
        kinds.setdefault(kind, []).append(id)
    return {kind: tuple(kinds[kind]) for kind in sorted(kinds)}
