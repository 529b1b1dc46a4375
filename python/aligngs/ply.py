"""Binary little-endian PLY files as the program writes them, as numpy arrays."""
from __future__ import annotations

from pathlib import Path
from typing import Dict, List, Tuple, Union

import numpy as np

from .arrays import Array
from .errors import BadInputError

_TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4", "float": "<f4", "double": "<f8",
          "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2", "int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8"}
_LONGEST_HEADER = 1 << 16  # bytes; the program's headers have two thousand

Field = Tuple[str, str]


def read_ply(path: Union[str, Path]) -> Dict[str, Array]:
    """Structured arrays by the names of elements ("vertex", "face"). A list property is read where it is the only property of its
    element and all its lists are equally long, as in a triangle mesh; the array is then of shape (count, length)."""
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise BadInputError(f"cannot be read: {error.strerror}", str(path)) from error
    end = data.find(b"end_header\n", 0, _LONGEST_HEADER)
    if not data.startswith(b"ply\n") or end < 0:
        raise BadInputError("this is no PLY file", str(path), "header")
    lines = data[:end].decode("utf-8", "replace").split("\n")
    if "format binary_little_endian 1.0" not in lines:
        raise BadInputError("this PLY file is not binary little-endian", str(path), "format")
    offset, elements = end + len(b"end_header\n"), {}
    for name, count, fields in _elements(lines, path):
        if len(fields) == 1 and fields[0][1].startswith("list "):
            elements[name], offset = _read_lists(data, offset, count, fields[0][1], path, name)
            continue
        if any(kind.startswith("list ") for _, kind in fields):
            raise BadInputError("a list beside other properties is not read", str(path), name)
        row = np.dtype([(field, _TYPES[kind]) for field, kind in fields])
        _require_bytes(data, offset, count * row.itemsize, path, name)
        elements[name] = np.frombuffer(data, row, count, offset)
        offset += count * row.itemsize
    return elements


def _elements(lines: List[str], path: Path) -> List[Tuple[str, int, List[Field]]]:
    elements: List[Tuple[str, int, List[Field]]] = []
    for number, line in enumerate(lines, 1):
        words = line.split()
        try:
            if words[:1] == ["element"]:
                elements.append((words[1], int(words[2]), []))
            elif words[:2] == ["property", "list"]:
                elements[-1][2].append((words[4], f"list {_TYPES[words[2]]} {_TYPES[words[3]]}"))
            elif words[:1] == ["property"]:
                _ = _TYPES[words[1]]
                elements[-1][2].append((words[2], words[1]))
        except (IndexError, KeyError, ValueError) as error:
            raise BadInputError("this line of the header is wrong", str(path), f"line {number}") from error
    return elements


def _read_lists(data: bytes, offset: int, count: int, kind: str, path: Path, name: str) -> Tuple[Array, int]:
    _, length_type, item_type = kind.split()
    if count == 0:
        return np.zeros((0, 3), item_type), offset
    _require_bytes(data, offset, np.dtype(length_type).itemsize, path, name)
    length = int(np.frombuffer(data, length_type, 1, offset)[0])
    row = np.dtype([("length", length_type), ("items", item_type, (length,))])
    _require_bytes(data, offset, count * row.itemsize, path, name)
    rows = np.frombuffer(data, row, count, offset)
    if np.any(rows["length"] != length):
        raise BadInputError("its lists are not equally long", str(path), name)
    return rows["items"], offset + count * row.itemsize


def _require_bytes(data: bytes, offset: int, wanted: int, path: Path, name: str) -> None:
    if wanted < 0 or offset + wanted > len(data):
        raise BadInputError("the file is cut off", str(path), name, "make it again")
