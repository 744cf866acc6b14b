"""The session token that every Google Map Tiles request carries, renewed when it ends."""

import json
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from panokit.errors import ItemError, NetworkError
from panokit.http import Client, Reply, Request

_MARGIN_S = 60.0


class GoogleSession:
    """Sends requests with key and session; any number of threads may share one.

    Args:
        endpoint: The root of the service.
        key: The API key.
        client: Sends the requests.
        clock: Seconds since the epoch.
    """

    def __init__(
        self, endpoint: str, key: str, client: Client, clock: Callable[[], float] = time.time
    ) -> None:
        self._endpoint = endpoint
        self._key = key
        self._client = client
        self._clock = clock
        self._token = ""
        self._renew_at_s = 0.0
        self._lock = threading.Lock()

    def send(self, request: Request) -> Reply:
        """Send a request with credentials; renew a session that was refused, once.

        Raises:
            PanokitError: As `Client.send`.
        """
        token = self._current(refused="")
        try:
            return self._client.send(self._signed(request, token))
        except ItemError as error:
            # An ended session is reported like a wrong argument, with status 400.
            if error.reason != "bad-request":
                raise
        return self._client.send(self._signed(request, self._current(refused=token)))

    def _signed(self, request: Request, token: str) -> Request:
        return replace(request, secrets={"session": token, "key": self._key})

    def _current(self, refused: str) -> str:
        """A token that is still good and is not the refused one."""
        with self._lock:
            if not self._token or self._token == refused or self._clock() >= self._renew_at_s:
                self._create()
            return self._token

    def _create(self) -> None:
        reply = self._client.send(
            Request(
                method="POST",
                url=f"{self._endpoint}/v1/createSession",
                secrets={"key": self._key},
                body={"mapType": "streetview", "language": "en-US", "region": "US"},
            )
        )
        now_s = self._clock()
        self._token, lifetime_s = parse_session(reply.body, now_s)
        # Early, but never so early that a short session would be renewed on each request.
        self._renew_at_s = now_s + lifetime_s - min(_MARGIN_S, lifetime_s / 2)


def parse_session(body: bytes, now_s: float) -> tuple[str, float]:
    """The token of a createSession reply, and for how many seconds it is good.

    Raises:
        NetworkError: If there is none.
    """
    reply: Mapping[str, Any] = json.loads(body)
    try:
        # The expiry is a string of seconds since the epoch.
        return str(reply["session"]), float(reply["expiry"]) - now_s
    except (KeyError, TypeError, ValueError):
        raise NetworkError(
            "Google's answer to createSession has no session. Check the endpoint."
        ) from None
