"""Operations on tables of kinds, in Python and in compiled code, and what a kind has to have."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numba
import numpy as np
import pytest

from heavylift.numerics import objects
from heavylift.numerics.arrays import Arrays, Floats1
from heavylift.numerics.jit import kernel
from heavylift.numerics.objects import CompileError, entry, load_unit
from heavylift.numerics.sources import closure
from heavylift.solver.bodies.ancf.kind import FrameMeshes
from heavylift.solver.bodies.rigid.kind import RigidBodies
from heavylift.solver.compiling import all_units
from heavylift.solver.interface import Bodies, BodyKind, Workspace
from heavylift.solver.kinds import (
    Members,
    Table,
    generic,
    implement,
    import_kernels,
    kind_units,
    kinds_with_operations,
    method,
    optional,
)

compiled_only = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


class Things(Table):
    """Of these tests."""


class Heavy(Arrays):
    """All that has a mass."""

    mass: Floats1


class Weights(Heavy):
    """A weight."""


class Springs(Arrays):
    """A spring."""

    stiffness: Floats1
    stretch: Floats1


class Ghosts(Arrays):
    """Does nothing."""

    mass: Floats1


@generic()
def pull(kinds: Things, step: float, backwards: bool, total: Floats1) -> None:
    """Add all forces times the step, and leave a trace of the order."""


@optional()
def rest(kinds: Things, total: Floats1) -> None:
    """Whoever rests adds one."""


@implement(pull, Heavy)
@kernel(internal=True)
def pull_weights(kind: Heavy, step: float, backwards: bool, total: Floats1) -> None:
    for i in range(kind.mass.shape[0]):
        total[0] += (-step if backwards else step) * 10.0 * kind.mass[i]
    total[1] = 10.0 * total[1] + 1.0


@implement(pull, Springs)
@kernel(internal=True)
def pull_springs(kind: Springs, step: float, backwards: bool, total: Floats1) -> None:
    for i in range(kind.stiffness.shape[0]):
        total[0] += (-step if backwards else step) * kind.stiffness[i] * kind.stretch[i]
    total[1] = 10.0 * total[1] + 2.0


@implement(rest, Springs)
@kernel(internal=True)
def rest_springs(kind: Springs, total: Floats1) -> None:
    total[0] += 1.0


@optional("rare")
def shake(kinds: Things, total: Floats1) -> None:
    """An operation of a group that few tables serve."""


@implement(shake, Heavy)
@kernel(internal=True)
def shake_heavy(kind: Heavy, total: Floats1) -> None:
    total[0] += kind.mass.shape[0]


class Others(Table):
    """Another class of tables."""


@generic()
def push(kinds: Others, total: Floats1) -> None:
    """Has the place in its tables that `pull` has in those of things."""


@entry
def push_things(kinds: Things, total: Floats1) -> None:
    push(kinds, total)


@entry
def shake_compiled(kinds: Things, total: Floats1) -> None:
    shake(kinds, total)


@entry
def pull_compiled(kinds: Things, step: float, backwards: bool, total: Floats1) -> None:
    pull(kinds, step, backwards, total)


@entry
def rest_compiled(kinds: Things, total: Floats1) -> None:
    rest(kinds, total)


heavy = Members(Things, Heavy)


@entry
def weigh(kinds: Things) -> float:
    total = 0.0
    for i in range(heavy(kinds)):
        total += heavy(kinds, i).mass.sum()
    return total


@method("rare")
@kernel(internal=True)
def heaviest(kind: Heavy, least: float) -> float:
    for i in range(kind.mass.shape[0]):
        least = max(least, kind.mass[i])
    return least


WEIGHTS = Weights(np.array([1.0, 2.0]))
SPRINGS = Springs(np.array([4.0]), np.array([0.5]))


@pytest.mark.parametrize("call", [pull, pull_compiled], ids=["python", "compiled"])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize(
    ("kinds", "expected"),
    [
        ((), [0.0, 0.0]),
        ((WEIGHTS,), [3.0, 1.0]),
        ((SPRINGS, WEIGHTS), [3.2, 21.0]),
        ((WEIGHTS, SPRINGS, WEIGHTS), [6.2, 121.0]),
    ],
)
def test_every_kind_is_served_in_order(
    call: Any, kinds: tuple[Any, ...], expected: list[float], backwards: bool
) -> None:
    total = np.zeros(2)
    call(Things(kinds), 0.1, backwards, total)
    np.testing.assert_allclose(total, [-expected[0] if backwards else expected[0], expected[1]])


@pytest.mark.parametrize("call", [rest, rest_compiled], ids=["python", "compiled"])
def test_who_lacks_an_optional_verb_is_passed_over(call: Any) -> None:
    total = np.zeros(1)
    call(Things((WEIGHTS, SPRINGS, WEIGHTS, SPRINGS)), total)
    assert total[0] == 2.0


@compiled_only
def test_a_group_of_verbs_that_a_table_does_not_serve_is_never_passed_over_in_silence() -> None:
    total = np.zeros(2)
    table = Things((WEIGHTS, WEIGHTS), groups=["step"])
    pull_compiled(table, 0.1, False, total)
    with pytest.raises(RuntimeError, match="shake was called on a table that does not serve its group"):
        shake_compiled(table, total)
    table.need("rare")
    total[0] = 0.0
    shake_compiled(table, total)
    assert total[0] == 4.0
    shake_compiled(Things((SPRINGS,), groups=["step"]), total)  # nobody there has it
    assert total[0] == 4.0


@compiled_only
def test_a_verb_of_another_class_of_tables_does_not_compile() -> None:
    with pytest.raises(CompileError, match="push_things does not compile"):
        push_things(Things((WEIGHTS,)), np.zeros(2))


@compiled_only
def test_classes_are_checked_where_python_calls() -> None:
    with pytest.raises(TypeError, match="argument 1: Others, expected Things"):
        pull_compiled(Others(()), 0.1, False, np.zeros(2))
    with pytest.raises(TypeError, match="argument 1: Weights, expected Things"):
        pull_compiled(WEIGHTS, 0.1, False, np.zeros(2))


def test_a_second_version_of_a_verb_is_refused() -> None:
    with pytest.raises(TypeError, match="rest of Springs is there already: rest_springs"):
        implement(rest, Springs)(rest_springs)


def test_a_copy_has_memory_of_its_own() -> None:
    first = Weights(np.array([1.0]))
    assert weigh(Things((first,))) == 1.0
    second = copy.deepcopy(first)
    second.mass[0] = 5.0
    assert weigh(Things((second,))) == 5.0
    assert weigh(Things((first,))) == 1.0


@compiled_only
def test_every_kind_of_the_solver_has_the_verbs_that_it_must_have() -> None:
    assert len(all_units()) > 50  # an incomplete kind, or two of one name, are a TypeError


def test_a_method_of_a_base_serves_each_kind_of_it() -> None:
    assert heaviest(WEIGHTS, 0.5) == 2.0
    assert heaviest(WEIGHTS, 3.0) == 3.0


@compiled_only
def test_methods_are_compiled_with_the_verbs_of_their_group() -> None:
    assert {symbol.rpartition(".")[2] for symbol in kind_units(Weights)["rare"].entries} == {
        "shake",
        "heaviest",
    }


@compiled_only
def test_a_base_of_kinds_is_none_itself() -> None:
    assert {"FrameMeshes", "RowSystem3"} <= set(all_units())
    assert not {"Meshes", "RowSystem"} & set(all_units())


def test_members_of_a_base_are_found_in_kernels() -> None:
    assert weigh(Things((SPRINGS, WEIGHTS, WEIGHTS))) == 6.0
    assert weigh(Things(())) == 0.0


def test_a_kind_without_a_needed_verb_is_named() -> None:
    with pytest.raises(TypeError, match="pull is not implemented for Ghosts"):
        pull(Things((WEIGHTS, Ghosts(np.ones(1)))), 0.1, False, np.zeros(2))
    with pytest.raises(TypeError, match="pull is not implemented for Ghosts"):
        pull_compiled(Things((Ghosts(np.ones(1)),)), 0.1, False, np.zeros(2))


def test_a_kernel_with_other_parameters_than_its_verb_is_refused_at_import() -> None:
    with pytest.raises(TypeError, match="forgetful takes 2 arguments, pull"):

        @implement(pull, Ghosts)
        @kernel(internal=True)
        def forgetful(kind: Ghosts, step: float) -> None:
            pass


class Broken(Arrays):
    """Does not compile."""

    mass: Floats1


implement(pull, Broken)(pull_weights)


@implement(rest, Broken)
@kernel(internal=True)
def rest_broken(kind: Broken, total: Floats1) -> None:
    total[0] += kind.weight[0]


@compiled_only
def test_a_kernel_that_does_not_compile_is_named_with_file_and_line() -> None:
    with pytest.raises(
        CompileError, match=r"Broken: rest does not compile: .*test_kinds.py, line \d+: .*weight"
    ):
        load_unit(kind_units(Broken)["step"])


@pytest.mark.parametrize(
    ("mass", "found"),
    [
        (np.ones((2, 2)), "float64 2-d"),
        (np.ones(2, dtype=np.int64), "int64 1-d"),
        (np.ones(8)[::2], "float64 1-d"),
        ([1.0], "list"),
    ],
)
def test_arrays_that_kernels_would_misread_are_refused(mass: Any, found: str) -> None:
    with pytest.raises(TypeError, match=rf"Weights\.mass: {found}, expected a contiguous array"):
        _ = Weights(mass).address


def test_the_docstring_is_the_contract() -> None:
    assert pull.__name__ == "pull"
    assert "leave a trace" in (pull.__doc__ or "")


def test_a_unit_depends_on_versions_that_are_reached_through_declarations_alone() -> None:
    for unit in kind_units(FrameMeshes).values():
        assert "heavylift.solver.bodies.ancf.frame_elements" in closure(unit.modules)


@compiled_only
def test_the_file_of_a_unit_does_not_depend_on_the_order_of_imports() -> None:
    unit = kind_units(RigidBodies)["record"]
    turned = replace(unit, entries=dict(reversed(unit.entries.items())))
    assert list(turned.entries) != list(unit.entries)
    assert objects._place(turned) == objects._place(unit)


class Stones(BodyKind):
    """Bodies that cannot be moved before time starts."""

    mass: Floats1

    def survey(self, places: Any, inertia: Any, velocity: Any) -> None:
        """Nowhere."""

    def put_velocity(self, velocity: Any) -> None:
        """None."""

    def collect_load(self, work: Workspace, load: Any) -> None:
        """None."""


def test_a_kind_of_bodies_without_a_method_is_refused_by_name() -> None:
    made: Any = Stones
    with pytest.raises(TypeError, match=r"Stones.*move"):
        made(np.ones(1))
    with pytest.raises(TypeError, match="Weights among Bodies: expected a BodyKind"):
        Bodies((Weights(np.ones(1)),))


def test_bases_of_kinds_are_no_kinds() -> None:
    import_kernels(RigidBodies)
    known = kinds_with_operations()
    assert RigidBodies in known
    assert not any(issubclass(other, kind) for kind in known for other in known if other is not kind)


def test_a_verb_serves_a_single_kind_from_python_as_it_does_in_kernels() -> None:
    """An optional operation, too: what is no table must not be passed over as if it held nothing."""
    total = np.zeros(2)
    rest(Springs(np.ones(1), np.ones(1)), total)
    pull(Weights(np.ones(2)), 0.5, False, total)
    np.testing.assert_array_equal(total, [11.0, 1.0])
