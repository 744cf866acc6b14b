"""What a stage's command works on: a run folder, folders of pictures, or pictures."""

from collections.abc import Sequence
from pathlib import Path

from panokit.errors import StorageError, UsageError
from panokit.io.captures import RECORD
from panokit.io.images import LDR_SUFFIXES
from panokit.io.pictures import HDR_SUFFIXES
from panokit.pipeline.tasks import StageTask
from panokit.records import RunFolder, require_folder
from panokit.settings import Settings

# Where a stage finds its pictures in a run; the first folder that has any.
_SOURCES = {"inpaint": ("panoramas",), "expand": ("filled", "panoramas")}
_BEFORE = {"stitch": "fetch", "inpaint": "stitch", "expand": "stitch"}
_TARGETS = {"stitch": ("panoramas", ".jpg"), "inpaint": ("filled", ".jpg"),
            "expand": ("probes", ".exr")}  # fmt: skip


def stage_tasks(
    stage: str,
    paths: Sequence[Path],
    settings: Settings,
    out: Path | None = None,
    mask: Path | None = None,
) -> list[StageTask]:
    """The tasks of a stage's command.

    Args:
        stage: "stitch", "inpaint" or "expand".
        paths: One run folder; or capture folders and files of views for stitch; or pictures
            and folders of them.
        settings: The stage's settings.
        out: Where results go; needed unless `paths` is a run.
        mask: What to fill, for inpaint.

    Raises:
        UsageError: If there is nothing to work on, or nowhere to put the results.
    """
    if len(paths) == 1 and RunFolder(paths[0]).is_run:
        tasks = run_tasks(stage, RunFolder(paths[0]), settings, mask)
        if not tasks:
            before = _BEFORE[stage]
            raise UsageError(
                f"{paths[0]} has nothing for {stage} yet. Run `panokit {before} "
                f"{'--out ' if before == 'fetch' else ''}{paths[0]}` first."
            )
        return tasks
    if out is None:
        raise UsageError("Say where the results go with --out DIR.")
    # HDR maps have holes, too.
    suffixes = (*LDR_SUFFIXES, *HDR_SUFFIXES) if stage == "inpaint" else LDR_SUFFIXES
    sources = stitch_sources(paths) if stage == "stitch" else pictures(paths, suffixes)
    if not sources:
        wanted = {
            "stitch": "fetched captures or files of views",
            "inpaint": "JPEG, PNG, WebP or TIFF pictures and no HDR maps",
            "expand": "JPEG, PNG, WebP or TIFF pictures",
        }[stage]
        raise UsageError(f"There are no {wanted} in {', '.join(map(str, paths))}. Check the path.")
    tasks = [
        StageTask(
            stage=stage,
            item=source.name if source.is_dir() else source.stem,
            source=source,
            target=out / _target_name(stage, source),
            settings=settings,
            mask=mask,
        )
        for source in sources
    ]
    _check_targets(tasks)
    return tasks


def _target_name(stage: str, source: Path) -> str:
    if source.is_dir():
        return f"{source.name}{_TARGETS[stage][1]}"
    from panokit.stitch import read_view_set

    # What was HDR stays HDR; brackets and HDR views become a map, not a picture.
    hdr = (stage == "inpaint" and source.suffix.lower() in HDR_SUFFIXES) or (
        stage == "stitch" and read_view_set(source).is_hdr
    )
    return f"{source.stem}{'.exr' if hdr else _TARGETS[stage][1]}"


def run_tasks(
    stage: str, run: RunFolder, settings: Settings, mask: Path | None = None
) -> list[StageTask]:
    """The tasks of a stage over everything that a run has for it."""
    if stage == "stitch":
        sources = capture_folders([run.captures]) if run.captures.is_dir() else []
    else:
        folders = [run.root / name for name in _SOURCES[stage]]
        found = [pictures([f], LDR_SUFFIXES) for f in folders if f.is_dir()]
        sources = next((some for some in found if some), [])
    folder, suffix = _TARGETS[stage]
    return [
        StageTask(
            stage=stage,
            item=item,
            source=source,
            target=run.root / folder / f"{item}{suffix}",
            settings=settings,
            mask=mask,
        )
        for source in sources
        for item in [source.name if source.is_dir() else source.stem]
    ]


def map_paths(paths: Sequence[Path]) -> list[Path]:
    """The HDR maps that a command was given: of a run, in folders, or named."""
    if len(paths) == 1 and RunFolder(paths[0]).is_run:
        probes = RunFolder(paths[0]).probes
        return pictures([probes], HDR_SUFFIXES) if probes.is_dir() else []
    return pictures(paths, HDR_SUFFIXES)


def pictures(paths: Sequence[Path], suffixes: Sequence[str]) -> list[Path]:
    """The pictures with these suffixes: those named, and those in the folders named.

    Named files are taken whatever they are called; what is not a picture is rejected when it
    is read, so that the others go on.

    Raises:
        StorageError: If a path does not exist or a folder cannot be read.
    """
    found: list[Path] = []
    for path in paths:
        if path.is_dir():
            found += sorted(
                file
                for file in require_folder(path).iterdir()
                if file.suffix.lower() in suffixes and not file.name.endswith(".mask.png")
            )
        elif path.exists():
            found.append(path)
        else:
            raise StorageError(f"There is no {path}. Check the path.")
    return found


def capture_folders(paths: Sequence[Path]) -> list[Path]:
    """The folders that hold a complete capture, among these and directly in them."""
    found = []
    for path in paths:
        if (path / RECORD).is_file():
            found.append(path)
        else:
            children = sorted(require_folder(path).iterdir())
            found += [child for child in children if (child / RECORD).is_file()]
    return found


def stitch_sources(paths: Sequence[Path]) -> list[Path]:
    """Files of views named, and the folders that hold a capture, among these and in them."""
    files = [path for path in paths if path.suffix.lower() == ".json" and path.is_file()]
    return files + capture_folders([path for path in paths if path not in files])


def _check_targets(tasks: Sequence[StageTask]) -> None:
    targets: dict[Path, Path] = {}
    for task in tasks:
        if task.target.resolve() == task.source.resolve():
            raise UsageError(f"{task.source} would overwrite itself; choose another --out.")
        other = targets.setdefault(task.target, task.source)
        if other != task.source:
            raise UsageError(
                f"{other} and {task.source} would both become {task.target.name}. "
                "Rename one of them.",
            )
