import cv2
import numpy as np
import pytest

from panokit.synthetic import Faults, ServedPicture, StreetServer
from panokit.synthetic.panoramax import tile_columns

BOX = "-28.1,44.4,-27.9,44.7"


def decoded(reply):
    return cv2.imdecode(np.frombuffer(reply.content, np.uint8), cv2.IMREAD_COLOR_RGB)


def search(server, http, **query):
    return http.get(f"{server.url}/api/search", params=query, timeout=5)


def test_search_sorts_by_distance_and_has_no_next_link(server, http):
    # The center of the box is 33 m north of the first picture, where the second one is.
    found = search(server, http, bbox="-28.1,44.4003,-27.9,44.6003", limit=2).json()
    assert [feature["id"] for feature in found["features"]] == ["north", "here"]
    assert found["links"] == []


@pytest.mark.parametrize("query", [{"bbox": "1,2,3"}, {"bbox": "3,2,1,4"}, {"limit": "0"}])
def test_bad_questions_get_panoramaxs_error(server, http, query):
    reply = search(server, http, **query)
    assert reply.status_code == 400
    assert reply.json()["status_code"] == 400
    assert reply.json()["message"]


def test_search_narrows_by_time_id_and_collection(server, http):
    def ids(**query):
        features = search(server, http, bbox=BOX, **query).json()["features"]
        return {feature["id"] for feature in features}

    assert ids() == {"here", "north", "far"}
    assert ids(ids="here,far") == {"here", "far"}
    assert ids(collections="other") == {"far"}
    assert ids(datetime="2025-06-01T00:00:00Z/2025-06-02T00:00:00Z") == {"here", "north", "far"}
    assert ids(datetime="2025-06-02T00:00:00Z/..") == set()


def test_item_describes_the_picture_as_a_real_instance_does(server, http):
    item = http.get(f"{server.url}/api/pictures/here", timeout=5).json()
    properties = item["properties"]
    assert item["geometry"]["coordinates"] == [-28.0, 44.5]
    assert item["providers"][0]["name"] == "the testers"
    assert properties["license"] == "CC0-1.0"
    assert properties["datetime"] == "2025-06-01T12:30:00+00:00"
    assert properties["view:azimuth"] == 350.0
    assert (properties["pers:pitch"], properties["pers:roll"]) == (-2.5, -5.5)
    assert properties["pers:interior_orientation"]["field_of_view"] == 360
    assert "panokit:synthetic" not in properties
    same = http.get(f"{server.url}/api/collections/walk/items/here", timeout=5).json()
    assert same == item


def test_synthetic_pictures_say_so(describe, image, http):
    picture = ServedPicture(capture=describe("made", details={"synthetic": True}), image=image)
    with StreetServer([picture]) as server:
        item = http.get(f"{server.url}/api/pictures/made", timeout=5).json()
    assert item["properties"]["panokit:synthetic"] is True


def test_collection_is_paged_with_next_links(server, http):
    url = f"{server.url}/api/collections/walk/items?limit=1"
    seen = []
    while url:
        page = http.get(url, timeout=5).json()
        seen += [feature["id"] for feature in page["features"]]
        url = next((link["href"] for link in page["links"] if link["rel"] == "next"), None)
    assert seen == ["here", "north"]


def test_full_picture_is_redirected_and_credentials_there_are_noticed(
    describe, image, gradient, http
):
    picture = ServedPicture(capture=describe("whole", 1024), image=image)
    with StreetServer([picture]) as server:
        href = http.get(f"{server.url}/api/pictures/whole", timeout=5).json()["assets"]["hd"][
            "href"
        ]
        first = http.get(href, timeout=5, allow_redirects=False)
        assert first.status_code == 302
        assert first.headers["Location"].startswith(server.storage_url)
        # A picture of its declared size is served as the file it is.
        assert http.get(href, timeout=5).content == image.read_bytes()
        assert server.violations == []
        http.get(first.headers["Location"], headers={"Authorization": "Bearer x"}, timeout=5)
        assert len(server.violations) == 1


def test_smaller_versions_have_panoramaxs_widths(server, http):
    root = f"{server.url}/api/pictures/here"
    assert decoded(http.get(f"{root}/sd.jpg", timeout=5)).shape == (1024, 2048, 3)
    assert decoded(http.get(f"{root}/thumb.jpg", timeout=5)).shape == (250, 500, 3)


@pytest.mark.parametrize(
    ("width_px", "columns"),
    [(4096, 8), (5760, 8), (7680, 8), (8192, 16), (11000, 16), (12000, 16), (16384, 32)],
)
def test_tile_columns_are_those_of_real_instances(width_px, columns):
    assert tile_columns(width_px) == columns


def test_tiles_are_floored_but_say_they_are_not(describe, image, gradient, http):
    picture = ServedPicture(capture=describe("odd", 11000), image=image)
    with StreetServer([picture]) as server:
        item = http.get(f"{server.url}/api/pictures/odd", timeout=5).json()
        (matrix,) = item["properties"]["tiles:tile_matrix_sets"]["geovisio"]["tileMatrix"]
        assert (matrix["tileWidth"], matrix["matrixWidth"]) == (687.5, 16)
        root = f"{server.url}/api/pictures/odd/tiled"
        tile = decoded(http.get(f"{root}/15_7.jpg", timeout=5))
        assert tile.shape == (687, 687, 3)
        # The last tile ends 8 columns before the right edge of the picture.
        scale = 1024 / 11000
        x, y = int((15 * 687 + 343) * scale), int((7 * 687 + 343) * scale)
        assert np.abs(tile[343, 343].astype(int) - gradient[y, x]).max() <= 6
        assert http.get(f"{root}/16_0.jpg", timeout=5).status_code == 404


def test_retired_pictures_are_listed_but_gone(server, http):
    server.set_faults(Faults(retired=frozenset({"here"})))
    assert search(server, http, bbox=BOX).json()["features"]
    gone = http.get(f"{server.url}/api/pictures/here", timeout=5)
    assert gone.status_code == 404
    assert gone.json() == {"message": "Picture doesn't exist", "status_code": 404}
