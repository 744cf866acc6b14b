"""One panel as a file: a column wide, so that it suits a paper and a telephone alike."""

import io
from dataclasses import dataclass
from typing import Any

WIDTH_IN, HEIGHT_IN = 4.4, 3.1
_DPI = 200
INK, GRID, BAND = "#222222", "#dddddd", 0.18
# Okabe and Ito's colors, which most color-blind people tell apart.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#999999")
DASHES = ("-", "--", "-.", ":")


@dataclass(frozen=True, slots=True, kw_only=True)
class FigureFile:
    """A figure, drawn.

    Attributes:
        id: Such as "F5.1".
        title: What it shows.
        caption: How to read it, and what it says where a figure says something.
        png: Its bytes.
        pdf: The same as vectors; b"" for pictures.
        wide: Whether it needs the whole width of a page.
    """

    id: str
    title: str
    caption: str
    png: bytes
    pdf: bytes = b""
    wide: bool = False

    @property
    def stem(self) -> str:
        """Of its files' names."""
        return self.id.lower().replace(".", "-").replace(" ", "-")


def panel(width_in: float = WIDTH_IN, height_in: float = HEIGHT_IN, columns: int = 1) -> Any:
    """A figure and its axes: one, or several beside each other with one y axis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width_in, height_in), dpi=_DPI, layout="constrained")
    axes = figure.subplots(1, columns, sharey=True, squeeze=False)[0]
    for axis in axes:
        axis.tick_params(labelsize=8, colors=INK, length=2.5)
        axis.grid(color=GRID, linewidth=0.6)
        axis.set_axisbelow(True)
        for side in ("top", "right"):
            axis.spines[side].set_visible(False)
    return figure, axes[0] if columns == 1 else axes


def label(axis: Any, across: str, up: str = "") -> None:
    """Name the axes."""
    axis.set_xlabel(across, fontsize=8.5, color=INK)
    if up:
        axis.set_ylabel(up, fontsize=8.5, color=INK)


def legend(axis: Any, **options: Any) -> None:
    """A legend without a frame."""
    axis.legend(fontsize=7.5, frameon=False, handlelength=2.2, labelspacing=0.35, **options)


def finished(
    figure: Any, *, id_: str, title: str, caption: str, wide: bool = False, vectors: bool = True
) -> FigureFile:
    """The figure's files; equal figures give equal bytes: no dates and versions are in them."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    png, pdf = io.BytesIO(), io.BytesIO()
    FigureCanvasAgg(figure).print_png(png, metadata={"Software": None})
    if vectors:
        with rc_context({"pdf.fonttype": 42}):
            FigureCanvasPdf(figure).print_pdf(
                pdf, metadata={"CreationDate": None, "Creator": None, "Producer": None}
            )
    return FigureFile(id=id_, title=title, caption=caption, png=png.getvalue(),
                      pdf=pdf.getvalue(), wide=wide)  # fmt: skip
