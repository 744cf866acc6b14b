"""The sheet of credits."""

import csv

from panokit.capture import Capture, License, license_from_spdx
from panokit.io.attribution import attribution_text, write_attribution


def picture(name, terms, provider="panoramax"):
    return Capture(
        provider=provider, id=name, license=terms, source_url=f"https://example.org/{name}"
    )


BY = license_from_spdx("CC-BY-4.0", "Ada")
ALIKE = license_from_spdx("CC-BY-SA-4.0", "Grace *the* mapper")
CLOSED = License(id="google-maps-platform", attribution="Google Maps, © Google")


def test_each_author_is_credited_once_under_the_license():
    text = attribution_text([picture("1", BY), picture("2", ALIKE), picture("3", BY)])
    assert text.count("Ada") == 1
    assert "- Ada: panoramax-1, panoramax-3" in text
    assert text.index("CC-BY-4.0") < text.index("Ada") < text.index("CC-BY-SA-4.0")


def test_what_is_permitted_is_said_in_words():
    text = attribution_text([picture("1", BY)])
    assert "may be kept, changed and used for training. <https://creativecommons.org" in text
    assert "carries the same license" in attribution_text([picture("1", ALIKE)])
    closed = attribution_text([picture("1", CLOSED)])
    assert "These pictures may not be kept, changed or used for training." in closed


def test_names_do_not_become_markup():
    assert "Grace \\*the\\* mapper" in attribution_text([picture("1", ALIKE)])


def test_a_picture_without_an_author_is_listed_too():
    unknown = License(id="unknown", attribution="")
    assert "- no author named: folder-x" in attribution_text([picture("x", unknown, "folder")])


def test_the_files(tmp_path):
    captures = [picture("2", ALIKE), picture("1", BY), picture("1", BY)]
    write_attribution(tmp_path / "a", captures)
    write_attribution(tmp_path / "b", reversed(captures))
    for name in ("ATTRIBUTION.md", "ATTRIBUTION.csv"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    rows = list(csv.DictReader((tmp_path / "a" / "ATTRIBUTION.csv").read_text().splitlines()))
    assert [row["id"] for row in rows] == ["1", "2"]
    assert (rows[1]["license"], rows[1]["share_alike"], rows[0]["train"]) == (
        "CC-BY-SA-4.0", "yes", "yes",
    )  # fmt: skip
    assert rows[0]["source_url"] == "https://example.org/1"
