"""A scene linearised about its present state.

States are independent displacements z, along the exponential map from the state, and independent velocities w, both
coordinates of bodies (`coordinates`). With the accelerations a(q, U) of the constrained scene (`rates`)::

    z' = w - w0 x z  (of bodies that turn at w0, in their axes; else w),    w' = a(q(z), U(z, w))

Derivatives are central differences: bodies are displaced, joints closed again, velocities made to fit; ropes and
springs take their elongation from the geometry. Rates of their energy, and so geometric stiffness by the forces of
joints and ropes, are in them as the step has them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from heavylift.numerics.arrays import Arrays
from heavylift.numerics.outcome import InputError
from heavylift.numerics.records import Record
from heavylift.numerics.rotation import rotation_matrix
from heavylift.numerics.threads import one_blas_thread
from heavylift.numerics.words import nearest
from heavylift.solver.integrate.integration import Integration
from heavylift.solver.integrate.loop import write_record
from heavylift.solver.integrate.trees.forest import Forest
from heavylift.solver.interface import Systems
from heavylift.solver.kinds import Table
from heavylift.solver.linearise.coordinates import Independent
from heavylift.solver.linearise.drivers import Drivers
from heavylift.solver.linearise.memory_states import MemoryStates
from heavylift.solver.linearise.modes import find_modes
from heavylift.solver.linearise.motions import Motions
from heavylift.solver.linearise.rates import find_middle
from heavylift.solver.linearise.result import BodyShape, Linearisation
from heavylift.solver.linearise.served import check_open, check_served
from heavylift.solver.recorded_numbers import recorded_numbers
from heavylift.solver.start.rows import StartRows, quoted
from heavylift.solver.stop_message import stop_message

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from heavylift.solver.simulation import Simulation

__all__ = ["OutputColumns", "linearise", "output_columns"]

STEP, STEP_MOVING = 1e-7, 1e-5
"""Of the accelerations [s], with a half and a quarter of it; longer about a state that moves, where rounding of the
velocities counts."""

MOST = 1500
"""Coordinates: matrices are dense, and their eigenvalues take the third power of that."""

RESOLVED, SHORTEST = 2e-3, 1e-10
"""Step times the fastest eigenvalue, beyond which a shorter one is taken, and the shortest [s]: errors are its third
power."""

DIFFERENCE, DIFFERENCE_MOVING = 1e-6, 1e-4
"""Displacement of the difference quotients, relative to the size of the scene, or in radians; of both sorts of
states."""

NEAR = 10.0
"""Of the largest displacement: gap below which a contact counts as closed."""

MOVES = 1e-5
"""Velocity [m/s, rad/s] from which on a state moves."""

VELOCITY = 100.0
"""Velocity of the difference quotients over their displacement [1/s], about a state at rest."""

NO_STEP = {"fresh": 1, "started": 0, "paced": 0}
"""What carries its elongation and rates from step to step, as before its first one: it takes them from the geometry."""

EXTREMES = ("_max", "_min")
"""Ends of names of channels that hold extremes of a time, and have no derivative."""

HOLD = 1e-4
"""Part of the softness of rigid rows in a step that is left here."""

BALANCED = 1e-5
"""Acceleration relative to gravity that a state in balance may have left."""

WEAK = 0.1
"""Acceleration [m/s2] that stands for gravity where there is less."""

SLOWEST = 1e-4
"""Rate of an eigenvalue that is zero, relative to that of a pendulum as long as the scene."""

NOISE = 1e-10
"""Of a second difference of accelerations, by rounding: relative to those that act, and to the largest first one."""

ROUNDING = 1e-14
"""Of a velocity, in differences of several of them."""

ONE_SIDED = 1e-2
"""Second difference of the rates, relative to their first one, beyond which the rates have a corner at the state."""


@one_blas_thread
def linearise(
    simulation: Simulation,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    *,
    every: bool = False,
) -> Linearisation:
    """Linearise a scene about the present state of a run, which stays as it is, bit for bit.

    Parameters
    ----------
    simulation
        The run.
    inputs
        Names of inputs; all if None.
    outputs
        Names of outputs, ``OWNER.CHANNEL`` of all components or ``OWNER.CHANNEL.COMPONENT``; none if None.
    every
        Take all columns of a record in place of these, as for pictures of modes.

    Returns
    -------
    Linearisation
        Matrices and modes.

    Raises
    ------
    InputError
        If something of the scene has no linear motion, or a name is unknown.

    Examples
    --------
    A mass on a spring swings at ``sqrt(k/m) / (2 pi)``:

    >>> from heavylift.solver.forces.spring import Spring
    >>> from heavylift.solver.scene.connections import GROUND
    >>> from heavylift.solver.scene.scene import RigidBody, Scene
    >>> from heavylift.solver.simulation import Simulation
    >>> mass = RigidBody("mass", 50.0, np.eye(3), position=np.array([0.0, 0.0, 2.0]))
    >>> ends = {"body_a": GROUND, "point_a": np.zeros(3), "body_b": "mass", "point_b": np.zeros(3)}
    >>> spring = Spring(name="spring", **ends, length=2.0, stiffness=2000.0, damping=120.0)
    >>> found = linearise(Simulation(Scene((mass,), (spring,)), step=0.01))
    >>> print(found.words(-1))
    1.007 Hz, period 0.9935 s, damping 0.19: mass z 100 %
    >>> found.zeros
    10
    """
    check_served(simulation)
    names = [channel.name for channel in simulation.channels] if every else outputs
    columns = output_columns(simulation, names, extremes=every)
    simulation.warm_up()
    drivers = Drivers(simulation, inputs)
    kept = _Kept(simulation.layout)
    try:
        return _Probe(simulation, drivers).linearise(columns)
    finally:
        kept.put_back()
        if simulation.scene.touches:
            from heavylift.solver.contact.check_start import forget_trials

            forget_trials(simulation.layout)


class _Kept:
    """All arrays of a layout, to be put back."""

    def __init__(self, layout: Any) -> None:
        groups = (*layout.bodies, *layout.forces, *layout.joints, *layout.systems, layout.work)
        self._arrays = list({id(array): array for group in groups for array in _arrays(group)}.values())
        self._content = [array.copy() for array in self._arrays]

    def put_back(self) -> None:
        """As they were."""
        for array, content in zip(self._arrays, self._content, strict=True):
            array[...] = content


def _arrays(group: Any) -> Iterator[NDArray[Any]]:
    """All arrays of a group, and of the groups in it."""
    for value in group:
        if isinstance(value, Record):
            yield value.words
        elif isinstance(value, np.ndarray):
            yield value
        elif isinstance(value, Arrays | Table):
            yield from _arrays(value)


class OutputColumns(NamedTuple):
    """Columns of a record that are outputs: names, SI units, places."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    places: NDArray[np.int64]


def output_columns(
    simulation: Simulation, names: Sequence[str] | None, *, extremes: bool = False
) -> OutputColumns:
    """Of outputs by name, ``OWNER.CHANNEL.COMPONENT`` or a whole ``OWNER.CHANNEL``; none if None.

    Raises
    ------
    InputError
        If a name is unknown, or that of an extreme over a time, unless these are allowed.
    """
    every = recorded_numbers(simulation.channels)
    whole: dict[str, list[str]] = {}
    for name, one in every.items():
        whole.setdefault(one.channel, []).append(name)
    chosen: list[str] = []
    for name in names or ():
        if name not in every and name not in whole:
            near = nearest(name, (*every, *whole))
            raise InputError(
                f"no output {name!r}",
                source="linearisation",
                key="outputs",
                expected=f"{near!r}" if near else "OWNER.CHANNEL or OWNER.CHANNEL.COMPONENT",
            )
        channel_name = name if name in whole else name.rpartition(".")[0]
        if channel_name.endswith(EXTREMES) and not extremes:
            raise InputError(
                f"{name!r} is an extreme over a time",
                source="linearisation",
                key="outputs",
                expected=f"{channel_name[:-4]!r}",
            )
        chosen += [name] if name in every else whole[name]
    return OutputColumns(
        tuple(chosen),
        tuple(every[name].unit for name in chosen),
        np.array([every[name].column for name in chosen], dtype=np.int64),
    )


class _Probe:
    """Finds the rates of the states of a scene beside the present one."""

    def __init__(self, simulation: Simulation, drivers: Drivers) -> None:
        self._drivers = drivers
        self._layout = layout = simulation.layout
        self._time = simulation.time
        self._scene = simulation.scene
        self._gravity = float(np.linalg.norm(simulation.scene.gravity))
        self._channels = simulation.channels
        # trees of an integrator record what they have found in its own steps; rows record what was found here
        kinds = (one for one in layout.systems if not isinstance(one, Forest | Integration))
        systems = Systems(kinds, layout.systems.groups)
        tables = layout.bodies, layout.forces, layout.joints, systems, layout.work
        self._middle, self._record = find_middle.with_first(*tables), write_record.with_first(*tables)
        self._row = np.zeros(simulation.column_count)
        for array in (array for kind in (*layout.joints, *layout.forces) for array in _arrays(kind)):
            for name, value in NO_STEP.items():
                if name in (array.dtype.names or ()):
                    array[name] = value
        self._rows = rows = StartRows(layout, self._time)
        self._system = next((one for one in layout.systems if "monitor" in one._fields), None)
        if self._system is not None:
            self._system.rows["hold"][self._system.rows["rigid"] > 0.0] *= HOLD
        self._places = rows.survey()[0]
        self._motions = Motions(rows)
        if self._motions.count > MOST:
            raise InputError(
                f"{self._motions.count} coordinates that move",
                source="linearisation",
                key="scene",
                expected=f"at most {MOST}: coarser meshes, or bodies with modes",
            )
        self._velocity = self._motions.velocity
        moves = bool(np.abs(self._velocity).max(initial=0.0) > MOVES)
        spins = (first for first in self._motions.firsts if self._velocity[first + 3 : first + 6].any())
        self._spinning = list(spins)
        self._step = STEP_MOVING if moves else STEP
        self._difference = DIFFERENCE_MOVING if moves else DIFFERENCE
        self._size = self._extent()
        self._free = Independent(self._motions, self._turning(), self._size)
        if not self._free.chosen.size:
            raise InputError(
                "the joints leave no motion",
                source="linearisation",
                key="state",
                expected="something that moves freely",
            )
        self._free.close()
        self._kept = _Kept(layout)
        self._w = self._velocity[self._free.chosen]
        self._memory = MemoryStates(layout)
        self._m = self._memory.values

    def _extent(self) -> float:
        """Size of the scene [m]."""
        reach = max((float(kind.lengths()[1].max(initial=0.0)) for kind in self._layout.bodies), default=0.0)
        extent = float(np.ptp(self._places[:, 1:4], axis=0).max(initial=0.0)) + 2.0 * reach
        return extent if extent > 0.0 else 1.0

    def _turning(self) -> NDArray[np.bool_]:
        """Velocities of frames that spin."""
        found = np.zeros(self._motions.count, dtype=np.bool_)
        for first in self._motions.firsts:
            found[first + 3 : first + 6] = bool(np.any(np.abs(self._velocity[first + 3 : first + 6]) > MOVES))
        return found

    def _mean(self, values: NDArray[np.float64]) -> float:
        """Root of the mean square over the masses, of velocities or accelerations of all unknowns."""
        mass = sum(float(kind.lengths()[0].sum()) for kind in self._layout.bodies)
        squares = float(np.sum(self._motions.inertia * values * values))
        return math.sqrt(squares / mass) if mass > 0.0 else 0.0

    def _acceleration(self) -> NDArray[np.float64]:
        """Of all unknowns at the present state; reactions of the rows are those of it."""
        before = self._motions.velocity
        found = []
        for step in (self._step, 0.5 * self._step, 0.25 * self._step):
            self._middle(self._time, step)
            if self._layout.work.status.outcome != 0:
                raise InputError(
                    stop_message(self._layout, "beside the state"),
                    source="linearisation",
                    key="state",
                    expected="a state from which a step can be made",
                )
            found.append((self._motions.middle() - before) * (2.0 / step))
        if self._system is not None:
            self._system.rows["reaction"] = self._system.rows["impulse"] * (2.0 / step)
        return (8.0 * found[2] - 6.0 * found[1] + found[0]) / 3.0

    def _at(self, x: NDArray[np.float64], u: NDArray[np.float64]) -> NDArray[np.float64]:
        """Rates of the states at deviations of them and of the inputs, and the record there, one behind the other."""
        self._kept.put_back()
        motions, free, drivers, n = self._motions, self._free, self._drivers, len(self._w)
        z, w, places, m = np.split(x, [n, 2 * n, 2 * n + len(drivers.places)])
        increment = free.N @ z
        drivers.act(places, u)
        if z.any() or places.any():
            motions.move(increment)
            self._rows.start()
            free.close()
        free.put_velocity(self._w + w)
        self._memory.put(self._m + m)
        speed = motions.velocity - self._velocity
        for first in self._spinning:  # in axes that turn
            spin = self._velocity[first + 3 : first + 6]
            speed[first + 3 : first + 6] -= np.cross(spin, increment[first + 3 : first + 6])
        self._all = self._acceleration()
        chosen = free.chosen
        rates = [speed[chosen], self._all[chosen], drivers.speeds(u), self._memory.rates()]
        self._record(self._time, self._row)
        return np.concatenate([*rates, self._row])

    def linearise(self, columns: OutputColumns) -> Linearisation:
        """Differences by all states and inputs."""
        n, more, drivers = len(self._w), len(self._m), self._drivers
        count, given = 2 * n + len(drivers.places) + more, len(drivers.columns)
        steps = self._steps()
        rates = DIFFERENCE / self._difference * VELOCITY * np.maximum(1.0, np.abs(self._w))
        places = drivers.place_steps(self._difference, self._size)
        by_inputs = drivers.steps(self._weight(), self._size)
        scale = np.concatenate(
            [steps, rates * steps, places, np.full(more, self._difference * self._size), by_inputs]
        )
        nothing = np.zeros(count), np.zeros(given)
        if self._scene.touches:
            near = NEAR * self._difference * self._size
            check_open(self._scene, self._channels, self._at(*nothing)[count:], near)
        while True:
            base = self._at(*nothing)
            residual = self._mean(self._all)
            M = np.zeros((len(base), count + given))
            suspects = []
            for k in range(count):
                M[:, k], first, second = self._difference_by(k, scale, base)
                suspects.append(
                    tuple(float(np.abs(part / steps).max(initial=0.0)) for part in (first, second))
                )
            fastest = float(np.abs(np.linalg.eigvals(M[:count, :count])).max(initial=0.0))
            if self._is_short_for(fastest):
                break
        corners = self._corners(suspects, scale, base, steps)
        # speeds of inputs are differences of places over a step: the longer, the less they are rounded
        self._step = max(self._step, min(STEP_MOVING, RESOLVED / max(fastest, 1.0)))
        for k in range(count, count + given):
            M[:, k], _, _ = self._difference_by(k, scale, base)
        A, B, C, D = M[:count, :count], M[:count, count:], M[count:, :count], M[count:, count:]
        states, units = self._names()
        rate = math.sqrt(self._gravity / self._size) if self._gravity > 0.0 else 1.0
        sized = np.concatenate([steps, rate * steps, scale[count - more : count]]) / self._difference
        own = np.r_[: 2 * n, count - more : count]  # places of what is driven stay
        values, found, parts, zeros = find_modes(
            A[np.ix_(own, own)], sized, max(SLOWEST * rate, self._noise())
        )
        vectors = np.zeros((count, len(values)), dtype=np.complex128)
        vectors[own] = found
        vectors = self._normalised(C, vectors)
        shapes, participation = self._shapes(C, vectors)
        return Linearisation(
            time=self._time,
            A=A,
            B=B,
            C=C[columns.places],
            D=D[columns.places],
            states=states,
            state_units=units,
            inputs=tuple(drivers.columns),
            input_units=tuple(drivers.units),
            outputs=columns.names,
            output_units=columns.units,
            eigenvalues=values,
            vectors=vectors,
            zeros=zeros,
            shapes=shapes,
            participation=participation,
            water=parts[2 * n :].sum(axis=0),
            water_states=more,
            driven_states=len(drivers.places),
            residual=residual,
            speed=self._mean(self._velocity),
            warnings=self._warnings(residual, [states[k] for k in corners]),
        )

    def _weight(self) -> float:
        """A force that is large in the scene [N]."""
        mass = sum(float(kind.lengths()[0].sum()) for kind in self._layout.bodies)
        return mass * max(self._gravity, 1.0)

    def _is_short_for(self, fastest: float) -> bool:
        """Whether the step resolves an eigenvalue; else a shorter one is to be tried."""
        if fastest * self._step <= RESOLVED or self._step <= SHORTEST:
            return True
        self._step = max(RESOLVED / (2.0 * fastest), SHORTEST)
        return False

    def _difference_by(
        self, k: int, scale: NDArray[np.float64], base: NDArray[np.float64], part: float = 1.0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Derivatives by a state or input, and first and second differences of the accelerations."""
        deviation = np.zeros(len(scale))
        deviation[k] = step = part * scale[k]
        x, u = np.split(deviation, [len(scale) - len(self._drivers.columns)])
        ahead, behind = self._at(x, u), self._at(-x, -u)
        accelerations = slice(len(self._w), 2 * len(self._w))
        first, second = ahead - behind, ahead + behind - 2.0 * base
        return first / (2.0 * step), first[accelerations], second[accelerations]

    def _noise(self) -> float:
        """Rate [1/s] that rounding of velocities makes of an eigenvalue that is zero twice."""
        fastest = float(np.abs(self._velocity).max(initial=0.0))
        return math.sqrt(ROUNDING * fastest / (self._step * self._difference * self._size))

    def _corners(
        self,
        suspects: list[tuple[float, ...]],
        scale: NDArray[np.float64],
        base: NDArray[np.float64],
        steps: NDArray[np.float64],
    ) -> list[int]:
        """States with which accelerations change otherwise forwards than backwards.

        Second differences of what is smooth fall to a quarter with half of the displacement, those of a corner to a
        half.
        """
        largest = max((first for first, _ in suspects), default=0.0)
        noise = NOISE * (self._gravity / float(steps.min(initial=1.0)) + largest)
        found = []
        for k, (first, second) in enumerate(suspects):
            if second > ONE_SIDED * first + noise:
                half = float(np.abs(self._difference_by(k, scale, base, 0.5)[2] / steps).max())
                if abs(half / second - 0.5) < 0.1:
                    found.append(k)
        return found

    def _warnings(self, residual: float, bent: list[str]) -> tuple[str, ...]:
        """What limits the use of the result."""
        found = []
        if residual > BALANCED * max(self._gravity, WEAK):
            found.append(
                f"the state is not in balance: bodies accelerate by {residual:.3g} m/s2 in the mean over the"
                " masses, and deviations from the motion that follows are described, not from rest"
            )
        elif (speed := self._mean(self._velocity)) > MOVES:
            found.append(
                f"the state moves at {speed:.3g} m/s in the mean over the masses: the matrices are those of this"
                " instant"
            )
        if self._layout.controllers is not None:
            found.append("controllers of ballast leave their pumps as they are")
        if self._drivers.left_out:
            found.append(f"no columns of {quoted(self._drivers.left_out)}, which have no linear motion here")
        if bent:
            found.append(
                f"forces change otherwise forwards than backwards with {quoted(bent)}, as of a rope that is just"
                " slack or a stop that is just touched: the mean of both sides is taken"
            )
        return tuple(found)

    def _normalised(self, C: NDArray[np.float64], vectors: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Eigenvectors with a largest displacement or rotation of a body of 1 m or 1 rad, and real there."""
        shapes, _ = self._shapes(C, vectors)
        every = [part for shape in shapes.values() for part in (shape.displacement, shape.rotation)]
        if not every or not vectors.shape[1]:
            return vectors
        parts = np.vstack([part.reshape(len(part), -1).T for part in every])
        largest = parts[np.abs(parts).argmax(axis=0), np.arange(parts.shape[1])]
        return np.asarray(vectors / np.where(np.abs(largest) > 0.0, largest, 1.0))

    def _shapes(
        self, C: NDArray[np.float64], vectors: NDArray[np.complex128]
    ) -> tuple[dict[str, BodyShape], dict[str, NDArray[np.float64]]]:
        """Displacements of bodies in the modes, and their parts of the kinetic energy."""
        motions, z = self._motions, vectors[: len(self._w)]
        U = self._free.N @ z
        energy = motions.inertia[:, None] * np.abs(U) ** 2
        total = energy.sum(axis=0)
        total[total == 0.0] = 1.0
        energy /= total
        positions = {
            channel.name.removesuffix(".position"): slice(
                channel.column, channel.column + len(channel.components)
            )
            for channel in self._channels
            if channel.name.endswith(".position")
        }
        shapes, participation = {}, {}
        for number, name in enumerate(self._layout.body_names):
            moved = turned = np.zeros((3, z.shape[1]), dtype=np.complex128)
            own = np.flatnonzero(motions.owner == number)
            within = motions.within[own]
            if name in positions:
                moved = C[positions[name]] @ vectors
            spins = own[(within >= 3) & (within < 6)]
            if spins.size:
                turned = rotation_matrix(self._places[number, 4:8]) @ U[spins]
            parts = (within >= 0) & (within < 3), (within >= 3) & (within < 6), (within < 0) | (within >= 6)
            nodes = len(moved) // 3
            displacement = moved.T if nodes == 1 else moved.T.reshape(len(moved.T), nodes, 3)
            shapes[name] = BodyShape(displacement, turned.T)
            participation[name] = np.array([energy[own[part]].sum(axis=0) for part in parts]).T
        return shapes, participation

    def _steps(self) -> NDArray[np.float64]:
        """Displacement of the difference quotients by state."""
        chosen = self._free.chosen
        within, owner = self._motions.within[chosen], self._motions.owner[chosen]
        mass = np.zeros(len(self._places))
        for kind in self._layout.bodies:
            mass[kind.table["number"]] = kind.lengths()[0]
        steps = np.full(len(within), self._size)
        steps[(within >= 3) & (within < 6)] = 1.0
        modal = within >= 6
        steps[modal] = self._size * np.sqrt(mass[owner[modal]])
        return self._difference * steps

    def _names(self) -> tuple[tuple[str, ...], tuple[str, ...]]:
        """Of the states, and their units."""
        motions = self._motions
        places, speeds, units, rates = [], [], [], []
        for unknown in self._free.chosen.tolist():
            body, name, k = (
                self._layout.body_names[motions.owner[unknown]],
                motions.names[unknown],
                motions.within[unknown],
            )
            places.append(f"{body}.{name}")
            if k >= 6:
                speeds.append(f"{body}.{name.replace('position', 'velocity')}")
            elif 3 <= k < 6:
                speeds.append(f"{body}.{name.replace('rotation', 'angular_velocity')}")
            else:
                speeds.append(f"{body}.velocity.{name}")
            unit = "kg^(1/2) m" if k >= 6 else "rad" if 3 <= k < 6 else "1" if ".slope." in name else "m"
            units.append(unit)
            rates.append("1/s" if unit == "1" else f"{unit}/s")
        memory, driven = self._memory.names, self._drivers
        names = (*places, *speeds, *driven.places, *memory)
        return names, (*units, *rates, *driven.place_units, *("m" for _ in memory))
