import json
import shutil

import pytest

from panokit.capture import Capture
from panokit.errors import ImageError, RecordError, UsageError
from panokit.io.images import encode_jpeg
from panokit.synthetic import ServeSettings, pictures_in, serve


def test_sidecars_are_believed_and_missing_places_invented(tmp_path, image, describe):
    for name in ("known", "unknown", "another"):
        shutil.copy(image, tmp_path / f"{name}.jpg")
    known = describe("its-id", 2048)
    (tmp_path / "known.json").write_text(json.dumps({"capture": known.to_json()}))
    pictures, invented = pictures_in(tmp_path)
    captures = {picture.image.stem: picture.capture for picture in pictures}
    assert captures["known"] == known
    assert captures["unknown"].license.id == "unknown"
    assert (captures["unknown"].width_px, captures["unknown"].height_px) == (1024, 512)
    assert captures["unknown"].longitude_deg != captures["another"].longitude_deg
    assert sorted(invented) == ["another.jpg", "unknown.jpg"]


def test_served_folder_is_found_by_its_box(tmp_path, image, http):
    shutil.copy(image, tmp_path / "street.jpg")
    serving = serve(tmp_path, ServeSettings(port=0))
    box = ",".join(str(edge) for edge in serving.bbox)
    with serving.server as server:
        found = http.get(f"{server.url}/api/search", params={"bbox": box}, timeout=5).json()
    assert [feature["id"] for feature in found["features"]] == ["street"]


def test_bad_folders_are_explained(tmp_path, gradient):
    with pytest.raises(UsageError, match="no pictures"):
        pictures_in(tmp_path)
    with pytest.raises(UsageError, match="no pictures"):
        pictures_in(tmp_path / "missing")
    (tmp_path / "wide.jpg").write_bytes(encode_jpeg(gradient[:300]))
    with pytest.raises(ImageError, match="1024x300"):
        pictures_in(tmp_path)
    (tmp_path / "wide.json").write_text("no json")
    with pytest.raises(RecordError, match="not JSON"):
        pictures_in(tmp_path)
    (tmp_path / "wide.json").write_text("[]")
    with pytest.raises(RecordError, match="not a capture"):
        pictures_in(tmp_path)


def test_capture_alone_is_a_sidecar_too(tmp_path, image, describe):
    shutil.copy(image, tmp_path / "a.jpg")
    (tmp_path / "a.json").write_text(json.dumps(describe("alone").to_json()))
    (picture,), invented = pictures_in(tmp_path)
    assert isinstance(picture.capture, Capture)
    assert picture.capture.id == "alone"
    assert not invented
