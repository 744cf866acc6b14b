"""`panokit probes pull`: HDR maps of Poly Haven into the library."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from panokit.cli.options import Json
from panokit.console import Console, size_text
from panokit.fetch.settings import PullSettings


def pull(
    library: Annotated[Path, Parameter(help="The library's folder; it is made if need be.")],
    names: Annotated[
        list[str] | None,
        Parameter(help="Maps by name, as in polyhaven.com/a/NAME.", show_default=False),
    ] = None,
    /,
    *,
    settings: Annotated[PullSettings, Parameter(name="*")] = PullSettings(),
    json: Json = False,
) -> int:
    """Put HDR maps of Poly Haven into a library: real light, CC0, no key.

    Run it again to go on where it stopped; maps that are there are not fetched again.
    """
    from panokit.pipeline.pulling import pull_into

    console = Console(as_json=json)
    if names:
        settings = settings.model_copy(update={"names": tuple(names)})
    result = pull_into(settings, library, console)
    rejected = len(result.rejections)
    if settings.dry_run:
        console.table(
            ("map", "size", "author"),
            [
                (one.name, size_text(one.bytes), one.capture.license.attribution.split(" via ")[0])
                for one in result.added
            ],
        )
        console.result(f"Would pull {len(result.added)} maps, {size_text(result.bytes)}")
    else:
        console.result(
            f"pull: {len(result.added)} added ({size_text(result.bytes)}), "
            f"{len(result.existing)} there already, {rejected} rejected"
        )
    console.note("Powered by Poly Haven (polyhaven.com)")
    console.value(
        {
            "added": [
                {"name": one.name, "bytes": one.bytes, "md5": one.md5,
                 "capture": one.capture.to_json()}
                for one in result.added
            ],
            "existing": list(result.existing),
            "rejected": [rejection.to_json() for rejection in result.rejections],
            "requests": result.requests,
        }
    )  # fmt: skip
    return 1 if rejected else 0
