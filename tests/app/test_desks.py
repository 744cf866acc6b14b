"""Tabs have things of their own, which no other tab has, and which go with it."""

import pytest

from panokit.app.desks import Desks
from panokit.app.settings import AppSettings
from panokit.errors import UsageError


@pytest.fixture
def desks(tmp_path):
    return Desks(AppSettings(), tmp_path / "desks")


def name_of(address):
    return address.rsplit("/", 1)[1]


def test_two_tabs_share_nothing(desks):
    one, two = desks.open(), desks.open()
    name = name_of(one.publish(b"mine", "text/plain"))
    one.pictures["film"] = lambda name: name.encode()
    assert one.published[name].content == b"mine"
    assert name not in two.published
    assert not two.pictures
    assert one.folder != two.folder
    assert one.token != two.token


def test_tokens_and_names_cannot_be_guessed(desks):
    tokens = {desks.open().token for _ in range(50)}
    assert len(tokens) == 50
    assert min(map(len, tokens)) >= 24
    desk = desks.open()
    assert desk.publish(b"", "text/plain") != desk.publish(b"", "text/plain")


def test_an_address_changes_when_what_it_shows_does(desks):
    desk = desks.open()
    before = desk.publish(b"1", "image/png", key="mask")
    after = desk.publish(b"2", "image/png", key="mask")
    assert before != after
    assert name_of(before) not in desk.published
    assert desk.published[name_of(after)].content == b"2"


def test_keys_that_begin_alike_are_different(desks):
    desk = desks.open()
    left = desk.publish(b"1", "image/png", key="mask-left")
    desk.publish(b"2", "image/png", key="mask")
    desk.publish(b"3", "image/png", key="mask")
    assert name_of(left) in desk.published


def test_a_closed_tab_leaves_nothing(desks):
    one, two = desks.open(), desks.open()
    (one.room("light") / "light.exr").write_bytes(b"x")
    one.publish(b"mine", "text/plain")
    desks.close(one)
    assert desks.find(one.token) is None
    assert desks.find(two.token) is two
    assert not one.folder.exists()
    assert not one.published
    assert two.folder.exists()
    desks.close_all()
    assert not two.folder.exists()
    assert len(desks) == 0


def test_a_room_is_empty_each_time(desks):
    desk = desks.open()
    (desk.room("light") / "old.exr").write_bytes(b"x")
    assert not list(desk.room("light").iterdir())


def test_a_kind_of_picture_that_is_not_there_is_told(desks):
    with pytest.raises(UsageError, match="no pictures"):
        desks.open().picture("film9", "0")
