"""What a run made, as numpy arrays and dataclasses. Lengths are in the units of the scene."""
from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Dict, List, Optional, Union

import numpy as np

from .arrays import Array
from .errors import BadInputError
from .ply import read_ply

_REST = 15  # coefficients of each colour channel beyond the constant one: spherical harmonics of degree 3


@dataclass(frozen=True)
class Gaussians:
    """n splats. Colour is 0.5 + sh evaluated in the direction of view."""

    positions: Array  # (n, 3) float32
    scales: Array  # (n, 3) float32, standard deviations along the axes
    rotations: Array  # (n, 4) float32, unit quaternions w x y z
    opacities: Array  # (n,) float32 in (0, 1)
    sh: Array  # (n, 16, 3) float32

    def __len__(self) -> int:
        return len(self.positions)


@dataclass(frozen=True)
class LabelClass:
    id: int
    name: str
    synonyms: List[str]
    gaussians: int  # that have this class


@dataclass(frozen=True)
class Labels:
    """A class and an object of each Gaussian."""

    classes: List[LabelClass]
    label: Array  # (n,) uint16, index into classes
    instance: Array  # (n,) uint16, number of the object within its class, 0: none
    confidence: Array  # (n,) float32 in [0, 1]


@dataclass(frozen=True)
class Camera:
    """OpenCV axes: x right, y down, z forward. Pixels: the centre of the first one is (0.5, 0.5)."""

    name: str
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    camera_to_world: Array  # (4, 4) float64
    split: str  # "train" or "test"

    @property
    def matrix(self) -> Array:
        """(3, 3) float64."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], np.float64)


@dataclass(frozen=True)
class Mesh:
    vertices: Array  # (n, 3) float32
    triangles: Array  # (m, 3) int32, indices of vertices
    normals: Optional[Array]  # (n, 3) float32
    colors: Optional[Array]  # (n, 3) uint8
    labels: Optional[Array]  # (n,) uint16, index into Labels.classes


def _columns(rows: Array, names: List[str], path: Path) -> Array:
    missing = [name for name in names if name not in (rows.dtype.names or ())]
    if missing:
        raise BadInputError("this is no file of Gaussians", str(path), missing[0])
    columns: Array = np.stack([rows[name] for name in names], axis=1).astype(np.float32)
    return columns


class Run:
    """A run folder. Files are read when they are asked for. Every part that a run may lack is None where it is absent."""

    def __init__(self, folder: Union[str, Path]):
        self.folder = Path(folder)
        self._json("run.json")  # fails here, and not later, where the folder holds no run

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r})"

    def _json(self, name: str) -> Any:
        path = self.folder / name
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            remedy = "name the folder of a run" if name == "run.json" else "let the run end: aligngs run ... --resume"
            raise BadInputError(f"cannot be read: {error.strerror}", str(path), remedy=remedy) from error
        except ValueError as error:
            raise BadInputError(f"this is no JSON: {error}", str(path)) from error

    def _json_or_none(self, name: str) -> Optional[Dict[str, Any]]:
        return self._json(name) if (self.folder / name).exists() else None

    @cached_property
    def record(self) -> Dict[str, Any]:
        """run.json: command, stages, warnings."""
        record: Dict[str, Any] = self._json("run.json")
        return record

    @property
    def done(self) -> bool:
        return self.record.get("status") == "done" and self.record.get("stage") == "done"

    @cached_property
    def metrics(self) -> Optional[Dict[str, Any]]:
        """metrics.json: figures with their protocols."""
        return self._json_or_none("metrics.json")

    @cached_property
    def room(self) -> Optional[Dict[str, Any]]:
        """room.json: walls, openings, furniture and measures."""
        return self._json_or_none("room.json")

    @cached_property
    def gaussians(self) -> Gaussians:
        path = self.folder / "scene.ply"
        rows = read_ply(path).get("vertex")
        if rows is None:
            raise BadInputError("this is no file of Gaussians", str(path), "vertex")
        constant = _columns(rows, [f"f_dc_{c}" for c in range(3)], path)
        rest = _columns(rows, [f"f_rest_{i}" for i in range(3 * _REST)], path).reshape(-1, 3, _REST)
        return Gaussians(
            positions=_columns(rows, ["x", "y", "z"], path),
            scales=np.exp(_columns(rows, ["scale_0", "scale_1", "scale_2"], path)),
            rotations=_columns(rows, ["rot_0", "rot_1", "rot_2", "rot_3"], path),
            opacities=1 / (1 + np.exp(-_columns(rows, ["opacity"], path)[:, 0])),
            sh=np.concatenate([constant[:, None, :], rest.transpose(0, 2, 1)], axis=1),
        )

    @cached_property
    def labels(self) -> Optional[Labels]:
        path = self.folder / "scene.labels.ply"
        if not path.exists():
            return None
        rows = read_ply(path)["vertex"]
        classes = [LabelClass(c["id"], c["name"], list(c.get("synonyms", [])), c["gaussians"]) for c in self._json("classes.json")["classes"]]
        return Labels(classes, rows["label"].copy(), rows["instance"].copy(), rows["confidence"].astype(np.float32) / 255)

    @cached_property
    def cameras(self) -> List[Camera]:
        cameras = []
        for c in self._json("cameras.json"):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = c["rotation"], c["position"]
            cameras.append(Camera(c["img_name"], c["width"], c["height"], c["fx"], c["fy"], c["cx"], c["cy"], pose, c["split"]))
        return cameras

    @cached_property
    def mesh(self) -> Optional[Mesh]:
        path = self.folder / "mesh" / "mesh.ply"
        if not path.exists():
            return None
        elements = read_ply(path)
        rows = elements["vertex"]
        names = rows.dtype.names or ()

        def columns(first: str, *others: str) -> Optional[Array]:
            return np.stack([rows[name] for name in (first, *others)], axis=1) if first in names else None

        vertices = columns("x", "y", "z")
        if vertices is None:
            raise BadInputError("this mesh has no vertices", str(path))
        return Mesh(vertices, elements.get("face", np.zeros((0, 3), np.int32)), columns("nx", "ny", "nz"), columns("red", "green", "blue"),
                    rows["label"].copy() if "label" in names else None)

    @property
    def events(self) -> List[Dict[str, Any]]:
        """The course of the training, so far."""
        from .program import follow_events
        return list(follow_events(self.folder, lambda: True))
