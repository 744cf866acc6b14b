"""Pictures by id, or by the address that a browser shows."""

import base64

import pytest

from panokit.errors import PlaceError
from panokit.fetch.picture_ids import picture_id, picture_ids

UUID = "c41b9734-8e81-421f-b2cb-04aeec8250c1"
OFFICIAL = "GJ99KitLZxEpsY4Yx9PV2g"
# The id of a picture that somebody took, as its page shows it and as the services know it.
THEIRS, PACKED = (
    "AF1QipPfxcWYHEbdj5as-9lN82AELm65rCjrgLD1cqrz",
    "CAoSLEFGMVFpcFBmeGNXWUhFYmRqNWFzLTlsTjgyQUVMbTY1ckNqcmdMRDFjcXJ6",
)


@pytest.mark.parametrize(
    ("source", "text", "expected"),
    [
        ("panoramax", UUID, UUID),
        ("panoramax", f"https://api.panoramax.xyz/api/pictures/{UUID}/hd.jpg", UUID),
        ("panoramax", f"https://panoramax.ign.fr/api/collections/1/items/{UUID}", UUID),
        ("panoramax", f"https://api.panoramax.xyz/?focus=pic&pic={UUID}&map=1/2/3", UUID),
        ("panoramax", f"https://panoramax.openstreetmap.fr/#focus=pic&pic={UUID}", UUID),
        ("mapillary", "1386976845208976", "1386976845208976"),
        ("mapillary", "https://www.mapillary.com/app/?pKey=138697684&z=17", "138697684"),
        ("mapillary", "https://www.mapillary.com/map/im/1386976845208976", "1386976845208976"),
        ("google-tiles", OFFICIAL, OFFICIAL),
        ("google-static", f" {OFFICIAL} ", OFFICIAL),
        (
            "google-tiles",
            "https://www.google.com/maps/@33.99,-118.4,3a,75y,148h,98t/data=!3m7!1e1!3m5!"
            f"1s{OFFICIAL}!2e0!6shttps:%2F%2Fstreetviewpixels-pa.googleapis.com!7i16384!8i8192",
            OFFICIAL,
        ),
        (
            "google-tiles",
            f"https://www.google.com/maps/@?api=1&map_action=pano&pano={OFFICIAL}",
            OFFICIAL,
        ),
        ("google-tiles", f"https://www.google.com/maps/@1,2/data=!1e1!3m2!1s{THEIRS}!2e10", PACKED),
        ("google-tiles", PACKED, PACKED),
    ],
)  # fmt: skip
def test_the_picture_that_a_text_names(source, text, expected):
    assert picture_id(source, text) == expected


def test_what_people_took_is_packed_as_the_services_want_it():
    packed = picture_id("google-static", THEIRS)
    message = base64.urlsafe_b64decode(packed)
    # Field 1 is the number 10; field 2 is a text: the id (protocol buffers, wire format).
    assert message[:4] == b"\x08\x0a\x12\x2c"
    assert message[4:].decode() == THEIRS


@pytest.mark.parametrize(
    ("source", "text"),
    [
        ("panoramax", "https://api.panoramax.xyz/?focus=map"),
        ("mapillary", "https://www.mapillary.com/app/user/somebody"),
        ("google-tiles", "https://www.google.com/maps/@33.99,-118.4,15z"),
        ("google-tiles", "two words"),
        ("panoramax", ""),
        ("folder", UUID),
    ],
)
def test_a_text_that_names_none_is_an_error(source, text):
    with pytest.raises(PlaceError):
        picture_id(source, text)


def test_each_is_asked_for_once():
    texts = [UUID, f"https://api.panoramax.xyz/api/pictures/{UUID}", "other-one"]
    assert picture_ids("panoramax", texts) == (UUID, "other-one")
