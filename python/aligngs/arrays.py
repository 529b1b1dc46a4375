"""The type of arrays in signatures. Comments beside them tell shapes and kinds of elements."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    Array = np.ndarray[Any, Any]
else:
    Array = np.ndarray  # an older numpy takes no brackets
