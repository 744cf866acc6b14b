"""What the look-alike services can be told to do wrong, as values."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

from panokit.errors import UsageError

TWO_WEEKS_S = 14 * 24 * 3600.0

TroubleKind = Literal[
    "429",
    "429-date",
    "429-body",
    "429-any",
    "500",
    "503",
    "html",
    "wrong-type",
    "empty",
    "truncated",
    "reset",
    "slow",
    "small",
    "black",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """A passing fault: the same request may succeed when it is made again.

    Without a rate, the first `times` requests meet it. With one, it is drawn for each request
    from the seed, the address and how often that address was asked before, so that equal
    runs meet equal faults, whatever the order of their requests.

    Attributes:
        kind: "429" with Retry-After in seconds, "429-date" with it as a date, "429-body" with
            the delay in Google's JSON body only, "429-any" one of these three; "500", "503";
            "html" (a web page with status 200), "wrong-type" (a good body called text),
            "empty", "truncated" (half a body), "reset" (the connection is cut), "slow" (the
            body trickles), "small" (a picture at half its size), "black" (an all-black one).
        path: The fault meets requests whose path contains this text.
        times: How many requests meet it, where there is no rate.
        rate: The share of requests that meet it, 0 to 1.
        attempts: With a rate: only so many first requests for an address meet it; None for all.
        retry_after_s: The delay that a 429 asks for. Headers have whole seconds only: a
            fraction is rounded up that often that the mean is right.
        slow_s: How long a slow body takes.
    """

    kind: TroubleKind
    path: str = ""
    times: int = 1
    rate: float | None = None
    attempts: int | None = None
    retry_after_s: float = 0
    slow_s: float = 1.0

    def __post_init__(self) -> None:
        if self.kind not in get_args(TroubleKind):
            known = ", ".join(get_args(TroubleKind))
            raise UsageError(f"There is no trouble {self.kind!r}; there are {known}.")
        if self.rate is not None and not 0 <= self.rate <= 1:
            raise UsageError(f"A rate is 0 to 1 (or 0% to 100%), not {self.rate}.")


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """How the services differ from their best behavior; the default is that they do not.

    Attributes:
        troubles: Passing faults; a request meets the first one that is left for its path.
        seed: Of the troubles that have a rate.
        api_disabled: The Google project has the API switched off: 403 SERVICE_DISABLED.
        session_lifetime_s: After this a Google session is refused.
        session_uses: After so many requests a Google session is refused; None for no end.
        out_of_range: A tile outside the picture is an all-black tile, or a 404.
        edge_tiles: Tiles at the right and lower edge are padded with black, or cropped.
        tile_body_px: The size of Google tile bodies; 256 px bodies have been seen in the wild.
        missing_tiles: (zoom, column, row) of Google tiles that are lost: 404.
        black_tiles: (zoom, column, row) of Google tiles that are lost: an all-black tile.
        retired: Ids that the services list but no longer have.
        sparse_metadata: Leave out every metadata field that may be absent.
        quota_per_minute: Of Google tiles and panoIds, and of Static views; more are a 429. The
            real one is 6000.
        quota_per_day: Likewise; 15000.
        signature_required: The Static API refuses requests that are not signed.
        url_lifetime_s: After this a signed address of a Mapillary picture is refused.
        dense_box: Mapillary refuses boxes that hold more pictures than this.
        thinned: Mapillary lists every other picture only, unless the box is small.
    """

    troubles: Sequence[Trouble] = ()
    seed: int = 0
    api_disabled: bool = False
    session_lifetime_s: float = TWO_WEEKS_S
    session_uses: int | None = None
    out_of_range: Literal["black", "not-found"] = "black"
    edge_tiles: Literal["padded", "cropped"] = "padded"
    tile_body_px: int = 512
    missing_tiles: frozenset[tuple[int, int, int]] = frozenset()
    black_tiles: frozenset[tuple[int, int, int]] = frozenset()
    retired: frozenset[str] = frozenset()
    sparse_metadata: bool = False
    quota_per_minute: int | None = None
    quota_per_day: int | None = None
    signature_required: bool = False
    url_lifetime_s: float = 3600.0
    dense_box: int | None = None
    thinned: bool = False
