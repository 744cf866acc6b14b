"""One exchange with a server: the only module of panokit that imports `requests`.

Redirects are followed by hand, so that no credential reaches another origin; bodies are read
within limits of size and time; whatever goes wrong comes back as a `Failure`.
"""

import logging
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http.cookiejar import DefaultCookiePolicy
from typing import Any
from urllib.parse import parse_qsl, urlencode, urljoin, urlsplit, urlunsplit

import requests
from requests import exceptions
from urllib3.exceptions import (
    DecodeError,
    HTTPError,
    ProtocolError,
    ReadTimeoutError,
)

from panokit.http.failures import Failure, FailureKind
from panokit.http.messages import Reply, Request, public_url
from panokit.http.policy import Policy
from panokit.http.redact import Redactor

_log = logging.getLogger("panokit.http")
NO_CONNECTION = "no-connection"
_MAX_REDIRECTS = 5
_CHUNK_BYTES = 1 << 16


class Transport:
    """Connections of any number of threads, one session for each.

    Args:
        policy: Timeouts and the size limit.
        redactor: Knows the credentials that were sent.
        user_agent: How servers know us.
    """

    def __init__(self, policy: Policy, redactor: Redactor, user_agent: str) -> None:
        self._policy = policy
        self._redactor = redactor
        self._user_agent = user_agent
        self._local = threading.local()
        self._sessions: list[requests.Session] = []
        self._environments: dict[str, dict[str, Any]] = {}
        self._lock = threading.Lock()

    def exchange(self, request: Request) -> Reply | Failure:
        """Ask once; a reply may have any status."""
        try:
            return self._follow(request)
        except exceptions.SSLError:
            return _unreachable("tls", "its certificate is not accepted")
        except (exceptions.InvalidURL, exceptions.InvalidSchema):
            return _unreachable("bad-address", "it is not a web address")
        except _BadRedirectError as error:
            return _unreachable("bad-redirect", str(error))
        except (exceptions.RequestException, HTTPError, OSError) as error:
            # Told by its kind only: the text of these errors holds the whole URL.
            reason, message = _network_trouble(error)
            return Failure(kind=FailureKind.TRANSIENT, reason=reason, message=message)

    def close(self) -> None:
        """Close every connection."""
        with self._lock:
            for session in self._sessions:
                session.close()
            self._sessions.clear()
            self._local = threading.local()

    def _follow(self, request: Request) -> Reply:
        """Send, and go where redirects lead."""
        deadline_s = time.monotonic() + self._policy.total_timeout_s
        method, url, body = request.method, request.url, request.body
        params: Mapping[str, str] = {**request.params, **request.secrets}
        headers = {"Authorization": request.authorization} if request.authorization else {}
        for _ in range(_MAX_REDIRECTS + 1):
            with self._response(method, url, params, headers, body) as response:
                _log.debug("%s %s: %d", method, public_url(url), response.status_code)
                location = response.headers.get("Location")
                if not response.is_redirect or location is None:
                    data = self._read(response, deadline_s)
                    return Reply(status=response.status_code, headers=response.headers, body=data)
            # The new address is taken as it stands: parameters and credentials stay here.
            source, url, params = url, self._redirect_target(url, location), {}
            if not _is_same_origin(source, url):
                headers = {}
            if response.status_code not in (307, 308):
                method, body = "GET", None
        raise _BadRedirectError("it redirects in circles")

    @contextmanager
    def _response(
        self,
        method: str,
        url: str,
        params: Mapping[str, str],
        headers: Mapping[str, str],
        body: Any,
    ) -> Iterator[requests.Response]:
        timeout = (self._policy.connect_timeout_s, self._policy.read_timeout_s)
        session = self._session()
        response = session.request(
            method,
            url,
            params=params,
            headers=dict(headers),
            json=body,
            timeout=timeout,
            allow_redirects=False,
            stream=True,
            **self._surroundings(session, url),
        )
        try:
            yield response
        finally:
            response.close()

    def _read(self, response: requests.Response, deadline_s: float) -> bytes:
        chunks, total = [], 0
        # Whatever has come, not a full chunk: a trickle must not get past the deadline.
        while chunk := response.raw.read1(_CHUNK_BYTES, decode_content=True):
            chunks.append(chunk)
            total += len(chunk)
            if total > self._policy.max_body_bytes:
                raise exceptions.ContentDecodingError("too large")
            if time.monotonic() > deadline_s:
                raise exceptions.ReadTimeout("too slow")
        return b"".join(chunks)

    def _surroundings(self, session: requests.Session, url: str) -> dict[str, Any]:
        """Proxies and certificates that the environment names for a host, looked up once."""
        host = urlsplit(url)._replace(path="", query="", fragment="").geturl()
        known = self._environments.get(host)
        if known is None:
            with self._lock:
                session.trust_env = True
                found = session.merge_environment_settings(host, {}, None, None, None)
                session.trust_env = False
            known = {name: found[name] for name in ("proxies", "verify", "cert")}
            self._environments[host] = known
        return known

    def _redirect_target(self, source: str, location: str) -> str:
        """Where a redirect leads, without credentials if that is another origin."""
        target = urljoin(source, location)
        old, new = urlsplit(source), urlsplit(target)
        if old.scheme == "https" and new.scheme != "https":
            raise _BadRedirectError("it redirects from https to an unencrypted address")
        if _is_same_origin(source, target):
            return target
        given = parse_qsl(new.query, keep_blank_values=True)
        kept = [(name, value) for name, value in given if not self._redactor.is_secret(value)]
        # A signed address must arrive exactly as it was written.
        return target if kept == given else urlunsplit(new._replace(query=urlencode(kept)))

    def _session(self) -> requests.Session:
        """This thread's session: `requests` does not promise that threads may share one."""
        session: requests.Session | None = getattr(self._local, "session", None)
        if session is None:
            session = requests.Session()
            session.headers["User-Agent"] = self._user_agent
            # Proxies come from the environment (see above), passwords from ~/.netrc do not.
            session.auth = _no_authentication
            session.trust_env = False
            session.cookies.set_policy(DefaultCookiePolicy(allowed_domains=[]))
            self._local.session = session
            with self._lock:
                self._sessions.append(session)
        return session


class _BadRedirectError(Exception):
    """A redirect that must not be followed."""


def _is_same_origin(one: str, other: str) -> bool:
    a, b = urlsplit(one), urlsplit(other)
    return (a.scheme, a.netloc) == (b.scheme, b.netloc)


def _no_authentication(request: requests.PreparedRequest) -> requests.PreparedRequest:
    return request


def _unreachable(reason: str, message: str) -> Failure:
    return Failure(kind=FailureKind.UNREACHABLE, reason=reason, message=message)


def _network_trouble(error: Exception) -> tuple[str, str]:
    """The reason and the message of an exchange that broke off; the first match counts."""
    troubles: list[tuple[type[Exception], str, str]] = [
        (exceptions.ConnectTimeout, NO_CONNECTION, "the server does not answer"),
        (exceptions.Timeout, "slow", "the server is too slow"),
        (ReadTimeoutError, "slow", "the server is too slow"),
        (ProtocolError, "truncated", "the answer ended early"),
        (DecodeError, "damaged", "the answer is damaged"),
        (exceptions.ChunkedEncodingError, "truncated", "the answer ended early"),
        (exceptions.ContentDecodingError, "damaged", "the answer is damaged or too large"),
        (exceptions.ProxyError, NO_CONNECTION, "the proxy does not answer"),
        (exceptions.ConnectionError, NO_CONNECTION, "no connection"),
    ]
    if error.args and isinstance(error.args[0], ProtocolError):
        # The connection stood, so that there is somebody who may answer the next time.
        return "reset", "the connection was cut"
    for kind, reason, message in troubles:
        if isinstance(error, kind):
            return reason, message
    return "network", f"no connection ({type(error).__name__})"
