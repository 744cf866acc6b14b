import math
import time

import cv2
import numpy as np
import pytest

from panokit.synthetic import Faults
from panokit.synthetic.google_tiles import highest_zoom, size_at_zoom

KEY = {"key": "panokit"}


@pytest.fixture
def signed_in(server, http):
    """The query that every call after createSession needs."""
    reply = http.post(
        f"{server.url}/v1/createSession", params=KEY, json={"mapType": "streetview"}, timeout=5
    )
    return KEY | {"session": reply.json()["session"]}


def tile(server, http, query, zoom, column, row, pano="here"):
    reply = http.get(
        f"{server.url}/v1/streetview/tiles/{zoom}/{column}/{row}",
        params=query | {"panoId": pano},
        timeout=5,
    )
    if reply.status_code != 200:
        return reply.status_code
    return cv2.imdecode(np.frombuffer(reply.content, np.uint8), cv2.IMREAD_COLOR_RGB)


@pytest.mark.parametrize(
    ("width_px", "zooms"),
    # Widths at each zoom as Google serves them for pictures of these sizes.
    [
        (16384, [512, 1024, 2048, 4096, 8192, 16384]),
        (13312, [416, 832, 1664, 3328, 6656, 13312]),
        (5376, [336, 672, 1344, 2688, 5376]),
        (3328, [416, 832, 1664, 3328]),
    ],
)
def test_sizes_at_each_zoom_are_those_of_real_panoramas(width_px, zooms):
    assert highest_zoom(width_px) == len(zooms) - 1
    sizes = [size_at_zoom((width_px, width_px // 2), zoom) for zoom in range(len(zooms))]
    assert sizes == [(width, width // 2) for width in zooms]


def test_session_expires_as_text(server, http):
    reply = http.post(
        f"{server.url}/v1/createSession", params=KEY, json={"mapType": "streetview"}, timeout=5
    ).json()
    assert isinstance(reply["expiry"], str)
    assert int(reply["expiry"]) > time.time() + 24 * 3600


def test_wrong_key_is_a_400_and_disabled_api_a_403(server, http):
    url = f"{server.url}/v1/createSession"
    wrong = http.post(url, params={"key": "no"}, json={"mapType": "streetview"}, timeout=5)
    assert wrong.status_code == 400
    assert wrong.json()["error"]["details"][0]["reason"] == "API_KEY_INVALID"
    server.set_faults(Faults(api_disabled=True))
    disabled = http.post(url, params=KEY, json={"mapType": "streetview"}, timeout=5)
    assert disabled.status_code == 403
    assert disabled.json()["error"]["details"][0]["reason"] == "SERVICE_DISABLED"


def test_expired_session_is_refused(server, http):
    server.set_faults(Faults(session_lifetime_s=-1))
    session = http.post(
        f"{server.url}/v1/createSession", params=KEY, json={"mapType": "streetview"}, timeout=5
    ).json()["session"]
    reply = http.get(
        f"{server.url}/v1/streetview/metadata",
        params=KEY | {"session": session, "panoId": "here"},
        timeout=5,
    )
    assert (reply.status_code, reply.json()["error"]["status"]) == (400, "INVALID_ARGUMENT")


def test_pano_ids_keep_order_repeat_and_miss(server, http, signed_in):
    near_here = {"lat": 44.50001, "lng": -28.0}
    places = [{"lat": 0, "lng": 0}, near_here, near_here, {"lat": 44.5003, "lng": -28.0}]
    url = f"{server.url}/v1/streetview/panoIds"
    reply = http.post(url, params=signed_in, json={"locations": places, "radius": 50}, timeout=5)
    assert reply.json()["panoIds"] == ["", "here", "here", "north"]
    many = http.post(url, params=signed_in, json={"locations": [near_here] * 101}, timeout=5)
    assert many.status_code == 400


def test_metadata_speaks_googles_angles(server, http, signed_in):
    url = f"{server.url}/v1/streetview/metadata"
    known = http.get(url, params=signed_in | {"panoId": "here"}, timeout=5).json()
    assert (known["imageWidth"], known["imageHeight"]) == (13312, 6656)
    assert (known["heading"], known["tilt"], known["roll"]) == (350.0, 87.5, 354.5)
    assert known["date"] == "2025-06"
    assert known["links"] == [{"panoId": "north", "heading": 0.0}]
    by_place = http.get(
        url, params=signed_in | {"lat": 44.50031, "lng": -28, "radius": 9}, timeout=5
    )
    assert by_place.json()["panoId"] == "north"


def test_retired_and_sparse_pictures(server, http, signed_in):
    server.set_faults(Faults(retired=frozenset({"north"}), sparse_metadata=True))
    url = f"{server.url}/v1/streetview/metadata"
    gone = http.get(url, params=signed_in | {"panoId": "north"}, timeout=5)
    assert (gone.status_code, gone.json()["error"]["status"]) == (404, "NOT_FOUND")
    known = http.get(url, params=signed_in | {"panoId": "here"}, timeout=5).json()
    assert "heading" not in known
    assert "date" not in known


def test_tiles_show_the_picture_and_pad_its_edges_with_black(server, http, signed_in, gradient):
    # 13312x6656 is 3328x1664 at zoom 3: the last column is half full, the last row a quarter.
    columns, rows = math.ceil(3328 / 512), math.ceil(1664 / 512)
    mosaic = np.vstack(
        [
            np.hstack([tile(server, http, signed_in, 3, x, y) for x in range(columns)])
            for y in range(rows)
        ]
    )
    whole = mosaic[:1664, :3328]
    expected = cv2.resize(gradient, (3328, 1664), interpolation=cv2.INTER_LINEAR)
    # At the seam a tile looks around the sphere, and `expected` does not.
    assert np.abs(whole.astype(int) - expected)[:, 4:-4].max() <= 12
    assert mosaic[1664 + 8 :].max() <= 3
    assert mosaic[:, 3328 + 8 :].max() <= 3


def test_outside_the_picture_is_black_or_missing(server, http, signed_in):
    assert tile(server, http, signed_in, 3, 7, 0).max() == 0
    assert tile(server, http, signed_in, 3, 0, 0, pano="far").max() == 0, "beyond its own zoom"
    server.set_faults(Faults(out_of_range="not-found", missing_tiles=frozenset({(3, 1, 1)})))
    assert tile(server, http, signed_in, 3, 7, 0) == 404
    assert tile(server, http, signed_in, 3, 1, 1) == 404
    assert tile(server, http, signed_in, 6, 0, 0) == 400


def test_cropped_and_small_tile_bodies(server, http, signed_in):
    server.set_faults(Faults(edge_tiles="cropped"))
    assert tile(server, http, signed_in, 3, 6, 3).shape == (128, 256, 3)
    server.set_faults(Faults(tile_body_px=256))
    assert tile(server, http, signed_in, 3, 0, 0).shape == (256, 256, 3)
