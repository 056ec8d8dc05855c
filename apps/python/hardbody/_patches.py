"""Contact patches: all places at which the surfaces of two bodies are within a given distance of touching."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hardbody import _core
from hardbody._arrays import _Rows
from hardbody._typing import AnyBody, Reals, RotationLike, Shapes, Strings
from hardbody._values import Comparable

# In the order of the C++ enumerators.
_KINDS = np.array(["empty", "point", "segment", "polygon"])


@dataclass(frozen=True, eq=False)
class ContactPatch(Comparable):
    """Contact patch of two bodies: all u across the normal at which h_B(u) - h_A(u) <= within.

    h_A(u) is the greatest height of A along the normal over u, h_B(u) the least of B.

    at: DistanceResult of the bodies, whose normal it is.
    kind: "polygon", "segment", "point", or "empty": the surfaces are further apart everywhere, or there is no distance.
    area: area of a polygon, else 0.
    centre: centroid, halfway between the surfaces, shape (3,); NaN if the patch is empty.
    error: greatest distance of the outline from the patch's own (length).
    point_a, point_b: corners on the surfaces, anticlockwise about the normal, world frame, shape (K, 3).
    depth: height of A's surface above that of B at each corner, shape (K,); negative where they are apart.
    id: identity of each corner, the same from call to call while bodies move a little, int64 of shape (K,).
    """

    at: _core.DistanceResult
    kind: str
    area: float
    centre: Reals
    error: float
    point_a: Reals
    point_b: Reals
    depth: Reals
    id: NDArray[np.int64]


@dataclass(frozen=True, eq=False, repr=False)
class ContactPatches(_Rows):
    """Contact patches of M pairs: arrays with one row a pair, and arrays with one row a corner.

    normal: unit vectors from A to B, world frame, shape (M, 3).
    area, error: as of ContactPatch, shape (M,).
    centre: as of ContactPatch, shape (M, 3).
    kind: "polygon", "segment", "point" or "empty", shape (M,).
    pair: row of `pairs` that each corner belongs to, ascending, int64 of shape (K,).
    point_a, point_b: corners, world frame, shape (K, 3).
    depth: depths at the corners, shape (K,).
    id: identities of the corners, int64 of shape (K,).
    """

    _names = _KINDS

    _code: NDArray[np.uint8]
    normal: Reals
    area: Reals
    centre: Reals
    error: Reals
    pair: NDArray[np.int64]
    point_a: Reals
    point_b: Reals
    depth: Reals
    id: NDArray[np.int64]

    @property
    def kind(self) -> Strings:
        """Kinds of the patches, as of ContactPatch.kind, shape (M,); made at each access."""
        return self._names[self._code]

    def _summary(self) -> str:
        return f"{super()._summary()}; {len(self.pair)} corners"


def contact_patch(
    a: AnyBody,
    pose_a: _core.Pose,
    b: AnyBody,
    pose_b: _core.Pose,
    within: float = 0.0,
    *,
    tolerance: float = 0.01,
    max_points: int = 8,
) -> ContactPatch:
    """Returns the contact patch of two bodies along the normal of their distance.

    within: greatest gap (length) along the normal at which surfaces count as touching, 0 to 1e100. tolerance: accuracy
    of the outlines of curved surfaces, of the patch's diameter, 1e-4 to 0.5. max_points: largest number of corners, at
    least 3; those whose triangles are smallest are left out, the area is that of all.

    Boxes, polyhedra and half-spaces beside each other: exact, to 1e-13 of the size. Others: a polygon around the patch.
    Raises as distance.
    """
    at, columns = _core.contact_patch(a, pose_a, b, pose_b, within, tolerance, max_points)
    code, _, area, centre, error, _, point_a, point_b, depth, identity = columns
    return ContactPatch(
        at, str(_KINDS[code[0]]), float(area[0]), centre[0], float(error[0]), point_a, point_b, depth, identity
    )


def contact_patch_many(
    shapes: Shapes,
    positions: ArrayLike,
    quaternions: ArrayLike | RotationLike | None,
    pairs: ArrayLike,
    within: float = 0.0,
    shape_of: ArrayLike | None = None,
    threads: int = 1,
    *,
    tolerance: float = 0.01,
    max_points: int = 8,
) -> ContactPatches:
    """Returns the contact patches of M pairs among N bodies.

    within, tolerance, max_points: as for contact_patch. Other arguments, frames, units and exceptions are those of
    distance_many. The GIL is released.
    """
    return ContactPatches(
        *_core.contact_patch_many(
            shapes, positions, quaternions, pairs, within, shape_of, threads, tolerance, max_points
        )
    )
