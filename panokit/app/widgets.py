"""What the places are made of: plain elements of HTML, labeled, each usable with the keyboard."""

import html
from collections.abc import Awaitable, Callable, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeAlias

from nicegui import ui
from nicegui.element import Element

Handler: TypeAlias = Callable[[], Awaitable[None] | None]
# An attribute, not Vue's `value`: that would undo what was typed whenever the page changes.
_START_VALUE = "^value"
Taker: TypeAlias = Callable[[Any], Awaitable[None] | None]


def words(tag: str, text: str, classes: str = "") -> ui.html:
    """A text in an element; nothing in it is markup."""
    return ui.html(html.escape(text), sanitize=False, tag=tag).classes(classes)


def say(element: ui.html, text: str) -> None:
    """Change the text of what `words` made."""
    element.set_content(html.escape(text))


def box(classes: str = "", tag: str = "div") -> Element:
    """An element to put others into."""
    return ui.element(tag).classes(classes)


def button(
    text: str, act: Handler, *, kind: str = "", label: str = "", disabled: bool = False
) -> Element:
    """A button.

    Args:
        text: On it.
        act: What it does.
        kind: "primary" for the one to press next, "quiet" for what is rarely wanted.
        label: For those who do not see what is around it, where the text alone says too little.
        disabled: Whether it can be pressed.
    """
    made = ui.element("button").classes(f"button {kind}").props('type="button"')
    if label:
        made.props["aria-label"] = label
    made.props["disabled"] = disabled
    with made:
        words("span", text)
    return made.on("click", lambda _: act(), [])


def enable(element: Element, *, on: bool) -> None:
    """Let a control be used, or not."""
    element.props["disabled"] = not on
    element.update()


def choice(
    label: str,
    options: Mapping[str, str],
    value: str,
    take: Taker,
) -> Element:
    """A list to choose one from.

    Args:
        label: What is chosen.
        options: Value -> its name.
        value: Chosen at first.
        take: Called with the value that is chosen.
    """
    with box("field", "label"):
        words("span", label, "field-label")
        chosen = ui.element("select").classes("control")
        # Else its options would be part of its name.
        chosen.props["aria-label"] = label
        with chosen:
            for one, name in options.items():
                option = words("option", name)
                option.props["value"] = one
                option.props["selected"] = one == value
    return chosen.on("change", lambda e: take(e.args), js_handler="(e) => emit(e.target.value)")


def text_field(
    label: str, value: str, take: Taker, *, placeholder: str = "", kind: str = "text"
) -> Element:
    """A line to type into; `take` gets it when it is left, or Enter is pressed."""
    with box("field", "label"):
        words("span", label, "field-label")
        typed = ui.element("input").classes("control")
        typed.props["type"] = kind
        typed.props[_START_VALUE] = value
        typed.props["placeholder"] = placeholder
        typed.props["autocomplete"] = "off"
        typed.props["spellcheck"] = "false"
    return typed.on("change", lambda e: take(e.args), js_handler="(e) => emit(e.target.value)")


def check(label: str, *, value: bool, take: Taker) -> Element:
    """A box to tick."""
    with box("check", "label"):
        ticked = ui.element("input")
        ticked.props["type"] = "checkbox"
        ticked.props["checked"] = value
        words("span", label)
    return ticked.on("change", lambda e: take(e.args), js_handler="(e) => emit(e.target.checked)")


def slider(
    label: str,
    *,
    low: float,
    high: float,
    step: float,
    value: float,
    take: Taker,
) -> Element:
    """A slider with its value beside it; `take` gets values while it moves, twelve a second."""
    with box("row-slider", "label"):
        words("span", label, "field-label")
        moved = ui.element("input")
        for name, one in (("min", low), ("max", high), ("step", step), (_START_VALUE, value)):
            moved.props[name] = one
        moved.props["type"] = "range"
        shown = words("output", f"{value:g}")
    # The figure follows the thumb in the browser; the server hears of it less often.
    follow = (
        "(e) => { e.target.parentElement.querySelector('output').textContent = e.target.value;"
        " emit(Number(e.target.value)); }"
    )
    moved.on("input", lambda e: take(float(e.args)), js_handler=follow, throttle=0.08)
    shown.props["aria-hidden"] = "true"
    return moved


def image(address: str, alt: str, classes: str = "") -> Element:
    """A picture with words for those who do not see it."""
    made = ui.element("img").classes(classes)
    made.props.update({"src": address, "alt": alt, "loading": "lazy", "decoding": "async"})
    return made


def badge(text: str, tone: str = "") -> ui.html:
    """A word that stands out."""
    return words("span", text, f"badge {tone}")


def facts(rows: Sequence[tuple[str, str]]) -> None:
    """Labels with what is known of each."""
    with box("facts", "dl"):
        for label, text in rows:
            with box("fact"):
                words("dt", label)
                words("dd", text)


def notes(texts: Sequence[str], tone: str = "note") -> None:
    """Sentences that must not be overlooked."""
    for text in texts:
        words("p", text, f"notice {tone}")


@contextmanager
def fold(summary: str, classes: str = "") -> Any:
    """Something that is closed until it is wanted."""
    with box(f"fold {classes}", "details"):
        words("summary", summary)
        with box("fold-body"):
            yield


def map_frame(address: str, title: str) -> Element:
    """The HDR viewer with one map."""
    made = ui.element("iframe").classes("map-frame")
    made.props.update({"src": address, "title": title})
    return made


def scroll_to(element: Element) -> None:
    """Bring what has just appeared into view."""
    ui.run_javascript(
        f"setTimeout(() => getHtmlElement({element.id})?.scrollIntoView("
        "{ behavior: 'smooth', block: 'start' }), 60)"
    )
