"""A reduced body as a netCDF file: all that another program needs of it, with names, units and conventions.

A netCDF-4 file is an HDF5 file whose axes are dimension scales; it opens with xarray, MATLAB and others.
"""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from heavylift.modal.stiffening import PRODUCTS
from heavylift.pipeline.results.model_io import INTEGRAL_UNITS, replacing_hdf5
from heavylift.preprocess.hydrodynamics.netcdf_files import write_variables

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import ArrayLike, NDArray

    from heavylift.modal.reduced import Interface, ReducedBody

__all__ = ["FORMAT", "write_reduced_netcdf"]

FORMAT = "heavylift reduced body for other programs 1"

CONVENTIONS = {
    "equations": "q'' + 2 damping_ratio omega q' + eigenvalue q = modal force, besides the motion of the frame: the "
    "modal mass is the identity",
    "displacement": "of a node in the frame: sum over vectors of mode_shape times modal coordinate [kg^0.5 m]",
    "rotation": "small rotation vectors, likewise, in axes of the frame",
    "integrals": "k, l are axes: first_moment int x_k; modal_translation int phi_k; inertia_kl int x_k x_l; "
    "position_mode int x_k phi_l; mode_mode int phi_k phi_l, all by mass",
    "interfaces": "point, displacement and rotation of the place; interface_forces and interface_moments spread six "
    "unit loads (force x, y, z, moment x, y, z) over the nodes of the group, entry by entry",
    "stiffening": "geometric stiffness, added to the modal stiffness: stiffening_linear times acceleration of the "
    "frame minus gravity; stiffening_angular times angular acceleration; stiffening_loads times forces and moments; of "
    "an angular velocity w, with E = stiffening_second_moments: w^2 (E_11 + E_22 + E_33) - sum w_k w_l E_kl",
    "elements": "zero-based nodes in the order of VTK, by kind",
}
"""Attributes of the file."""

_UNITS = {
    "node_position": "m",
    "mode_shape": "kg^-0.5",
    "mode_rotation": "rad kg^-0.5 m^-1",
    "eigenvalue": "rad^2/s^2",
    "frequency": "Hz",
    "damping_ratio": "1",
    "residual": "1",
    "has_rotation": "1",
    "frame_origin": "m",
    "interface_point": "m",
    "interface_displacement": "kg^-0.5",
    "interface_rotation": "rad kg^-0.5 m^-1",
    "interface_captured_compliance": "1",
    "interface_of_entry": "1",
    "interface_node": "1",
    "interface_forces": "1, 1/m",
    "interface_moments": "m, 1",
    "stiffening_second_moments": "1",
    "stiffening_angular": "1",
    "stiffening_linear": "1/m",
    "stiffening_loads": "1/(N s^2), 1/(N m s^2)",
    **INTEGRAL_UNITS,
}


def write_reduced_netcdf(
    path: Path, body: ReducedBody, *, name: str, origin: ArrayLike, damping_ratio: NDArray[np.float64]
) -> None:
    """Write a body.

    Parameters
    ----------
    path
        Replaced in one step.
    body
        Reduced body.
    name
        Of the body.
    origin
        Of its frame in coordinates of its geometry [m].
    damping_ratio
        Of its vectors, of critical, shape (nf,).
    """
    space = ("axis",)
    axes: dict[str, Any] = {
        "axis": ["x", "y", "z"],
        "vector": list(body.labels),
        "node": np.arange(body.node_count),
    }
    variables: dict[str, tuple[tuple[str, ...], Any]] = {
        "frame_origin": (space, origin),
        "node_position": (("node", "axis"), body.nodes),
        "mode_shape": (("vector", "node", "axis"), body.mode_shapes),
        "mode_rotation": (("vector", "node", "axis"), body.mode_rotations),
        "has_rotation": (("node",), np.isin(np.arange(body.node_count), body.rotating).astype(np.int64)),
        "eigenvalue": (("vector",), body.eigenvalues),
        "frequency": (("vector",), body.frequencies),
        "damping_ratio": (("vector",), damping_ratio),
        "residual": (("vector",), body.residuals),
    }
    kl, of_modes = ("axis", "axis"), ("axis", "axis", "vector")
    along = {
        "mass": (),
        "first_moment": space,
        "modal_translation": ("axis", "vector"),
        "inertia_kl": kl,
        "position_mode": of_modes,
        "mode_mode": (*of_modes, "vector"),
    }
    variables |= {key: (along[key], value) for key, value in body.integrals._asdict().items()}
    if body.interfaces:
        _add_interfaces(axes, variables, body.interfaces)
    if body.stiffening is not None:
        axes["axes_of_second_moment"] = [f"{k + 1}{l + 1}" for k, l in PRODUCTS]
        square = ("vector", "vector")
        variables |= {
            "stiffening_second_moments": (
                ("axes_of_second_moment", *square),
                body.stiffening.second_moments,
            ),
            "stiffening_angular": (("axis", *square), body.stiffening.angular),
            "stiffening_linear": (("axis", *square), body.stiffening.linear),
        }
        if body.stiffening.labels:
            axes["stiffening_load"] = list(body.stiffening.labels)
            variables["stiffening_loads"] = (("stiffening_load", *square), body.stiffening.loads)
    units = dict(_UNITS)
    for kind, elements in _elements(body).items():
        axes |= {kind: np.arange(len(elements)), f"{kind}_corner": np.arange(elements.shape[1])}
        variables[f"{kind}_nodes"] = ((kind, f"{kind}_corner"), elements.astype(np.int64))
        units[f"{kind}_nodes"] = "1"
    with replacing_hdf5(path) as file:
        texts = {
            "Conventions": "CF-1.8",
            "title": FORMAT,
            "source": f"heavylift {metadata.version('heavylift')}",
            "body": name,
            "units": "SI",
            **CONVENTIONS,
        }
        for key, text in texts.items():
            file.attrs[key] = np.bytes_(text.encode())
        file.attrs["mean_axis"] = np.int32(body.mean_axis)
        write_variables(file, axes, variables, units)


def _add_interfaces(
    axes: dict[str, Any],
    variables: dict[str, tuple[tuple[str, ...], Any]],
    interfaces: dict[str, Interface],
) -> None:
    """Interfaces, and the nodes of their groups one after the other."""
    each = list(interfaces.values())
    sizes = [len(one.nodes) for one in each]
    axes |= {
        "interface": list(interfaces),
        "interface_entry": np.arange(sum(sizes)),
        "load": ["force x", "force y", "force z", "moment x", "moment y", "moment z"],
    }
    spread = ("interface_entry", "axis", "load")
    variables |= {
        "interface_point": (("interface", "axis"), [one.point for one in each]),
        "interface_displacement": (("interface", "vector", "axis"), [one.displacement for one in each]),
        "interface_rotation": (("interface", "vector", "axis"), [one.rotation for one in each]),
        "interface_captured_compliance": (("interface",), [one.captured for one in each]),
        "interface_of_entry": (("interface_entry",), np.repeat(np.arange(len(each)), sizes)),
        "interface_node": (("interface_entry",), np.concatenate([one.nodes for one in each])),
        "interface_forces": (spread, np.concatenate([one.forces for one in each])),
        "interface_moments": (spread, np.concatenate([one.moments for one in each])),
    }


def _elements(body: ReducedBody) -> dict[str, NDArray[np.int64]]:
    """Elements by kind."""
    if body.mesh is not None:
        return {body.mesh.element_type: body.mesh.elements}
    if body.structure is None:
        return {}
    parts: dict[str, list[NDArray[np.int64]]] = {}
    for shells in body.structure.shells:
        parts.setdefault(f"shell{shells.elements.shape[1]}", []).append(shells.elements)
    for beams in body.structure.beams:
        parts.setdefault("beam", []).append(beams.elements)
    for solids in body.structure.solids:
        parts.setdefault(solids.element_type, []).append(solids.elements)
    return {kind: np.concatenate(found) for kind, found in parts.items()}
