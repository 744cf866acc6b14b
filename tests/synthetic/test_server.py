import pytest
import requests

from panokit.errors import UsageError
from panokit.synthetic import Faults, ServedPicture, StreetServer, Trouble


def test_log_keeps_every_request_with_its_query(server, http):
    http.get(f"{server.url}/api/search", params={"bbox": "0,0,1,1"}, timeout=5)
    http.get(f"{server.url}/nothing", timeout=5)
    assert [request.path for request in server.requests] == ["/api/search", "/nothing"]
    assert server.requests[0].query == {"bbox": "0,0,1,1"}


def test_troubles_pass_after_the_number_of_times_they_have(server, http):
    server.set_faults(
        Faults(
            troubles=[
                Trouble(kind="500", path="/api", times=2),
                Trouble(kind="429", path="/api", retry_after_s=7),
            ]
        )
    )
    replies = [http.get(f"{server.url}/api/configuration", timeout=5) for _ in range(4)]
    assert [reply.status_code for reply in replies] == [500, 500, 429, 200]
    assert replies[2].headers["Retry-After"] == "7"


def test_google_states_its_delay_in_the_body_alone(server, http):
    server.set_faults(Faults(troubles=[Trouble(kind="429-body", retry_after_s=41)]))
    reply = http.get(f"{server.url}/v1/streetview/metadata", timeout=5)
    assert "Retry-After" not in reply.headers
    assert reply.json()["error"]["details"][1]["retryDelay"] == "41s"


def test_web_page_with_status_200(server, http):
    server.set_faults(Faults(troubles=[Trouble(kind="html")]))
    reply = http.get(f"{server.url}/api/pictures/here/thumb.jpg", timeout=5)
    assert (reply.status_code, reply.content[:15]) == (200, b"<!DOCTYPE html>")


def test_truncated_body_breaks_off(server):
    server.set_faults(Faults(troubles=[Trouble(kind="truncated", path="thumb")]))
    url = f"{server.url}/api/pictures/here/thumb.jpg"
    with pytest.raises(requests.exceptions.ChunkedEncodingError):
        requests.get(url, timeout=5)
    assert requests.get(url, timeout=5).status_code == 200


def test_a_picture_without_a_place_cannot_be_served(describe, image):
    with pytest.raises(UsageError, match="without latitude_deg"):
        ServedPicture(capture=describe("lost", latitude_deg=None), image=image)


def test_equal_ids_and_a_taken_port_are_usage_errors(pictures, server):
    with pytest.raises(UsageError, match="same id"):
        StreetServer([pictures[0], pictures[0]])
    port = int(server.url.rsplit(":", 1)[1])
    with pytest.raises(UsageError, match=f"Port {port}"):
        StreetServer(pictures, port=port)
