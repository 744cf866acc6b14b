"""`panokit lighting`: click an object in a video, get the light of its scene."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from panokit.cli.options import Flag, Json
from panokit.console import Console
from panokit.errors import ItemError, UsageError
from panokit.lighting.settings import OutputSettings, SessionSettings

if TYPE_CHECKING:
    from panokit.lighting.estimate import LightEstimate
    from panokit.lighting.pair import Click
    from panokit.lighting.video import Frames


def lighting(
    video: Path | None = None,
    /,
    *,
    click: tuple[str, ...] = (),
    frame: int = 0,
    out: Path,
    running: Flag = False,
    settings: Annotated[SessionSettings, Parameter(name="*")] = SessionSettings(),
    write: Annotated[OutputSettings, Parameter(name="--write")] = OutputSettings(),
    json: Json = False,
) -> int:
    """The light of a scene from a video whose camera moves sideways past an object.

    The object is selected by a click, followed until it has moved far enough, and cut out of two
    frames, which a network reads. With several clicks the light is that of all objects together.

    Parameters
    ----------
    video
        A video file, or a folder of pictures; the clip that comes with panokit if not given.
    click
        Column and row of a pixel of the object, "X,Y", in frame --frame; "X,Y@N" for a frame of
        its own. Can be given several times.
    frame
        The frame of the click, from 0.
    out
        Where the light goes: EXR, HDR, lights, harmonics, files for other tools, the views.
    running
        Go on to the end of the video: read again as the camera moves on and when the light
        changes, and average.
    """
    from panokit.lighting.clip import CLIP_CLICK, clip_path
    from panokit.lighting.session import light_from_video, session_record, write_session
    from panokit.lighting.video import open_frames

    console = Console(as_json=json)
    if video is not None and not click:
        raise UsageError("Say where the object is: --click X,Y")
    clicks = [_click(text, frame) for text in click] or [CLIP_CLICK]
    frames = open_frames(video or clip_path())
    if running:
        return _running(frames, clicks, out, settings, write, console)
    with console.stage("follow", None) as tick:
        result = light_from_video(frames, clicks, settings, on_frame=lambda _: tick())
    write_session(result, out, write)
    for one in result.found:
        left, right = one.pair.left.number, one.pair.right.number
        console.result(
            f"views: frames {left} and {right}, {one.pair.shift:.0%} of the object apart"
        )
    _tell(result.estimate, out, console)
    console.value(session_record(result))
    return 0


def _running(
    frames: "Frames",
    clicks: "list[Click]",
    out: Path,
    settings: SessionSettings,
    write: OutputSettings,
    console: Console,
) -> int:
    if len(clicks) > 1:
        raise UsageError("--running follows one object. Leave the other clicks, or --running.")
    from panokit.lighting.model import LightingModel
    from panokit.lighting.outputs import write_outputs
    from panokit.lighting.running import running_light

    state, counts, lost = None, {"read": 0, "changed": 0}, 0
    model = LightingModel(settings.model, settings.estimate)
    with console.stage("follow", None) as tick:
        for state in running_light(frames, clicks[0], model, settings):
            tick()
            if state.what in counts:
                counts[state.what] += 1
            lost += state.what == "lost"
    if state is None or state.estimate is None:
        raise ItemError(
            "The object never moved far enough sideways for a second view. Move the camera "
            "sideways past it.",
            reason="no-parallax",
        )
    write_outputs(state.estimate, out, write)
    console.result(
        f"{counts['read']} readings, {counts['changed']} changes of light, {lost} frames lost; "
        f"the last {state.readings} averaged"
    )
    _tell(state.estimate, out, console)
    console.value({**counts, "lost": lost, "averaged": state.readings, **state.estimate.to_json()})
    return 0


def _click(text: str, frame: int) -> "Click":
    from panokit.lighting.pair import Click

    place, _, number = text.partition("@")
    try:
        column, row = (float(value) for value in place.split(","))
        return Click(column=column, row=row, frame=int(number) if number else frame)
    except ValueError as error:
        raise UsageError(f"--click {text}: give column and row, as 320,180 or 320,180@12.") from (
            error
        )


def _tell(estimate: "LightEstimate", out: Path, console: Console) -> None:
    for warning in estimate.warnings:
        console.result(f"mind: {warning}")
    sure = estimate.confidence
    if sure is not None:
        console.result(
            f"radiance off by a factor of about {1 / sure.value:.1f}, direction by "
            f"{sure.direction_deg:.0f} degrees"
            + ("" if sure.calibrated else " (not calibrated: at least)")
        )
    console.result(f"The light: {out / 'light.exr'}")
