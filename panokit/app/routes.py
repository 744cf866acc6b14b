"""What a tab's page fetches and sends besides the words of its interface."""

from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from fastapi import FastAPI, Request
from fastapi.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.requests import ClientDisconnect

from panokit.app.desks import Desk, Desks, Published
from panokit.app.uploads import PICTURES, VIDEOS
from panokit.app.work import Work, in_words
from panokit.errors import PanokitError

_ACCEPTED = {"picture": PICTURES, "video": VIDEOS, "frames": PICTURES}
_GONE = "This belongs to a tab that is closed. Open the application anew."
# Names in addresses are random or say all that a picture depends on, so they never change.
_KEPT = {"cache-control": "private, max-age=3600"}


def add_routes(api: FastAPI, desks: Desks, work: Work) -> None:
    """Add what tabs fetch and send to the server."""

    @api.get("/desk/{token}/thing/{name}")
    def thing(token: str, name: str) -> Response:
        desk = desks.find(token)
        published = desk and desk.published.get(name)
        return _sent(published) if published else PlainTextResponse(_GONE, status_code=404)

    @api.get("/desk/{token}/picture/{kind}/{name}")
    async def picture(token: str, kind: str, name: str) -> Response:
        desk = desks.find(token)
        if desk is None:
            return PlainTextResponse(_GONE, status_code=404)
        try:
            data = await work.in_thread(desk.picture, kind, name)
        except PanokitError as error:
            return PlainTextResponse(str(error), status_code=404)
        except (ValueError, IndexError):
            return PlainTextResponse("There is no such picture.", status_code=404)
        media_type = "image/png" if data.startswith(b"\x89PNG") else "image/jpeg"
        return Response(data, media_type=media_type, headers=_KEPT)

    @api.put("/desk/{token}/upload/{kind}")
    async def upload(
        token: str, kind: str, request: Request, name: str, batch: str = ""
    ) -> Response:
        desk = desks.find(token)
        if desk is None or kind not in _ACCEPTED:
            return JSONResponse({"error": _GONE}, status_code=404)
        try:
            path = await desk.inbox.receive(name, _chunks(request), _ACCEPTED[kind], batch=batch)
        except ClientDisconnect:
            return JSONResponse({"error": "The upload was interrupted."}, status_code=400)
        except PanokitError as error:
            return JSONResponse({"error": in_words(error)}, status_code=400)
        return JSONResponse({"file": str(path.relative_to(desk.inbox.folder))})


def _sent(published: Published) -> Response:
    if isinstance(published.content, Path):
        return FileResponse(
            published.content,
            media_type=published.media_type,
            filename=published.filename or None,
        )
    headers = dict(_KEPT)
    if published.filename:
        headers["content-disposition"] = f'attachment; filename="{published.filename}"'
    return Response(published.content, media_type=published.media_type, headers=headers)


def uploaded(desk: Desk, file: Any) -> Path:
    """The path of a file that `upload` named to the browser, and the browser to us.

    Raises:
        PanokitError: If it is not one of this tab's.
    """
    folder = desk.inbox.folder.resolve()
    path = (folder / str(file)).resolve()
    if not path.is_relative_to(folder) or not path.is_file():
        raise PanokitError("This file is not there any more. Drop it again.")
    return path


async def _chunks(request: Request) -> AsyncIterator[bytes]:
    async for chunk in request.stream():
        yield chunk
