"""What each source permits, and who must say yes to it."""

from pathlib import Path

import pytest

from panokit.errors import LicenseError
from panokit.fetch import FetchSettings, fetch
from panokit.fetch.prices import price_of
from panokit.fetch.terms import TERMS, require_consent
from panokit.io import read_capture
from tests.fetch.conftest import google

PAGES = Path(__file__).parents[2] / "docs" / "providers"


def test_google_s_terms_permit_nothing_and_ask_for_consent():
    for source in ("google-tiles", "google-static"):
        terms = TERMS[source]
        assert (terms.store, terms.derive, terms.train) == (False, False, False)
        with pytest.raises(LicenseError, match="--accept-terms google"):
            require_consent(source, ())
        require_consent(source, ("google",))


@pytest.mark.parametrize("source", ["panoramax", "mapillary", "polyhaven", "folder"])
def test_the_others_ask_for_nothing(source):
    require_consent(source, ())


def test_the_terms_stand_in_the_record(server, tmp_path):
    one = fetch(google(server, count=1), tmp_path).stored[0]
    capture = read_capture(one.folder).capture
    assert TERMS["google-tiles"].summary in capture.details["terms"]
    assert "Accepted by the user" in capture.details["terms"]
    assert capture.license.url == TERMS["google-tiles"].url


def test_the_key_in_toml_is_consent_too():
    settings = FetchSettings.model_validate(
        {"source": "google-tiles", "accept_terms": ["google"], "cities": ["Lyon"]}
    )
    require_consent(settings.source, settings.accept_terms)


@pytest.mark.parametrize("source", sorted(TERMS))
def test_every_source_has_a_page_with_its_license_and_its_cost(source):
    text = (PAGES / f"{source}.md").read_text(encoding="utf-8")
    for heading in ("## License", "## Cost", "## Set-up"):
        assert heading in text
    if TERMS[source].url:
        assert TERMS[source].url in text
    price = price_of(source)
    if price.usd_per_1000:
        assert f"{price.usd_per_1000:.2f}" in text
        assert f"{price.free_per_month:,}" in text
    if price.per_day:
        assert f"{price.per_day:,}" in text
