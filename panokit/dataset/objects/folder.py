"""Objects from a folder of PLY, OBJ and glTF files, with their licenses."""

import csv
import json
import re
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from panokit.dataset.objects.creases import face_normals, split_creases, weld
from panokit.dataset.objects.shaping import centered
from panokit.dataset.scene import Mesh, SceneSource
from panokit.errors import ImageError, ItemError, LicenseError, MissingExtraError, UsageError
from panokit.io.files import read_bytes, storage_error

SUFFIXES = (".glb", ".gltf", ".obj", ".ply")
PREFIX = "folder/"
MANIFEST = "manifest.csv"
MOST_PARTS = 3
# Of the longest side: closer vertices are one.
_WELD = 1e-6
_WITHOUT_CREDIT = ("CC0", "PUBLIC DOMAIN", "APACHE", "MIT", "BSD", "UNLICENSE", "0BSD")


def list_meshes(folder: Path) -> dict[str, Path]:
    """The mesh files in a folder and its subfolders, by id.

    The id is "folder/" and the path without its suffix; with it, where two files differ in
    nothing else.

    Raises:
        UsageError: If the folder is not one, or holds no mesh file.
    """
    if not folder.is_dir():
        raise UsageError(f"There is no folder of meshes {str(folder)!r}. Check the path.")
    files = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES)
    if not files:
        raise UsageError(
            f"The folder {str(folder)!r} holds no {', '.join(SUFFIXES)} file. Name one that does."
        )
    stems = [path.relative_to(folder).with_suffix("").as_posix() for path in files]
    return {
        PREFIX + (stem if stems.count(stem) == 1 else path.relative_to(folder).as_posix()): path
        for stem, path in zip(stems, files, strict=True)
    }


def load_mesh(path: Path) -> Mesh:
    """The triangles of a file, centered at the origin, the longest side 1 m.

    All geometry of a scene graph is taken where it stands. Its pieces become parts: the two
    largest, and the rest as a third. Vertices at one place are joined, triangles without an
    area are left out, neighbors are made to run the same way around, and edges sharper than
    50 degrees become creases; normals and textures of the file are not used.

    Raises:
        ImageError: With reason "unreadable", "no-faces", "not-finite" or "empty" (of no size).
        MissingExtraError: If trimesh is not installed.
    """
    pieces = _pieces(path)
    faces_of = [faces for _, faces in pieces]
    if not sum(len(faces) for faces in faces_of):
        raise ImageError(
            f"{path.name} has no faces, only points or lines. Export it with its surface.",
            reason="no-faces",
        )
    starts = np.cumsum([0] + [len(points) for points, _ in pieces])
    points = np.concatenate([points for points, _ in pieces])
    faces = np.concatenate([f + s for f, s in zip(faces_of, starts, strict=False)])
    used = np.unique(faces)
    if used[0] < 0 or used[-1] >= len(points):
        raise ImageError(
            f"{path.name} has faces of vertices that it does not have. Export it again.",
            reason="unreadable",
        )
    if not np.isfinite(points[used]).all():
        count = int((~np.isfinite(points[used])).any(axis=1).sum())
        raise ImageError(
            f"{path.name} has {count} vertices that are not finite. Repair it in a modeling "
            "program.",
            reason="not-finite", values={"vertices": count},
        )  # fmt: skip
    parts = np.concatenate(
        [np.full(len(f), n) for f, n in zip(faces_of, _part_numbers(pieces), strict=True)]
    )
    place = np.zeros(len(points), np.int64)
    place[used] = np.arange(len(used))
    return _tidy(points[used], place[faces], parts, path.name)


def _tidy(points: NDArray[Any], faces: NDArray[Any], parts: NDArray[Any], name: str) -> Mesh:
    if not np.ptp(points, axis=0).max() > 0:
        raise ImageError(
            f"All vertices of {name} lie in one place. Export it again.", reason="empty"
        )
    points, faces = weld(centered(points), faces, _WELD)
    size = np.linalg.norm(face_normals(points, faces), axis=1)
    longest = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2).max(axis=1)
    # Slivers, too: a triangle whose height is a millionth of its length has no usable normal.
    keep = size > 1e-6 * np.maximum(longest**2, 1e-12)
    faces, parts = faces[keep], parts[keep]
    if not len(faces):
        raise ImageError(
            f"No triangle of {name} has an area. Export it with its surface.", reason="no-faces"
        )
    faces = _consistent(points, faces)
    points, faces = split_creases(points, faces)
    _, dense = np.unique(parts, return_inverse=True)
    return Mesh(
        vertices=points.astype(np.float32),
        faces=faces.astype(np.int32),
        part=dense.reshape(-1).astype(np.uint8),
        smooth=True,
    )


def _consistent(points: NDArray[Any], faces: NDArray[Any]) -> NDArray[Any]:
    """Faces turned so that neighbors agree, and closed bodies face outward."""
    import trimesh

    body = trimesh.Trimesh(points, faces, process=False)
    if body.is_winding_consistent and (not body.is_watertight or body.volume > 0):
        return faces
    trimesh.repair.fix_winding(body)
    if body.is_watertight:
        trimesh.repair.fix_inversion(body, multibody=True)
    return np.asarray(body.faces)


def _pieces(path: Path) -> list[tuple[NDArray[np.float64], NDArray[np.int64]]]:
    """Vertices and faces of each geometry in a file, in the frame of the whole."""
    try:
        import trimesh
    except ImportError as error:
        raise MissingExtraError("trimesh", "render", "Reading meshes") from error
    try:
        loaded = trimesh.load_scene(path, process=False, skip_materials=True)
        pieces = []
        for node in sorted(loaded.graph.nodes_geometry):
            turned, name = loaded.graph[node]
            geometry = loaded.geometry[name]
            if isinstance(geometry, trimesh.Trimesh):
                points = trimesh.transform_points(np.asarray(geometry.vertices), turned)
                faces = np.asarray(geometry.faces, np.int64)
                # A mirrored node turns its triangles inside out.
                pieces.append((points, faces[:, ::-1] if np.linalg.det(turned) < 0 else faces))
    except Exception as error:
        raise ImageError(
            f"{path.name} cannot be read as a mesh ({type(error).__name__}: {error}). "
            "Export it again as PLY, OBJ or glTF.",
            reason="unreadable",
        ) from error
    return pieces


def _part_numbers(pieces: Sequence[tuple[NDArray[Any], NDArray[Any]]]) -> list[int]:
    """The largest piece is part 0, the next part 1, all others part 2."""
    areas = [-float(np.linalg.norm(face_normals(p, f), axis=1).sum()) for p, f in pieces]
    rank = np.argsort(np.argsort(areas, kind="stable"), kind="stable")
    return [min(int(place), MOST_PARTS - 1) for place in rank]


def file_digest(path: Path) -> str:
    """SHA-256 of what a mesh file says, with the buffers that a .gltf keeps beside it.

    Raises:
        StorageError: If a file cannot be read.
    """
    data = read_bytes(path)
    whole = sha256(data)
    if path.suffix.lower() == ".gltf":
        for buffer in _json_of(data).get("buffers", []):
            beside = path.parent / str(buffer.get("uri", ""))
            if beside.is_file():
                whole.update(read_bytes(beside))
    return whole.hexdigest()


def _json_of(data: bytes) -> dict[str, Any]:
    try:
        value = json.loads(data)
    except ValueError:
        return {}
    return value if isinstance(value, dict) else {}


def read_sources(folder: Path, files: dict[str, Path]) -> dict[str, SceneSource]:
    """Whose work the meshes are, from `manifest.csv` beside them.

    The table has the columns `file` (or `name`), `license` (or `licence`) and may have
    `attribution` (or `credit`); other columns are kept as details. A credit may also stand in
    the license itself, behind "(c)". A mesh that is not in the table has the license "unknown".

    Raises:
        LicenseError: If a license asks for credit and the table gives none.
        StorageError: If the table is there and cannot be read.
    """
    rows = _manifest(folder / MANIFEST)
    return {id: _source(id, rows, path, folder) for id, path in files.items()}


def _manifest(path: Path) -> dict[str, dict[str, str]]:
    if not path.is_file():
        return {}
    try:
        with path.open(newline="", encoding="utf-8-sig") as lines:
            rows = list(csv.DictReader(lines))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        if isinstance(error, OSError):
            raise storage_error("read", path, error) from error
        raise ItemError(
            f"{path} is not a table of meshes ({error}). Write it as UTF-8 with commas.",
            reason="bad-manifest",
        ) from error
    return {(row.get("file") or row.get("name") or ""): row for row in rows}


def _source(id: str, rows: dict[str, dict[str, str]], path: Path, folder: Path) -> SceneSource:
    relative = path.relative_to(folder)
    names = (relative.as_posix(), relative.with_suffix("").as_posix())
    row = next((rows[name] for name in names if name in rows), {})
    stated = (row.get("license") or row.get("licence") or "unknown").strip()
    plain, _, holder = stated.partition("(c)")
    credit = (row.get("attribution") or row.get("credit") or "").strip()
    if not credit and holder:
        credit = f"© {holder.strip()}"
    name = re.split(r"\s*\(", plain.strip())[0] or "unknown"
    needs_credit = name != "unknown" and not name.upper().startswith(_WITHOUT_CREDIT)
    if needs_credit and not credit:
        raise LicenseError(
            f"{relative} is under {name}, which asks for credit, and {MANIFEST} gives none. "
            "Write it into the column attribution."
        )
    known = {"license", "licence", "attribution", "credit", "file"}
    details = {key: value for key, value in row.items() if key and key not in known and value}
    return SceneSource(id=id, license=name, attribution=credit, details=details)
