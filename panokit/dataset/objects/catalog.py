"""All objects that a dataset draws from, by id: procedural ones and those of a folder."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from pathlib import Path

from panokit.dataset.objects.folder import PREFIX, file_digest, list_meshes, load_mesh, read_sources
from panokit.dataset.objects.kinds import KINDS, RECIPE, make_object
from panokit.dataset.scene import Mesh, SceneSource
from panokit.dataset.settings import ObjectSettings
from panokit.errors import SettingsError, UsageError

_MADE_HERE = {"license": "CC0-1.0", "attribution": "made by panokit"}
# A worker shows the same object now and then; a mesh takes up to a few megabytes.
_KEPT = 32


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ObjectCatalog:
    """Objects by id: "chair-17" is made from its kind and number, "folder/NAME" is read.

    Attributes:
        objects_of_kind: Kind -> ids; meshes of the folder are of the kind "folder".
        files: Id -> path, of the meshes in the folder.
        sources: Id -> whose work it is, of the meshes in the folder.
    """

    objects_of_kind: Mapping[str, tuple[str, ...]]
    files: Mapping[str, Path]
    sources: Mapping[str, SceneSource]

    def ids(self) -> tuple[str, ...]:
        """All ids, in an order that is always the same."""
        return tuple(id for ids in self.objects_of_kind.values() for id in ids)

    def kinds(self) -> tuple[str, ...]:
        """The kinds that there are."""
        return tuple(self.objects_of_kind)

    def load(self, id: str) -> Mesh:
        """The object, centered at the origin, its longest side 1 m.

        Raises:
            ImageError: If the file is not a usable mesh, with the reason.
            UsageError: If there is no such object.
        """
        if id in self.files:
            return _read(self.files[id])
        return _made(*_kind_and_number(id))

    def source(self, id: str) -> SceneSource:
        """Whose work the object is.

        Raises:
            UsageError: If there is no such object.
        """
        if id in self.sources:
            return self.sources[id]
        kind, number = _kind_and_number(id)
        return SceneSource(id=id, details={"kind": kind, "number": number}, **_MADE_HERE)

    def digest(self, id: str) -> str:
        """SHA-256 of the content: equal for two files that are the same mesh.

        Of a procedural object it is the digest of what it is made from, which decides it.
        """
        if id in self.files:
            return file_digest(self.files[id])
        kind, number = _kind_and_number(id)
        return sha256(f"panokit object {RECIPE} {kind} {number}".encode()).hexdigest()


def open_catalog(settings: ObjectSettings) -> ObjectCatalog:
    """The catalog that the settings describe.

    Raises:
        SettingsError: If a kind is not known.
        UsageError: If the folder of meshes is not there or holds none.
        LicenseError: If a mesh asks for credit and its table gives none.
    """
    unknown = sorted(set(settings.kinds) - set(KINDS))
    if unknown:
        raise SettingsError(
            f"There is no kind of object {', '.join(unknown)}. Choose from {', '.join(KINDS)}."
        )
    kinds = [kind for kind in KINDS if kind in settings.kinds or not settings.kinds]
    objects = {
        kind: tuple(f"{kind}-{number}" for number in range(settings.per_kind)) for kind in kinds
    }
    files: dict[str, Path] = {}
    sources: dict[str, SceneSource] = {}
    if settings.meshes:
        folder = Path(settings.meshes)
        files = list_meshes(folder)
        sources = read_sources(folder, files)
        objects[PREFIX.rstrip("/")] = tuple(files)
    return ObjectCatalog(objects_of_kind=objects, files=files, sources=sources)


def _kind_and_number(id: str) -> tuple[str, int]:
    kind, _, number = id.rpartition("-")
    if kind not in KINDS or not number.isascii() or not number.isdigit():
        raise UsageError(f"There is no object {id!r}. Ids are like chair-17 or {PREFIX}NAME.")
    return kind, int(number)


@lru_cache(maxsize=_KEPT)
def _read(path: Path) -> Mesh:
    return load_mesh(path)


@lru_cache(maxsize=_KEPT)
def _made(kind: str, number: int) -> Mesh:
    return make_object(kind, number)
