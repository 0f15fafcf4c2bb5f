"""Off-screen rendering: surfaces become arrays of pixels, with whatever OpenGL the machine offers."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import field
from functools import cache
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from heavylift.numerics.children import NEUTRAL_FOLDER, python_command
from heavylift.numerics.classes import dataclass

if TYPE_CHECKING:
    from types import TracebackType

    from numpy.typing import NDArray

    from heavylift.pipeline.pictures.camera import Camera

__all__ = [
    "Drawing",
    "Lines",
    "Patch",
    "Points",
    "Renderer",
    "RenderingUnavailableError",
    "has_drawn",
    "rendering_backend",
    "rgb",
]

_REMEDY = (
    "no off-screen OpenGL: pictures need EGL or OSMesa with a software driver; "
    "on Debian or Ubuntu `apt-get install -y libegl1 libgl1-mesa-dri` "
    "(or `libosmesa6`), on Fedora `dnf install mesa-libEGL mesa-dri-drivers`"
)
# Without a library VTK does not raise, it crashes the process: so try it in another one first.
_PROBE = """
from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkRenderer
import vtkmodules.vtkRenderingOpenGL2
window = vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(16, 16)
window.AddRenderer(vtkRenderer())
window.Render()
print("backend", window.GetClassName())
"""


_FINER = (
    2  # rendered this much finer and averaged: smooth edges, which software drivers do not offer otherwise
)
# seen from the camera (right, up, towards it): one at the observer, one from above
_LIGHTS = (((0.1, 0.15, 1.0), 0.75), ((0.0, 1.0, 0.3), 0.3))


_OPENED: list[tuple[int, int]] = []
"""Sizes of the windows that this process has opened."""


def has_drawn() -> bool:
    """Whether this process has opened a window: drivers have threads from then on, and a copy would miss them."""
    return bool(_OPENED)


class RenderingUnavailableError(RuntimeError):
    """The machine cannot draw off screen; the message says which system libraries are missing."""


@cache
def rendering_backend() -> str:
    """Name of the VTK window class that draws off screen here, e.g. ``"vtkEGLRenderWindow"``.

    Tried in a child process, because VTK crashes instead of raising when no OpenGL library is there. The
    class found is chosen for this process too, so that VTK does not look for an X server.

    Raises
    ------
    RenderingUnavailableError
        Naming the packages to install.
    """
    variable = "VTK_DEFAULT_OPENGL_WINDOW"
    if sys.platform != "linux":
        return "platform default"
    given = os.environ.get(variable)
    for candidate in (given,) if given else ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow"):
        environment = {**os.environ, variable: candidate}
        try:
            probe = subprocess.run(  # noqa: S603
                python_command("-c", _PROBE),
                cwd=NEUTRAL_FOLDER,
                env=environment,
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
        except (OSError, subprocess.TimeoutExpired):
            continue
        if probe.returncode == 0 and f"backend {candidate}" in probe.stdout:
            os.environ[variable] = candidate
            return candidate
    raise RenderingUnavailableError(_REMEDY)


@dataclass(frozen=True, eq=False)
class Lines:
    """Line segments: ends, shape (n, 2), are indices into `points`, shape (m, 3)."""

    points: NDArray[np.float64]
    ends: NDArray[np.int64]
    colour: str = "#1d2733"
    width: float = 1.5
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class Points:
    """Marked points, shape (m, 3), drawn as small balls of `size` pixels."""

    points: NDArray[np.float64]
    colour: str = "#c62828"
    size: float = 8.0


@dataclass(frozen=True, eq=False)
class Patch:
    """Another surface in one colour, shapes (m, 3) and (nt, 3); seen through if its opacity is below 1."""

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    colour: str = "#b8c4d0"
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class Drawing:
    """What one picture shows, as plain data in the unit of `points`.

    Attributes
    ----------
    points, triangles
        The surface, shapes (m, 3) and (nt, 3); without triangles the points are drawn.
    values
        Colour field on the points, shape (m,); None for a plain colour.
    limits
        Values of the two ends of the colour map.
    colours
        Colours of equal bands between the limits, ``"#rrggbb"``.
    triangle_colours
        RGB of each triangle, shape (nt, 3) uint8, instead of `values`.
    lines, marks
        Drawn over the surface.
    normals
        Unit vectors on the points of a curved surface, shape (m, 3), which is then shaded smoothly; every triangle
        is shaded by itself if None.
    patches
        Surfaces without a colour field.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]
    values: NDArray[np.float64] | None = None
    limits: tuple[float, float] = (0.0, 1.0)
    colours: tuple[str, ...] = ()
    triangle_colours: NDArray[np.uint8] | None = None
    lines: tuple[Lines, ...] = ()
    marks: tuple[Points, ...] = field(default=())
    normals: NDArray[np.float64] | None = None
    patches: tuple[Patch, ...] = ()


class Renderer:
    """Draws `Drawing`s; one off-screen window a picture size, closed at the end of the ``with`` block.

    Raises
    ------
    RenderingUnavailableError
        On a machine without OpenGL.
    """

    def __init__(self) -> None:
        rendering_backend()
        self._plotters: dict[tuple[int, int], Any] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Release the windows."""
        for plotter in self._plotters.values():
            plotter.close()
        self._plotters.clear()

    def render(self, drawing: Drawing, camera: Camera, size: tuple[int, int]) -> NDArray[np.uint8]:
        """Pixels of a drawing on white, shape (height, width, 3).

        Parameters
        ----------
        drawing, camera
            In the same unit of length.
        size
            Width and height in pixels.
        """
        plotter = self._plotter((_FINER * size[0], _FINER * size[1]))
        plotter.clear_actors()
        self._add_surface(plotter, drawing)
        for patch in drawing.patches:
            if len(patch.triangles):
                plotter.add_mesh(
                    _poly_data(patch.points, triangles=patch.triangles),
                    color=patch.colour,
                    opacity=patch.opacity,
                    ambient=0.35,
                    diffuse=0.75,
                    reset_camera=False,
                    render=False,
                )
        span = float(np.linalg.norm(np.ptp(drawing.points, axis=0)))
        towards = np.asarray(camera.view.towards)
        for lines in drawing.lines:
            if len(lines.ends):
                plotter.add_mesh(
                    # lifted off the surface by a hair: lines and triangles at equal depth flicker
                    _poly_data(lines.points + 2.0e-3 * span * towards, lines=lines.ends),
                    color=lines.colour,
                    line_width=_FINER * lines.width,
                    opacity=lines.opacity,
                    lighting=False,
                    reset_camera=False,
                    render=False,
                )
        for marks in drawing.marks:
            if len(marks.points):
                plotter.add_mesh(
                    _poly_data(marks.points + 3.0e-3 * span * towards),
                    color=marks.colour,
                    point_size=_FINER * marks.size,
                    render_points_as_spheres=True,
                    style="points",
                    reset_camera=False,
                    render=False,
                )
        _aim(plotter, camera, drawing)
        plotter.render()
        fine = np.asarray(plotter.screenshot(return_img=True))[..., :3]
        parts = [fine[i::_FINER, j::_FINER].astype(np.uint16) for i in range(_FINER) for j in range(_FINER)]
        return (sum(parts[1:], parts[0]) // len(parts)).astype(np.uint8)

    def _plotter(self, size: tuple[int, int]) -> Any:
        import pyvista

        if size not in self._plotters:
            plotter = pyvista.Plotter(off_screen=True, window_size=list(size), lighting="none")
            plotter.set_background("white")
            plotter.disable_anti_aliasing()  # done by averaging
            plotter.render_window.SetMultiSamples(0)
            for position, intensity in _LIGHTS:
                light = pyvista.Light(position=position, intensity=intensity, light_type="camera light")
                plotter.add_light(light)
            self._plotters[size] = plotter
            _OPENED.append(size)
        return self._plotters[size]

    @staticmethod
    def _add_surface(plotter: Any, drawing: Drawing) -> None:
        body = _poly_data(drawing.points, triangles=drawing.triangles)
        if drawing.normals is not None:
            body.point_data.active_normals = drawing.normals
        look: dict[str, Any] = {"reset_camera": False, "render": False, "show_scalar_bar": False}
        if not len(drawing.triangles):
            look |= {"style": "points", "point_size": 7.0 * _FINER, "render_points_as_spheres": True}
        if drawing.triangle_colours is not None and len(drawing.triangles):
            body.cell_data["colour"] = drawing.triangle_colours
            plotter.add_mesh(body, scalars="colour", rgb=True, ambient=0.35, diffuse=0.75, **look)
        elif drawing.values is not None:
            body.point_data["value"] = drawing.values
            actor = plotter.add_mesh(
                body,
                scalars="value",
                clim=list(drawing.limits),
                cmap=list(drawing.colours),
                n_colors=len(drawing.colours),
                interpolate_before_map=True,
                ambient=0.66,  # much ambient light: a colour must be found again on the bar
                diffuse=0.4,
                **look,
            )
            if drawing.normals is not None:
                actor.prop.interpolation = "Phong"
        else:
            plotter.add_mesh(body, color="#b8c4d0", ambient=0.35, diffuse=0.75, **look)


def _aim(plotter: Any, camera: Camera, drawing: Drawing) -> None:
    matrix = camera.view.matrix
    # VTK wants a point to look at: any point on the axis of sight; take it at the depth of the part, or of what is
    # in front of the camera where most is behind it
    depths = (camera.position - drawing.points) @ matrix[2]
    depth = np.mean(depths) if np.mean(depths) > 0.0 else np.max(depths)
    vtk_camera = plotter.camera
    vtk_camera.position = tuple(camera.position)
    vtk_camera.focal_point = tuple(camera.position - depth * matrix[2])
    vtk_camera.up = tuple(matrix[1])
    vtk_camera.view_angle = float(np.degrees(2.0 * camera.half_angle))
    plotter.renderer.ResetCameraClippingRange()


def _poly_data(
    points: NDArray[np.float64],
    *,
    triangles: NDArray[np.int64] | None = None,
    lines: NDArray[np.int64] | None = None,
) -> Any:
    """Surface, segments or points as VTK wants them: each row of indices preceded by its length."""
    import pyvista

    if triangles is not None and len(triangles):
        return pyvista.PolyData.from_regular_faces(points, triangles)
    if lines is not None and len(lines):
        return pyvista.PolyData(points, lines=np.insert(lines, 0, 2, axis=1).ravel())
    return pyvista.PolyData(points)


def rgb(colour: str) -> NDArray[np.uint8]:
    """Red, green and blue of ``"#rrggbb"``, shape (3,)."""
    return np.frombuffer(bytes.fromhex(colour[1:]), dtype=np.uint8)
