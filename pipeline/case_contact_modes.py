"""Tables of a case file for static vectors of contact, and the loads that they ask for."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field, StringConstraints, model_validator

from heavylift.pipeline.fields import LengthVector, Name, Positive, Section, reject

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from heavylift.pipeline.case import Case
    from heavylift.pipeline.storage import OutputFolder
    from heavylift.preprocess.model import FEModel

__all__ = ["ContactDirections", "ContactPatchSection", "contour_loads", "patch_load"]

ContactDirections = Annotated[str, StringConstraints(pattern="^(normal|x?y?z?)$", min_length=1)]
"""``"normal"``, or some of the letters x, y, z in this order."""


class ContactPatchSection(Section):
    """Where something may touch a flexible body: nodes of a face, or a smooth footprint on it."""

    on: Name
    """Group of the nodes of a face."""
    lower: LengthVector | None = Field(default=None, alias="from")
    """Corner of a box with the smallest coordinates [m]; nodes outside of the box are left out."""
    upper: LengthVector | None = Field(default=None, alias="to")
    """Corner of a box with the largest coordinates [m]."""
    centre: LengthVector | None = None
    """Centre of a disc on the face [m]; nodes farther than the radius are left out."""
    radius: Annotated[float, Positive("length")] | None = None
    """Radius R of the disc [m]."""
    footprint: bool = False
    """One load with the weight (1 - r^2/R^2)^2 over the disc, in place of one load a node."""
    directions: ContactDirections = "normal"
    """Along the outward normal of the face (default), or x, y, z: all three where friction acts."""

    @model_validator(mode="after")
    def _is_one_region(self) -> Self:
        for first, second in (("lower", "upper"), ("centre", "radius")):
            if (getattr(self, first) is None) != (getattr(self, second) is None):
                names = {"lower": "from", "upper": "to"}
                given, absent = (first, second) if getattr(self, second) is None else (second, first)
                given, absent = names.get(given, given), names.get(absent, absent)
                reject(f"{given!r} without {absent!r}", f"both, or a patch without {given!r}", key=absent)
        if self.lower is not None and self.upper is not None:
            if any(a > b for a, b in zip(self.lower, self.upper, strict=True)):
                reject(
                    f"corner {list(self.upper)} m",
                    f"no smaller than 'from' = {list(self.lower)} m in any direction",
                    key="to",
                )
            if self.footprint:
                reject("'from' and 'to' with 'footprint'", "'centre' and 'radius'", key="footprint")
        if self.footprint and self.radius is None:
            reject("'footprint' without a disc", "'centre' and 'radius'", key="footprint")
        return self


def patch_load(
    model: "FEModel",
    patch: ContactPatchSection,
    members: "NDArray[Any]",
    *,
    fixed_nodes: "Sequence[int] | NDArray[Any]" = (),
    key: str,
) -> Any:
    """Unit loads of a patch.

    Parameters
    ----------
    model
        Finite-element model.
    patch
        What to load.
    members
        Nodes of the group that the patch is on.
    fixed_nodes
        Clamped nodes.
    key
        Place of the patch in the case file, for messages.

    Returns
    -------
    Loads
        See `heavylift.modal.bases.Loads`.

    Raises
    ------
    InputError
        If the group is no face of the body, or the patch has no free node on it.
    """
    from heavylift.modal import contact_vectors
    from heavylift.modal.bases import Loads

    normal = patch.directions == contact_vectors.NORMAL
    faces = (
        contact_vectors.outer_faces(model, members, name=f"{key}.on") if normal or patch.footprint else None
    )
    if patch.footprint:
        assert faces is not None
        assert patch.centre is not None
        assert patch.radius is not None
        loads = contact_vectors.footprint_loads(
            model, faces, patch.centre, patch.radius, patch.directions, name=key
        )
    else:
        box = None if patch.lower is None or patch.upper is None else (patch.lower, patch.upper)
        disc = None if patch.centre is None or patch.radius is None else (patch.centre, patch.radius)
        nodes = contact_vectors.patch_nodes(model, members, box=box, disc=disc, name=key)
        normals = None if faces is None else contact_vectors.surface_normals(model, faces)
        loads = contact_vectors.contact_loads(
            model, nodes, patch.directions, normals=normals, fixed_nodes=fixed_nodes, name=key
        )
    word = f"{patch.on} footprint" if patch.footprint else patch.on
    return Loads(loads.forces, tuple(label.replace(key, word, 1) for label in loads.labels))


def contour_loads(
    case: "Case",
    body: str,
    model: "FEModel",
    folder: "OutputFolder",
    *,
    fixed_nodes: "Sequence[int] | NDArray[Any]" = (),
) -> list[Any]:
    """Unit loads on the nodes of all contours of a body, one set a contour.

    The control points of a contour follow its nodes, so that any contact force on it is a combination of these loads.

    Parameters
    ----------
    case
        The case.
    body
        Name of the body.
    model
        Its finite-element model.
    folder
        Output folder that holds the model.
    fixed_nodes
        Clamped nodes.

    Raises
    ------
    InputError
        If the body has no contour, or a contour no free node.
    """
    import numpy as np

    from heavylift.modal.contact_vectors import NORMAL, contact_loads, grid_normals
    from heavylift.numerics.outcome import InputError
    from heavylift.pipeline.assemble_contacts import contour_nodes
    from heavylift.pipeline.case_contours import SurfaceContourSection

    directions = case.bodies[body].modes.attach_directions  # type: ignore[union-attr]
    loads = []
    for name, contour in case.contours.items():
        if contour.body != body:
            continue
        nodes = contour_nodes(case, name, model.nodes, folder)
        chosen = directions or (NORMAL if nodes.ndim == 2 else "xyz")
        normals = None
        if chosen == NORMAL and isinstance(contour, SurfaceContourSection):
            normals = np.zeros((model.node_count, 3))
            normals[nodes] = grid_normals(model.nodes[nodes], contour.closed)
        loads.append(
            contact_loads(
                model, np.unique(nodes), chosen, normals=normals, fixed_nodes=fixed_nodes, name=name
            )
        )
    if not loads:
        raise InputError(
            f"no contour is of the body {body!r}",
            source=model.name,
            key="modes.attach",
            expected="a contour of this body, or 'patches' of its surface",
        )
    return loads
