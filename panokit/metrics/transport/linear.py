"""Linear steps and their adjoints: what a transport is a chain of.

Every step maps an array with color in its last axis to another one, channel by channel. The
adjoint of a step answers <step.forward(x), y> = <x, step.adjoint(y)>: it carries a gradient
with respect to what comes out back to what went in.
"""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft, rfft
from scipy.sparse import csr_array

Values = NDArray[np.float32]


class Step(Protocol):
    """One linear map, and the same map read backward."""

    def forward(self, values: Values) -> Values:
        """From the light toward the picture."""

    def adjoint(self, values: Values) -> Values:
        """From a gradient of the picture toward the light."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sparse:
    """A sparse matrix on the flattened array.

    Attributes:
        matrix: (outputs, inputs) float32.
        input_shape: Of the array that goes in, without color.
        output_shape: Of the array that comes out, without color.
    """

    matrix: csr_array
    input_shape: tuple[int, ...]
    output_shape: tuple[int, ...]
    _transposed: csr_array = field(init=False)

    def __post_init__(self) -> None:
        # The transpose of a CSR array is CSC, and shares its memory.
        object.__setattr__(self, "_transposed", self.matrix.T)

    def forward(self, values: Values) -> Values:
        """The matrix times the values."""
        colors = values.shape[-1]
        result: Values = self.matrix @ np.ascontiguousarray(values.reshape(-1, colors))
        return result.reshape(*self.output_shape, colors)

    def adjoint(self, values: Values) -> Values:
        """The transposed matrix times the values."""
        colors = values.shape[-1]
        result: Values = self._transposed @ np.ascontiguousarray(values.reshape(-1, colors))
        return result.reshape(*self.input_shape, colors)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Separable:
    """A map reduced along its rows and its columns; the result is column by column.

    Attributes:
        rows: (h, H) sparse float32.
        columns: (w, W) sparse float32.
    """

    rows: csr_array
    columns: csr_array

    def forward(self, values: Values) -> Values:
        """(H, W, C) -> (w, h, C)."""
        height, width, colors = values.shape
        fewer = (self.rows @ values.reshape(height, -1)).reshape(-1, width, colors)
        turned = np.ascontiguousarray(fewer.transpose(1, 0, 2)).reshape(width, -1)
        result: Values = (self.columns @ turned).reshape(-1, self.rows.shape[0], colors)
        return result

    def adjoint(self, values: Values) -> Values:
        """(w, h, C) -> (H, W, C)."""
        colors = values.shape[-1]
        more = self.columns.T @ values.reshape(values.shape[0], -1)
        turned = more.reshape(-1, self.rows.shape[0], colors).transpose(1, 0, 2)
        flat = np.ascontiguousarray(turned).reshape(self.rows.shape[0], -1)
        result: Values = (self.rows.T @ flat).reshape(-1, self.columns.shape[1], colors)
        return result


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turning:
    """Circular convolutions over azimuth, from every ring of light to every ring of the ball.

    The kernels are even in azimuth (a ball is mirror-symmetric about the plane of view and
    normal), so their Fourier coefficients are real and the adjoint only swaps the rings.

    Attributes:
        table: (orders, radii, rings) float32: the mean over azimuth of kernel x cos(m azimuth).
    """

    table: Values

    def forward(self, values: Values) -> Values:
        """(rings, P, C) -> (radii, P, C)."""
        return self._convolved(self.table, values)

    def adjoint(self, values: Values) -> Values:
        """(radii, P, C) -> (rings, P, C)."""
        return self._convolved(self.table.transpose(0, 2, 1), values)

    def _convolved(self, table: Values, values: Values) -> Values:
        _, around, colors = values.shape
        orders, outputs, _ = table.shape
        waves = rfft(values, axis=1)[:, :orders].transpose(1, 0, 2)
        # As pairs of real numbers, since the table is real.
        pairs = np.ascontiguousarray(waves).view(np.float32)
        mixed = np.matmul(table, pairs).view(np.complex64) * np.float32(around)
        whole = np.zeros((outputs, around // 2 + 1, colors), np.complex64)
        whole[:, :orders] = mixed.transpose(1, 0, 2)
        return np.asarray(irfft(whole, n=around, axis=1), np.float32)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shadowed:
    """Light on matte surfaces of which parts are hidden, from sums that end at the last column.

    What a surface of normal n receives in the open is n . (sum of light x direction), if light
    from behind counts as negative; what it loses is the same sum over the lights that are
    hidden from it or stand behind it. Along a row of lights these are a few runs of columns,
    and the light in a run is the difference of two of the sums, so a surface needs only the
    places where its hidden share changes.

    Attributes:
        directions: (w, h, 3) float32 of the grid's nodes.
        changes: (outputs, 3 * w * h) sparse float32: n times each change of the visible share.
        output_shape: Of the picture, without color.
    """

    directions: Values
    changes: csr_array
    output_shape: tuple[int, ...]
    _transposed: csr_array = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_transposed", self.changes.T)

    def forward(self, values: Values) -> Values:
        """(w, h, C) -> (size, size, C)."""
        colors = values.shape[-1]
        weighted = np.moveaxis(self.directions, -1, 0)[..., None] * values
        sums = np.cumsum(weighted[:, ::-1], axis=1)[:, ::-1]
        received: Values = self.changes @ np.ascontiguousarray(sums).reshape(-1, colors)
        return received.reshape(*self.output_shape, colors)

    def adjoint(self, values: Values) -> Values:
        """(size, size, C) -> (w, h, C)."""
        colors = values.shape[-1]
        spread = self._transposed @ np.ascontiguousarray(values.reshape(-1, colors))
        sums = np.cumsum(spread.reshape(3, *self.directions.shape[:2], colors), axis=1)
        light = np.einsum("kwhc,whk->whc", sums, self.directions)
        return np.asarray(light, np.float32)
