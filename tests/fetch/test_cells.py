"""Searching by cells: full ones are cut, none is searched twice."""

from panokit.fetch.cells import Cells, Listing


class Searched:
    """A made-up index of points that lists at most `limit` of a box."""

    def __init__(self, points, limit):
        self.points, self.limit, self.boxes = points, limit, []

    def __call__(self, bbox):
        self.boxes.append(bbox)
        west, south, east, north = bbox
        inside = [(y, x) for y, x in self.points if south <= y <= north and west <= x <= east]
        return Listing(inside[: self.limit], is_complete=len(inside) < self.limit)


POINTS = [(y / 10, x / 10) for y in range(10) for x in range(10)]


def test_an_area_that_fits_in_one_reply_is_searched_once():
    search = Searched(POINTS, limit=101)
    cells = Cells((0, 0, 1, 1), search)
    assert [len(cells.around(point)) for point in POINTS] == [100] * 100
    assert len(search.boxes) == 1


def test_full_cells_are_cut_until_everything_is_listed():
    search = Searched(POINTS, limit=10)
    cells = Cells((0, 0, 1, 1), search)
    listed = {item for point in POINTS for item in cells.around(point)}
    assert listed == set(POINTS)
    assert all(point in cells.around(point) for point in POINTS)
    assert len(search.boxes) == len(set(search.boxes)) < 50


def test_a_crowd_on_one_spot_comes_to_an_end():
    search = Searched([(0.5, 0.5)] * 50, limit=10)
    assert len(Cells((0, 0, 1, 1), search).around((0.5, 0.5))) == 10
    assert len(search.boxes) < 15
