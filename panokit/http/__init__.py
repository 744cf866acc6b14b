"""The one way to the network: a polite HTTP client that keeps secrets.

client     sends requests, with retries by class of failure
messages   requests and replies
policy     timeouts, attempts, rates
budget     how many requests and how much money may be spent
transport  one exchange; the only module that imports `requests`
failures   what went wrong, and whether asking again can help
breaker    services that are down as a whole
limiter    a rate per host, and pauses that servers ask for
redact     credentials out of everything that is shown
"""

from panokit.http.budget import Budget
from panokit.http.client import Client
from panokit.http.messages import Reply, Request
from panokit.http.policy import Policy

__all__ = ["Budget", "Client", "Policy", "Reply", "Request"]
