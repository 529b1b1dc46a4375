"""A scene folder made of arrays, for `aligngs run` and `aligngs train`."""
from __future__ import annotations

import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np

from .arrays import Array
from .errors import BadInputError, UsageError
from .png import encode_png


@dataclass(frozen=True)
class Intrinsics:
    """Pinhole camera, in pixels. The centre of the first pixel is (0.5, 0.5)."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True)
class Points:
    """Points to start from."""

    positions: Array  # (n, 3), world
    colors: Array  # (n, 3) uint8


def _quaternion(rotation: Array) -> Array:
    """w x y z of a rotation matrix, from the eigenvector of its largest eigenvalue: stable for any angle."""
    m = rotation
    k = np.array([[m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0],
                  [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
                  [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
                  [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]]]) / 3
    _, vectors = np.linalg.eigh(k)  # reads the lower triangle
    x, y, z, w = vectors[:, -1]
    return np.array([w, x, y, z]) * (1 if w >= 0 else -1)


class Scene:
    """Photos with cameras and, if there are any, priors. Arrays are checked at once: UsageError names the first wrong one."""

    def __init__(self, images: Sequence[Array], intrinsics: Union[Intrinsics, Sequence[Intrinsics]], poses: Sequence[Array], *,
                 depths: Optional[Sequence[Array]] = None, confidences: Optional[Sequence[Array]] = None,
                 logits: Optional[Sequence[Array]] = None, logits_kind: str = "logits", points: Optional[Points] = None,
                 names: Optional[Sequence[str]] = None, test: Sequence[str] = (), depth_scale: str = "scene", metres: bool = False):
        """images: (h, w, 3) uint8. poses: (4, 4) camera to world, OpenCV axes. depths: (h, w) along z, larger is farther, 0 = none, any
        resolution of the same aspect. confidences: as depths, 0 = none. logits: (classes, h, w) of ADE20K. logits_kind: "logits", "scores"
        or "probabilities". names: of the photos, without extension. test: names that are not trained on. depth_scale: the `depth.scale` of
        priors.json. metres: the unit of the scene is the metre."""
        count = len(images)
        if count < 2:
            raise UsageError("a scene needs at least two images", field="images")
        self.images = [self._checked(image, f"images[{i}]", 3, np.uint8) for i, image in enumerate(images)]
        for i, image in enumerate(self.images):
            if image.shape[2] != 3:
                raise UsageError(f"is of shape {image.shape}, not (h, w, 3)", field=f"images[{i}]")
        self.intrinsics: List[Intrinsics] = [intrinsics] * count if isinstance(intrinsics, Intrinsics) else list(intrinsics)
        self.poses = [self._pose(pose, i) for i, pose in enumerate(poses)]
        self.names = list(names) if names is not None else [f"{i:04d}" for i in range(count)]
        self.depths = self._maps(depths, "depths", 2)
        self.confidences = self._maps(confidences, "confidences", 2)
        self.logits = self._maps(logits, "logits", 3)
        lists: List[Tuple[str, Optional[Sequence[Any]]]] = [
            ("intrinsics", self.intrinsics), ("poses", self.poses), ("names", self.names), ("depths", self.depths),
            ("confidences", self.confidences), ("logits", self.logits)]
        for field, values in lists:
            if values is not None and len(values) != count:
                raise UsageError(f"has {len(values)} entries for {count} images", field=field)
        for i, camera in enumerate(self.intrinsics):
            self._check_intrinsics(camera, i)
        if confidences is not None and depths is None:
            raise UsageError("is of no use without depths", field="confidences")
        if isinstance(test, str):
            raise UsageError(f"is one text, not a list of names: give [{test!r}]", field="test")
        if len(set(self.names)) != count:
            raise UsageError("two photos have one name", field="names")
        for name in self.names:
            if not name or name.startswith((".", "/")) or ".." in name.split("/") or any(c in name for c in "\\\n\0"):
                raise UsageError(f"this is no name of a photo: {name!r}", field="names")
        unknown = sorted(set(test) - set(self.names))
        if unknown:
            raise UsageError(f"there is no photo {unknown[0]}", field="test")
        if count - len(set(test)) < 2:
            raise UsageError("fewer than two photos are left to train on", field="test")
        if logits_kind not in ("logits", "scores", "probabilities"):
            raise UsageError(f"must be logits, scores or probabilities, not {logits_kind!r}", field="logits_kind")
        if depth_scale not in ("scene", "metres", "own", "per_view"):
            raise UsageError(f"must be scene, metres, own or per_view, not {depth_scale!r}", field="depth_scale")
        self.points, self.test, self.depth_scale, self.logits_kind, self.metres = points, list(test), depth_scale, logits_kind, metres
        if points is not None:
            self._check_points(points)

    @staticmethod
    def _check_intrinsics(camera: Any, index: int) -> None:
        field = f"intrinsics[{index}]" if index else "intrinsics"
        if not isinstance(camera, Intrinsics):
            raise UsageError(f"is {type(camera).__name__}, not Intrinsics", field=field)
        if not np.all(np.isfinite([camera.fx, camera.fy, camera.cx, camera.cy])) or camera.fx <= 0 or camera.fy <= 0:
            raise UsageError(f"has no finite numbers with positive focal lengths: {camera}", field=field)

    @staticmethod
    def _check_points(points: Points) -> None:
        positions, colors = np.asarray(points.positions), np.asarray(points.colors)
        if positions.shape != colors.shape or positions.ndim != 2 or positions.shape[1] != 3:
            raise UsageError("positions and colors must both be of shape (n, 3)", field="points")
        if positions.dtype.kind not in "fiu" or not np.all(np.isfinite(positions)):
            raise UsageError("positions must be finite numbers", field="points")
        if colors.dtype.kind not in "iu" or np.any(colors < 0) or np.any(colors > 255):
            raise UsageError(f"colors must be integers from 0 to 255, not {colors.dtype} as these", field="points")

    @staticmethod
    def _checked(array: Array, field: str, dimensions: int, kind: Any = None) -> Array:
        array = np.asarray(array)
        if array.ndim != dimensions or 0 in array.shape:
            raise UsageError(f"is of shape {array.shape}, which has not {dimensions} dimensions", field=field)
        if kind is not None and array.dtype != kind:
            raise UsageError(f"is {array.dtype}, not {np.dtype(kind)}", field=field)
        return array

    def _maps(self, maps: Optional[Sequence[Array]], field: str, dimensions: int) -> Optional[List[Array]]:
        if maps is None:
            return None
        checked = [self._checked(m, f"{field}[{i}]", dimensions) for i, m in enumerate(maps)]
        for i, m in enumerate(checked):
            if m.dtype.kind not in "fiu":
                raise UsageError(f"is {m.dtype}, which is no real number", field=f"{field}[{i}]")
        return [m.astype(np.float32) for m in checked]

    @staticmethod
    def _pose(pose: Array, index: int) -> Array:
        pose = np.asarray(pose, np.float64)
        field = f"poses[{index}]"
        if pose.shape != (4, 4) or not np.all(np.isfinite(pose)):
            raise UsageError("is no finite (4, 4) matrix", field=field)
        rotation = pose[:3, :3]
        if not np.allclose(rotation @ rotation.T, np.eye(3), atol=1e-4) or np.linalg.det(rotation) < 0:
            raise UsageError("its upper left (3, 3) is no rotation", field=field)
        if not np.allclose(pose[3], [0, 0, 0, 1], atol=1e-4):
            transposed = np.allclose(pose[:, 3], [0, 0, 0, 1], atol=1e-4)
            raise UsageError("is transposed: its last row has the translation" if transposed else "its last row is not 0 0 0 1", field=field)
        return pose

    def write(self, folder: Union[str, Path], overwrite: bool = False) -> Path:
        """Writes the scene folder. An existing folder is replaced only with `overwrite`, and only where this class wrote it."""
        folder = Path(folder)
        place = folder.resolve()  # what a link points to, and a name also for "."
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            try:
                ours = json.loads((folder / "scene.json").read_text(encoding="utf-8")).get("written_by") == "aligngs"
            except (OSError, ValueError, AttributeError):
                ours = False
            if not overwrite or not ours:
                raise UsageError("the folder exists", str(folder), remedy="name a new folder" if not ours else "give overwrite=True")
        made, old = (place.with_name(f"{place.name}{kind}.tmp-{os.getpid()}") for kind in ("", ".old"))
        try:
            self._write_into(made)
            if place.exists():
                place.rename(old)  # it comes back if the new one cannot take its place
            try:
                made.rename(place)
            except OSError:
                if old.exists():
                    old.rename(place)
                raise
        except OSError as error:
            raise BadInputError(f"cannot be written: {error.strerror}", str(folder)) from error
        finally:
            shutil.rmtree(made, ignore_errors=True)
        shutil.rmtree(old, ignore_errors=True)
        return folder

    def _write_into(self, folder: Path) -> None:
        for i, name in enumerate(self.names):
            self._put(folder / "images" / (name + ".png"), encode_png(self.images[i]))
            for part, maps in (("pred_depths", self.depths), ("pred_confidence", self.confidences), ("segmentation_logits", self.logits)):
                if maps is not None:
                    path = folder / part / (name + ".npy")
                    path.parent.mkdir(parents=True, exist_ok=True)
                    np.save(path, maps[i])
        self._put(folder / "sparse" / "cameras.txt", self._cameras())
        self._put(folder / "sparse" / "images.txt", self._images())
        self._put(folder / "sparse" / "points3D.txt", self._points())
        priors: Dict[str, Any] = {}
        if self.depths is not None:
            priors["depth"] = {"model": "given", "scale": self.depth_scale}
        if self.logits is not None:
            priors["semantics"] = {"model": "given", "kind": self.logits_kind}
        if priors:
            self._put_json(folder / "priors.json", priors)
        self._put_json(folder / "split.json", {"train": [n for n in self.names if n not in self.test], "test": self.test})
        self._put_json(folder / "scene.json", {"written_by": "aligngs", **({"units": "metres"} if self.metres else {})})

    def _cameras(self) -> bytes:
        lines = []
        for i, (camera, image) in enumerate(zip(self.intrinsics, self.images), 1):
            height, width = image.shape[:2]
            lines.append(f"{i} PINHOLE {width} {height} {camera.fx!r} {camera.fy!r} {camera.cx!r} {camera.cy!r}\n")
        return "".join(lines).encode()

    def _images(self) -> bytes:
        lines = []
        for i, (name, pose) in enumerate(zip(self.names, self.poses), 1):
            to_camera = np.linalg.inv(pose)
            numbers = [*_quaternion(to_camera[:3, :3]), *to_camera[:3, 3]]
            lines.append(f"{i} {' '.join(repr(float(n)) for n in numbers)} {i} {name}.png\n\n")
        return "".join(lines).encode()

    def _points(self) -> bytes:
        if self.points is None:
            return b""
        rows = zip(np.asarray(self.points.positions, np.float64), np.asarray(self.points.colors, np.uint8))
        return "".join(f"{i} {x!r} {y!r} {z!r} {r} {g} {b} 0\n" for i, ((x, y, z), (r, g, b)) in
                       enumerate(((map(float, p), c) for p, c in rows), 1)).encode()

    @staticmethod
    def _put(path: Path, data: bytes) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)

    @classmethod
    def _put_json(cls, path: Path, value: Any) -> None:
        cls._put(path, (json.dumps(value, indent=2) + "\n").encode())
