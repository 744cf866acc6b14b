"""Data that travels with the code: released models, pipelines.

In a checkout it lies at the repository's top level, in a wheel under `panokit/_shipped`.
"""

from pathlib import Path

from panokit.errors import StorageError

_PACKAGE = Path(__file__).parent


def shipped_roots() -> tuple[Path, ...]:
    """The folders that may hold shipped data, the checkout's first."""
    checkout = _PACKAGE.parent
    in_checkout = (checkout / "pyproject.toml").is_file()
    return ((checkout,) if in_checkout else ()) + (_PACKAGE / "_shipped",)


def shipped_path(relative: str) -> Path:
    """Where a shipped file or folder is, for instance `shipped_path("pipelines/demo.toml")`.

    Raises:
        StorageError: If this installation does not have it.
    """
    for root in shipped_roots():
        candidate = root / relative
        if candidate.exists():
            return candidate
    raise StorageError(
        f"This installation of panokit has no {relative}. Install the package again, or work "
        "in a checkout of the repository."
    )
