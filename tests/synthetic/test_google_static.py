import cv2
import numpy as np
import pytest

from panokit.frames import Rotation
from panokit.sphere import perspective_view
from panokit.synthetic import Faults
from panokit.synthetic.google_static import NO_IMAGERY_RGB, SIGNING_SECRET, signature_of

VIEW = {"size": "320x320", "pano": "here", "key": "panokit"}


def view(server, http, path="", **query):
    return http.get(f"{server.url}/maps/api/streetview{path}", params=VIEW | query, timeout=5)


def pixels(reply):
    return cv2.imdecode(np.frombuffer(reply.content, np.uint8), cv2.IMREAD_COLOR_RGB)


def test_the_signature_of_the_vendors_test_vector():
    target = "/maps/api/geocode/json?address=New+York&client=clientID"
    assert signature_of(target, SIGNING_SECRET) == "chaRF2hTJKOScPr-RQCEhZbSzIE="
    assert signature_of(target + "&signature=x", SIGNING_SECRET) == "chaRF2hTJKOScPr-RQCEhZbSzIE="


def test_a_view_is_level_and_has_its_marks(server, http, gradient):
    seen = pixels(view(server, http, heading=100, pitch=10, fov=80))
    assert seen.shape == (320, 320, 3)
    world_from_view = Rotation.from_heading_pitch_roll(np.radians(100), np.radians(10))
    tilted = Rotation.from_heading_pitch_roll(*np.radians([350.0, -2.5, -5.5]))
    expected = perspective_view(gradient, 320, 320, 80, tilted.inverse @ world_from_view)
    difference = np.abs(seen.astype(int) - expected)
    assert difference[:280].max() < 16
    assert difference[300:, :60].max() > 60, "no logo"
    assert difference[305:, -60:].max() > 60, "no credit"


def test_no_view_is_larger_than_640(server, http):
    assert pixels(view(server, http, size="2000x700")).shape == (640, 640, 3)


def test_no_imagery_is_a_grey_picture_or_a_404(server, http):
    grey = view(server, http, pano="nothing", size="640x640")
    assert grey.status_code == 200
    share = (np.abs(pixels(grey).astype(int) - NO_IMAGERY_RGB) <= 2).all(axis=2).mean()
    assert 0.95 < share < 1
    assert view(server, http, pano="nothing", return_error_code="true").status_code == 404


@pytest.mark.parametrize(
    ("query", "status"),
    [({"size": "x"}, 400), ({"pitch": "100"}, 400), ({"key": "no"}, 403), ({"key": ""}, 403)],
)
def test_what_is_refused(server, http, query, status):
    assert view(server, http, **query).status_code == status


def test_signatures_are_checked_and_may_be_required(server, http):
    assert view(server, http, signature="wrong").status_code == 403
    server.set_faults(Faults(signature_required=True))
    assert view(server, http).status_code == 403
    target = "/maps/api/streetview?size=64x64&pano=here&key=panokit"
    signed = f"{target}&signature={signature_of(target, SIGNING_SECRET)}"
    assert http.get(server.url + signed, timeout=5).status_code == 200


def test_metadata_is_always_a_200(server, http):
    def status(**query):
        reply = view(server, http, "/metadata", **query)
        assert reply.status_code == 200
        return reply.json()["status"]

    known = view(server, http, "/metadata").json()
    assert known["pano_id"] == "here"
    assert (known["status"], known["date"], known["location"]["lng"]) == ("OK", "2025-06", -28.0)
    assert status(pano="nothing") == "ZERO_RESULTS"
    assert status(key="no") == "REQUEST_DENIED"
    bare = http.get(
        f"{server.url}/maps/api/streetview/metadata",
        params={"key": "panokit", "location": "Main Street"},
        timeout=5,
    )
    assert bare.json()["status"] == "NOT_FOUND"


def test_over_quota(server, http):
    server.set_faults(Faults(quota_per_day=2))
    codes = [view(server, http, size="32x32").status_code for _ in range(3)]
    assert codes == [200, 200, 429]
    assert view(server, http, "/metadata").json()["status"] == "OK"
