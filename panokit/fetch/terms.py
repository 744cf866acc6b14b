"""What each source's terms permit, in plain words; a summary, not legal advice."""

from dataclasses import dataclass

from panokit.errors import LicenseError

_GOOGLE_TERMS = "https://cloud.google.com/maps-platform/terms"


@dataclass(frozen=True, slots=True, kw_only=True)
class Terms:
    """What the terms of a source permit.

    Attributes:
        summary: In plain words, one sentence.
        url: Where they stand.
        store: Whether they let copies be kept; None where each picture has its own license.
        derive: Whether they let new works be made; None likewise.
        train: Whether they let models be trained, tested or tuned; None likewise.
        credit: What to show wherever a picture or a derived work is shown.
        consent: What the user must name in `accept_terms`, "" where nothing needs consent.
    """

    summary: str
    url: str
    store: bool | None
    derive: bool | None
    train: bool | None
    credit: str
    consent: str = ""


_GOOGLE = Terms(
    summary=(
        "Google's terms let you show Street View pictures in your application; they do not let "
        "you store them, derive new works from them, analyze them or train models with them."
    ),
    url=_GOOGLE_TERMS,
    store=False,
    derive=False,
    train=False,
    credit='"Google Maps" and the copyright line of the picture',
    consent="google",
)

TERMS: dict[str, Terms] = {
    "panoramax": Terms(
        summary=(
            "Each picture has its own open license, mostly Licence Ouverte 2.0 or CC BY-SA 4.0: "
            "keep, change and train with it, and credit its author."
        ),
        url="https://docs.panoramax.fr",
        store=None,
        derive=None,
        train=None,
        credit="the author, the instance and the license",
    ),
    "mapillary": Terms(
        summary=(
            "All pictures are CC BY-SA 4.0: keep, change and train with them, credit the author "
            "and Mapillary, and share what you derive under the same license."
        ),
        url="https://www.mapillary.com/terms",
        store=True,
        derive=True,
        train=True,
        credit='"Photo by USER on Mapillary, CC BY-SA 4.0", with a link to the picture',
    ),
    "google-tiles": _GOOGLE,
    "google-static": _GOOGLE,
    "polyhaven": Terms(
        summary="All maps are CC0: do with them what you like. The service asks to be named.",
        url="https://polyhaven.com/license",
        store=True,
        derive=True,
        train=True,
        credit='nothing; "Powered by Poly Haven" where an application shows what it offers',
    ),
    "folder": Terms(
        summary="Your own pictures: you say under which license they are.",
        url="",
        store=True,
        derive=None,
        train=None,
        credit="what you wrote as attribution",
    ),
}


def require_consent(source: str, accepted: tuple[str, ...]) -> None:
    """Check that the user has accepted the terms of a source that asks for it.

    Raises:
        LicenseError: If not; the message says what they are about.
    """
    terms = TERMS[source]
    if terms.consent and terms.consent not in accepted:
        raise LicenseError(
            f"{terms.summary} Read {terms.url}; if your use is allowed, say so with "
            f"--accept-terms {terms.consent}. The source panoramax has open licenses."
        )
