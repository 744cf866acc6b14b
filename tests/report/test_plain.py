"""Any JSON appears, whatever it is."""

import json

from hypothesis import given
from hypothesis import strategies as st

from panokit.report import Charts, Group, Page, Table, Text, render_page, sections_of

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner),
    max_leaves=20,
)


@given(JSON)
def test_every_value_has_a_page(value):
    assert "<h2" in render_page(Page(title="x", sections=sections_of("Found", {"a": value})))


def test_single_values_are_a_table():
    (table,) = sections_of("Counts", {"maps": 8, "ok": True, "mean_error": None})
    assert isinstance(table, Table)
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["Maps", "8"],
        ["Ok", "yes"],
        ["Mean error", "–"],
    ]


def test_lists_of_numbers_are_charts_side_by_side_where_named():
    sets = {"reference": list(range(1, 20)), "augmented": list(range(1, 40))}
    (charts,) = sections_of("Peaks", {"peak": sets})
    assert isinstance(charts, Charts)
    assert [one.label for one in charts.charts[0].series] == ["Reference", "Augmented"]


def test_records_are_a_table_with_what_is_nested_as_columns_and_drawn():
    record = {
        "name": "top-share",
        "label": "Top share",
        "effect": "distorts",
        "shift": {"median": 0.2, "p": 0.01},
        "distribution": {
            "edges": [0, 1, 2],
            "reference_counts": [3, 4],
            "augmented_counts": [1, 9],
            "points": [0, 1],
            "reference_below": [0, 1],
        },
    }
    (group,) = sections_of("Changes", [record, {**record, "label": "Other"}])
    assert isinstance(group, Group)
    table, charts = group.sections
    assert [c.label for c in table.columns][-2:] == ["Shift: median", "Shift: p"]
    assert table.rows[0][2].badge.tone == "fail"
    assert [(c.title, c.kind) for c in charts.charts] == [
        ("Top share", "bins"),
        ("Top share", "curve"),
        ("Other", "bins"),
        ("Other", "curve"),
    ]
    assert [s.label for s in charts.charts[0].series] == ["Reference", "Augmented"]


def test_nothing_is_left_out():
    value = {
        "kind": "a-string",
        "deep": {"er": {"est": {"secret": 12345}, "also": [{"x": {"y": {"z": 54321}}}]}},
        "mixed": [1, "two", {"three": 3333}],
        "table": [{"a": 77777}, {"b": [9, 8, 7]}],
    }
    text = render_page(Page(title="x", sections=sections_of("All", json.loads(json.dumps(value)))))
    for word in ("a-string", "1.2·10⁴", "5.4·10⁴", "3333", "7.8·10⁴", "9, 8, 7", "two"):
        assert word in text, word


def test_a_long_table_is_folded():
    (group,) = sections_of("Maps", [{"name": f"m{i}", "value": i} for i in range(60)])
    assert isinstance(group, Group)
    assert group.folded


def test_an_empty_list_says_so():
    assert sections_of("Skipped", []) == (Text(title="Skipped", paragraphs=("None.",)),)
