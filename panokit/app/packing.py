"""Files as one download: as it is, or in an archive."""

import zipfile
from collections.abc import Sequence
from pathlib import Path

from panokit.errors import StorageError

_TYPES = {
    ".exr": "image/x-exr",
    ".hdr": "image/vnd.radiance",
    ".json": "application/json",
    ".glb": "model/gltf-binary",
    ".parquet": "application/vnd.apache.parquet",
}


def packed(files: Sequence[Path], stem: str, form: str) -> tuple[Path, str, str]:
    """What to send for some files of one folder.

    Args:
        files: The one to open first is the first.
        stem: What the archive is called.
        form: What it is; for its name.

    Returns:
        The file, its media type, and the name to store it under. Several files become an archive
        without compression, as EXR is compressed already; a map's record goes with it.

    Raises:
        StorageError: If the archive cannot be written.
    """
    if len(files) == 1:
        only = files[0]
        return only, _TYPES.get(only.suffix, "application/octet-stream"), only.name
    name = f"{stem}-{form}.zip"
    path = files[0].parent / name
    try:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
            for file in files:
                archive.write(file, file.relative_to(files[0].parent).as_posix())
    except OSError as error:
        raise StorageError(f"The archive {name} was not written ({error.strerror}).") from error
    return path, "application/zip", name
