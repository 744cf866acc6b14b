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
class Factored:
    """A matrix of low rank, `left @ right`, minus a sparse one.

    Attributes:
        left: (outputs, rank) float32.
        right: (rank, inputs) float32.
        without: (outputs, inputs) sparse float32.
        input_shape: Of the array that goes in, without color.
        output_shape: Of the array that comes out, without color.
    """

    left: Values
    right: Values
    without: Sparse
    input_shape: tuple[int, ...]
    output_shape: tuple[int, ...]

    def forward(self, values: Values) -> Values:
        """The difference of the two products."""
        smooth = self.left @ (self.right @ values.reshape(-1, values.shape[-1]))
        return smooth.reshape(*self.output_shape, -1) - self.without.forward(values)

    def adjoint(self, values: Values) -> Values:
        """The same with both matrices transposed."""
        smooth = self.right.T @ (self.left.T @ values.reshape(-1, values.shape[-1]))
        return smooth.reshape(*self.input_shape, -1) - self.without.adjoint(values)
