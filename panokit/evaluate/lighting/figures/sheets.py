"""Pictures: contact sheets, scenes in predicted light, exposure brackets, the dataset."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from panokit.color import bracket, luminance
from panokit.color.transfer import srgb_encode_u8
from panokit.evaluate.lighting.figures.drawing import FigureFile
from panokit.evaluate.lighting.figures.spread import featured
from panokit.evaluate.lighting.kept import KeptSample
from panokit.evaluate.lighting.outcome import Entrant, Outcome
from panokit.evaluate.lighting.scoring import DOMINANCE
from panokit.io.images import encode_png
from panokit.metrics.transport import transport
from panokit.sphere import resize_radiance

Picture = NDArray[np.uint8]

_CELL_PX, _GAP_PX, _HEAD_PX, _LINE_PX, _SIDE_PX = 128, 6, 22, 18, 74
_PAPER, _INK = (255, 255, 255), (34, 34, 34)
_KEY = 0.18
_WHITE_PERCENT = 99.9
_SCENES = {"diffuse": "matte ball", "glossy-0.3": "satin ball", "mirror": "mirror ball",
           "plane": "plane and shadows"}  # fmt: skip
_STOPS = (0.0, -2.0, -4.0, -6.0, -8.0)
_TONES = (
    "Maps are tone mapped by Reinhard's operator, all of a row with the truth's key "
    f"{_KEY} and white at its {_WHITE_PERCENT}th percentile."
)
# Figure, its name, what its score is called.
_SHEETS = (
    ("F5.8 sheet", "thesis-mse", "MSE"),
    ("F5.9 sheet", "thesis-dssim", "DSSIM"),
    ("F5.10 sheet", "brightest", "brightest pixel, °"),
)


def draw_sheets(outcome: Outcome) -> list[FigureFile]:
    """All sheets of pictures; none where no samples were kept."""
    keys = [key for key in outcome.kept.sample_keys() if key in set(outcome.keys)]
    shown = [e for e in featured(outcome) if _has_predictions(outcome, e, keys)]
    if not keys or not shown:
        return []
    found = [_contact(outcome, shown, keys, *what) for what in _SHEETS]
    found += [
        _relit(outcome, shown, keys),
        _brackets(outcome, shown, keys),
        _dataset(outcome, keys),
    ]
    return found


def _contact(
    outcome: Outcome, shown: Sequence[Entrant], keys: Sequence[str], id_: str, name: str, said: str
) -> FigureFile:
    judge = shown[0]
    rows, labels, notes = [], [], []
    for percent, key in _at_percentiles(outcome, judge, name, keys):
        sample = outcome.kept.sample(key)
        maps = [_prediction(outcome, entrant, key) for entrant in shown]
        rows.append([sample.left, sample.right, *(shared_tone(m, sample.truth)
                                                  for m in (sample.truth, *maps))])  # fmt: skip
        labels.append(f"p{percent}")
        number = outcome.keys.index(key)
        notes.append(["", "", "", *(f"{outcome.scores(e, name)[number]:.3g}" for e in shown)])
    heads = ["left", "right", "truth", *(entrant.title for entrant in shown)]
    return FigureFile(
        id=id_,
        title=f"Samples at the quartiles: {said}",
        caption=f"The kept samples that are nearest to the 25th, 50th and 75th percentile of "
        f"{judge.title}; below each prediction its {said}. {_TONES}",
        png=encode_png(sheet(rows, heads, labels, notes)),
        wide=True,
    )


def _relit(outcome: Outcome, shown: Sequence[Entrant], keys: Sequence[str]) -> FigureFile:
    """F-C: known scenes in the true light and in the predicted."""
    rows: list[list[Picture]] = []
    labels: list[str] = []
    groups: list[int] = []
    for _, key in _at_percentiles(outcome, shown[0], "relit-diffuse-si-rmse", keys)[::2]:
        groups.append(len(rows))
        sample = outcome.kept.sample(key)
        maps = {"truth": sample.truth} | {e.title: _prediction(outcome, e, key) for e in shown}
        flats = {name: resize_radiance(one, 64, 32) for name, one in maps.items()}
        gains = {scene: _exposure(flats["truth"], scene) for scene in _SCENES}
        for name, flat in flats.items():
            cells = [shared_tone(maps[name], sample.truth)]
            cells += [_scene(flat, scene, gains[scene]) for scene in _SCENES]
            rows.append(cells)
            labels.append(name)
    heads = ["light", *_SCENES.values()]
    return FigureFile(
        id="F-C",
        title="Known scenes in true and predicted light",
        caption="By precomputed transport, at the exposure of the truth: its 95th percentile is at "
        "80 % of white. The samples are the lower and the upper quartile of the matte ball's error "
        f"of {shown[0].title}. {_TONES}",
        png=encode_png(sheet(rows, heads, labels, side_px=150, groups=groups)),
        wide=True,
    )


def _brackets(outcome: Outcome, shown: Sequence[Entrant], keys: Sequence[str]) -> FigureFile:
    """F-I: the light at several exposures, of the sample with the strongest light."""
    dominance = outcome.scores(shown[0], DOMINANCE)
    key = max(keys, key=lambda one: float(dominance[outcome.keys.index(one)]))
    truth = outcome.kept.sample(key).truth
    maps = {"truth": truth} | {e.title: _prediction(outcome, e, key) for e in shown}
    return FigureFile(
        id="F-I",
        title="Exposure bracket of true and predicted light",
        caption="As a camera would show it: 1.0, the white of the pictures, is white at 0 stops. "
        "Of the kept samples the one with the most dominant light.",
        png=encode_png(sheet([bracket(one, _STOPS) for one in maps.values()],
                             [f"{stop:+g} stops" if stop else "0 stops" for stop in _STOPS],
                             list(maps), side_px=150)),
        wide=True,
    )  # fmt: skip


def _dataset(outcome: Outcome, keys: Sequence[str]) -> FigureFile:
    """F-J: samples as the thesis's figure 4.1 shows them."""
    chosen = [keys[int(n)] for n in np.linspace(0, len(keys) - 1, min(6, len(keys)))]
    rows = []
    for key in chosen:
        sample: KeptSample = outcome.kept.sample(key)
        rows.append([sample.left, sample.right, sample.normals,
                     shared_tone(sample.truth, sample.truth)])  # fmt: skip
    return FigureFile(
        id="F-J",
        title="Samples of the dataset",
        caption="As figure 4.1 of the thesis: both views, normals as (n + 1) / 2, and the light "
        "around the left camera.",
        png=encode_png(sheet(rows, ["left", "right", "normals", "light"], ["" for _ in rows],
                             side_px=0)),
    )  # fmt: skip


def sheet(
    rows: Sequence[Sequence[Picture]],
    heads: Sequence[str],
    labels: Sequence[str],
    notes: Sequence[Sequence[str]] | None = None,
    *,
    side_px: int = _SIDE_PX,
    groups: Sequence[int] = (),
) -> Picture:
    """Pictures in rows, with headings, a label on each row, and a note below each picture.

    Args:
        rows: The pictures, as many in each row.
        heads: Of the columns.
        labels: Of the rows.
        notes: Below the pictures.
        side_px: For the labels.
        groups: Rows that begin something new: a line is drawn above them.
    """
    line = _LINE_PX if notes else 0
    step = _CELL_PX + _GAP_PX
    size = (side_px + _GAP_PX + len(heads) * step,
            _HEAD_PX + len(rows) * (step + line))  # fmt: skip
    page = Image.new("RGB", size, _PAPER)
    draw = ImageDraw.Draw(page)
    font = ImageFont.load_default(size=11)
    for column, text in enumerate(heads):
        left = side_px + _GAP_PX + column * step
        draw.text((left, _HEAD_PX // 2), _fitting(draw, text, font, _CELL_PX), fill=_INK,
                  font=font, anchor="lm")  # fmt: skip
    for number, row in enumerate(rows):
        top = _HEAD_PX + number * (step + line)
        draw.text((_GAP_PX, top + _CELL_PX // 2), _fitting(draw, labels[number], font, side_px),
                  fill=_INK, font=font, anchor="lm")  # fmt: skip
        if number and number in groups:
            draw.line([(0, top - _GAP_PX // 2 - 1), (size[0], top - _GAP_PX // 2 - 1)], fill=_INK)
        for column, picture in enumerate(row):
            left = side_px + _GAP_PX + column * step
            page.paste(_cell(picture), (left, top))
            if notes:
                draw.text((left, top + _CELL_PX + _LINE_PX // 2), notes[number][column],
                          fill=_INK, font=font, anchor="lm")  # fmt: skip
    return np.asarray(page)


def _fitting(draw: ImageDraw.ImageDraw, text: str, font: object, width_px: int) -> str:
    """As much of a text as fits."""
    while len(text) > 1 and draw.textlength(text, font=font) > width_px:  # type: ignore[arg-type]
        text = text.removesuffix("…")[:-1] + "…"
    return text


def _cell(picture: Picture) -> Image.Image:
    way = Image.Resampling.NEAREST if picture.shape[0] <= _CELL_PX else Image.Resampling.BOX
    return Image.fromarray(picture).resize((_CELL_PX, _CELL_PX), way)


def shared_tone(radiance: NDArray[np.float32], truth: NDArray[np.float32]) -> Picture:
    """A map as a picture, with the tone curve that the truth gets.

    Reinhard et al. 2002, equations 1 to 4, on luminance; key and white are the truth's, so
    that a map that is too dark looks too dark.
    """
    scene = luminance(np.asarray(truth, np.float32))
    average = float(np.exp(np.mean(np.log(scene + 1e-6 * float(scene.max() or 1)))))
    gain = _KEY / max(average, 1e-12)
    white = max(float(np.percentile(scene * gain, _WHITE_PERCENT)), 1.0)
    own = luminance(np.asarray(radiance, np.float32))
    scaled = own * np.float32(gain)
    display = scaled * (1 + scaled / white**2) / (1 + scaled)
    return srgb_encode_u8(radiance * (display / np.maximum(own, 1e-12))[..., None])


def _exposure(flat: NDArray[np.float32], scene: str) -> float:
    operator = transport(scene, 64)
    lit = luminance(operator.forward(flat))[operator.alpha > 0]
    return 0.8 / max(float(np.percentile(lit, 95)), 1e-9)


def _scene(flat: NDArray[np.float32], scene: str, gain: float) -> Picture:
    operator = transport(scene, 64)
    lit = operator.forward(flat) * np.float32(gain) * operator.alpha[..., None]
    paper = np.float32(1) - operator.alpha[..., None]
    picture = Image.fromarray(srgb_encode_u8(np.maximum(lit, 0) + paper))
    return np.asarray(picture.resize((_CELL_PX, _CELL_PX), Image.Resampling.BICUBIC))


def _at_percentiles(
    outcome: Outcome, entrant: Entrant, name: str, keys: Sequence[str]
) -> list[tuple[int, str]]:
    """The kept samples nearest to the quartiles of all samples, each at most once."""
    scores = outcome.scores(entrant, name)
    kept = {key: float(scores[outcome.keys.index(key)]) for key in keys}
    left = {key: value for key, value in kept.items() if np.isfinite(value)}
    found = []
    for percent in (25, 50, 75):
        if left:
            wanted = float(np.nanpercentile(scores, percent))
            key = min(left, key=lambda one: abs(left[one] - wanted))
            found.append((percent, key))
            del left[key]
    return found


def _prediction(outcome: Outcome, entrant: Entrant, key: str) -> NDArray[np.float32]:
    found = outcome.kept.prediction(outcome.digest_of(entrant.members[0]), key)
    return np.zeros((64, 64, 3), np.float32) if found is None else found


def _has_predictions(outcome: Outcome, entrant: Entrant, keys: Sequence[str]) -> bool:
    digest = outcome.digest_of(entrant.members[0])
    return bool(keys) and all(outcome.kept.prediction(digest, key) is not None for key in keys)
