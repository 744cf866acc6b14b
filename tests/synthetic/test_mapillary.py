import math
import time

import cv2
import numpy as np
import pytest

from panokit.synthetic import Faults, ServedPicture, StreetServer

AUTH = {"Authorization": "OAuth MLY|panokit"}
BOX = "-28.001,44.499,-27.999,44.501"
ALL = "id,geometry,captured_at,computed_rotation,computed_compass_angle,thumb_original_url,width"


def ask(server, http, path="/images", headers=AUTH, **query):
    return http.get(server.url + path, params=query, headers=headers, timeout=5)


@pytest.mark.parametrize(
    ("headers", "query", "status", "code"),
    [
        ({}, {}, 500, 190),
        ({"Authorization": "OAuth nonsense"}, {}, 401, 190),
        ({"Authorization": "OAuth MLY|other"}, {}, 401, 190),
        ({}, {"access_token": "MLY|other"}, 400, 190),
        (AUTH, {}, 400, 100),
    ],
    ids=["no header", "malformed", "unknown", "unknown in the query", "unknown image"],
)
def test_the_measured_errors(server, http, headers, query, status, code):
    reply = ask(server, http, "/1", headers, **query)
    assert (reply.status_code, reply.json()["error"]["code"]) == (status, code)


def test_only_the_fields_that_are_named_come_back(server, http):
    (first, second) = ask(server, http, bbox=BOX, fields="id,captured_at").json()["data"]
    assert set(first) == set(second) == {"id", "captured_at"}
    assert ask(server, http, "/here").json() == {"id": "here"}


@pytest.mark.parametrize(
    "query",
    [{"bbox": "-28.01,44.49,-28,44.5"}, {"bbox": "1,2"}, {"bbox": BOX, "limit": 2001}],
    ids=["too large", "no box", "limit"],
)
def test_bad_questions(server, http, query):
    assert ask(server, http, **query).json()["error"]["code"] == 100


def test_dense_boxes_are_refused_and_large_ones_thinned_out(server, http):
    server.set_faults(Faults(dense_box=1))
    reply = ask(server, http, bbox=BOX)
    assert (reply.status_code, reply.json()["error"]["code"]) == (500, 1)
    assert len(ask(server, http, bbox="-28.001,44.4999,-27.999,44.5001").json()["data"]) == 1
    server.set_faults(Faults(thinned=True))
    assert len(ask(server, http, bbox=BOX).json()["data"]) == 2
    assert len(ask(server, http, bbox="-28.004,44.499,-27.998,44.501").json()["data"]) == 1


def test_time_and_place_narrow_a_search(server, http):
    def ids(**query):
        return {one["id"] for one in ask(server, http, **query).json()["data"]}

    assert ids(bbox=BOX, start_captured_at="2025-06-02T00:00:00Z") == set()
    assert ids(bbox=BOX, end_captured_at="2025-06-02T00:00:00Z") == {"here", "north"}
    assert ids(lat=44.5, lng=-28.0, radius=20) == {"here"}


@pytest.mark.parametrize(
    ("pose", "expected"),
    [((0, 0, 0), [math.pi / 2, 0, 0]), ((120, 5, -3), None)],
    ids=["level and north", "turned"],
)
def test_computed_rotation_takes_east_north_up_to_right_down_forward(
    describe, image, http, pose, expected
):
    heading, pitch, roll = pose
    capture = describe("one", heading_deg=heading, pitch_deg=pitch, roll_deg=roll)
    with StreetServer([ServedPicture(capture=capture, image=image)]) as server:
        (known,) = ask(server, http, bbox=BOX, fields=ALL).json()["data"]
    vector = np.array(known["computed_rotation"])
    if expected:
        assert vector == pytest.approx(expected)
    matrix = cv2.Rodrigues(vector)[0]
    forward, up = matrix.T @ [0, 0, 1], matrix.T @ [0, -1, 0]
    assert math.degrees(math.atan2(forward[0], forward[1])) % 360 == pytest.approx(heading)
    assert math.degrees(math.asin(forward[2])) == pytest.approx(pitch)
    # Leaning to the right, the camera's up points right of the vertical.
    right_of_heading = [math.cos(math.radians(heading)), -math.sin(math.radians(heading))]
    assert math.degrees(math.asin(up[:2] @ right_of_heading)) == pytest.approx(roll, abs=0.02)


def test_addresses_are_signed_and_expire(server, http):
    server.set_faults(Faults(url_lifetime_s=1))
    url = ask(server, http, "/far", fields=ALL).json()["thumb_original_url"]
    assert http.get(url, timeout=5).headers["Content-Type"] == "image/jpeg"
    assert http.get(url.replace("oh=", "oh=0"), timeout=5).status_code == 403
    time.sleep(2.1)
    late = http.get(url, timeout=5)
    assert (late.status_code, late.text) == (403, "URL signature expired")


def test_sparse_records_have_no_original(server, http):
    server.set_faults(Faults(sparse_metadata=True))
    known = ask(server, http, "/here", fields=ALL + ",thumb_2048_url").json()
    assert "thumb_original_url" not in known
    assert "computed_rotation" not in known
    assert "/2048.jpg?" in known["thumb_2048_url"]
