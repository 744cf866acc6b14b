"""Errors as Google's services word them (the envelope of google.rpc.Status)."""

from typing import Any

from panokit.synthetic.exchange import Reply, json_reply

_TYPE = "type.googleapis.com/google.rpc."


def invalid(message: str) -> Reply:
    """A 400 for a wrong argument."""
    return error(400, message, "INVALID_ARGUMENT")


def not_found() -> Reply:
    """A 404."""
    return error(404, "Requested entity was not found.", "NOT_FOUND")


def error(code: int, message: str, status: str, reason: str = "") -> Reply:
    """An error with the machine-readable reason that some carry."""
    described: dict[str, Any] = {"code": code, "message": message, "status": status}
    if reason:
        described["details"] = [
            _info(reason, {"service": "tile.googleapis.com"}),
            {"@type": f"{_TYPE}LocalizedMessage", "locale": "en-US", "message": message},
        ]
    return json_reply({"error": described}, code)


def too_many(period: str, retry_after_s: float) -> Reply:
    """A 429; Google states the delay in the body and often sends no Retry-After.

    Args:
        period: "minute" or "day", both are a 429. That of a day names no delay.
        retry_after_s: How long to wait.
    """
    details = [_info("RATE_LIMIT_EXCEEDED", {"quota_limit": f"StreetViewTilesPer{period.title()}"})]
    if period == "minute":
        details.append(
            {"@type": f"{_TYPE}RetryInfo", "retryDelay": f"{round(retry_after_s, 3):g}s"}
        )
    message = (
        "Quota exceeded for quota metric 'Street View tile requests' and limit "
        f"'Street View tile requests per {period}'."
    )
    described = {
        "code": 429,
        "message": message,
        "status": "RESOURCE_EXHAUSTED",
        "details": details,
    }
    return json_reply({"error": described}, 429)


def _info(reason: str, metadata: dict[str, str]) -> dict[str, Any]:
    return {
        "@type": f"{_TYPE}ErrorInfo",
        "reason": reason,
        "domain": "googleapis.com",
        "metadata": metadata,
    }
