"""The one way to the network: a polite HTTP client that keeps secrets.

Client    sends requests, with retries by class of failure
Request   what is asked, and how its answer is judged
Reply     what came back
Policy    timeouts, attempts, rates
Budget    how many requests and how much money may be spent
"""

from typing import TYPE_CHECKING

from panokit.lazy import lazy_names

if TYPE_CHECKING:
    from panokit.http.budget import Budget
    from panokit.http.client import Client
    from panokit.http.messages import Reply, Request
    from panokit.http.policy import Policy

__getattr__, __dir__, __all__ = lazy_names(
    __name__,
    {
        "Budget": "panokit.http.budget",
        "Client": "panokit.http.client",
        "Policy": "panokit.http.policy",
        "Reply": "panokit.http.messages",
        "Request": "panokit.http.messages",
    },
)
