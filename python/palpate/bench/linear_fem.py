"""Linear elasticity by finite elements, with which ``palpate bench truth-cube`` compares.

scikit-fem is an optional package, for this benchmark only. Hexahedra with linear shape functions.
"""

from __future__ import annotations

from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import OptionError

__all__ = ["LinearFem"]


class LinearFem:
    """A block of hexahedra between plates that it sticks to at both ends of z."""

    def __init__(self, nodes: NDArray[np.float64], poisson: float) -> None:
        """Assembles the stiffness of a mesh with E = 1.

        Args:
            nodes: Positions [mm], shape [z, y, x, 3].
            poisson: Poisson's ratio.

        Raises:
            OptionError: scikit-fem is not installed.
        """
        LinearFem.check()
        self._skfem = skfem = import_module("skfem")
        models = import_module("skfem.models.elasticity")
        depth, height, width, _ = self._shape = nodes.shape
        counted = skfem.MeshHex.init_tensor(
            *(np.arange(n, dtype=float) for n in (width, height, depth))
        )
        # the library numbers nodes as it likes: by where they are, ours are found again
        x, y, z = np.rint(counted.p).astype(int)
        self._place = (z, y, x)
        mesh = skfem.MeshHex(np.ascontiguousarray(nodes[self._place].T), counted.t)
        self._basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()), intorder=3)
        lame = models.lame_parameters(1.0, poisson)
        self._stiffness = skfem.asm(models.linear_elasticity(*lame), self._basis)

    @staticmethod
    def check() -> None:
        """Checks that scikit-fem is installed.

        Raises:
            OptionError: It is not installed; the message says how to install it.
        """
        try:
            import_module("skfem")
        except ImportError:
            raise OptionError(
                "scikit-fem is not installed; allowed: pip install 'palpate[bench]', to measure "
                "beside it"
            ) from None

    def pressed(self, stroke: float) -> NDArray[np.float64]:
        """Returns the nodes' displacements [mm], of their shape, for that of the lower plate."""
        dofs = self._basis.nodal_dofs
        layer = self._place[0]
        low, high = layer == 0, layer == self._shape[0] - 1
        moved = self._basis.zeros()
        moved[dofs[2, low]] = stroke
        held = dofs[:, low | high].ravel()
        moved = self._skfem.solve(*self._skfem.condense(self._stiffness, x=moved, D=held))
        field = np.empty(self._shape)
        field[self._place] = moved[dofs].T
        return field
