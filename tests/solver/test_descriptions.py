"""Descriptions: what is wrong with one is told when its file is read, and kernels are imported only for a run."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from dataclasses import MISSING, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pytest

from heavylift.numerics.outcome import InputError
from heavylift.numerics.quantity import Positive, Quantity
from heavylift.solver.scene.connections import FORCES, JOINTS, MEASURES, ROPES, Joint, Place, RopePoint, Winch
from heavylift.solver.scene.descriptions import (
    XYZ,
    ChannelKind,
    Family,
    _read,
    check_object,
    described_fields,
    known_channels,
)
from heavylift.solver.scene.moorings import MOORINGS
from heavylift.solver.scene.wind_loads import FLUID_LOADS

WORDS = (
    "ball",
    "cylindrical",
    "distance",
    "edge_clamp",
    "edge_hinge",
    "fixed",
    "hinge",
    "planar",
    "screw",
    "slider",
    "slider_hinge",
    "universal",
)


@dataclass(frozen=True, kw_only=True)
class Thing:
    name: str
    mass: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Hook:
    size: Annotated[float, Positive("length")]


SHELVES: Family[Any] = Family("shelf", "heavylift.solver.joints")


@SHELVES.part
@dataclass(frozen=True, kw_only=True)
class Box:
    """A box that weighs more than what is in it."""

    mass: Annotated[float, Positive("mass")] = 2.0
    """[kg]."""
    inside: Annotated[float, Positive("mass")] = 1.0
    """[kg]."""

    @staticmethod
    def check(spec: Any) -> None:
        """The box itself weighs something."""
        if spec.inside >= spec.mass:
            raise InputError("too heavy", key="inside", expected="less than 'mass'")


@SHELVES.part
@dataclass(frozen=True, kw_only=True)
class Layer:
    """A layer of boxes."""

    boxes: tuple[Box, ...] = ()
    """In a row."""
    stacks: tuple[tuple[Box, ...], ...] = ()
    """One upon the other."""


@SHELVES.describe("shelf")
@dataclass(frozen=True, kw_only=True)
class Shelf:
    """Layers of boxes."""

    name: str
    layers: tuple[Layer, ...]
    """From below."""


@pytest.mark.parametrize(("box", "wrong"), [(Box(mass=-1.0), "mass"), (Box(inside=3.0), "inside")])
@pytest.mark.parametrize("place", ["boxes.1", "stacks.0.1"])
def test_a_key_of_a_table_in_lists_of_lists_is_named(box, wrong, place):
    row = (Box(), box)
    layer = Layer(boxes=row) if place == "boxes.1" else Layer(stacks=(row,))
    with pytest.raises(InputError) as raised:
        check_object(Shelf(name="store", layers=(Layer(), layer)))
    assert raised.value.key == f"layers.1.{place}.{wrong}"


def family() -> Family[Thing]:
    return Family("thing", "heavylift.solver.joints")


def test_a_family_knows_all_its_files():
    assert set(WORDS) <= set(JOINTS.words)


@pytest.mark.parametrize("word", WORDS)
def test_every_joint_says_its_rows_and_channels(word):
    described = JOINTS.get(word)
    assert word == described.WORD
    assert described.__doc__
    assert described.PLACE is Place.EDGE or described.ROTATIONAL
    assert [channel.name for channel in described.CHANNELS[:2]] == ["reaction_force", "reaction_moment"]
    assert all(channel.sentence and channel.unit for channel in described.CHANNELS)


FAMILIES = {
    "connections.JOINTS": JOINTS,
    "connections.FORCES": FORCES,
    "connections.MEASURES": MEASURES,
    "connections.ROPES": ROPES,
    "moorings.MOORINGS": MOORINGS,
    "wind_loads.FLUID_LOADS": FLUID_LOADS,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FAMILIES)
def test_a_description_that_was_read_is_the_one_of_its_module(name):
    module, _, family = name.partition(".")
    code = (
        "import importlib\n"
        f"from heavylift.solver.scene.{module} import {family} as family\n"
        "from heavylift.solver.scene.connections import EdgeJoint\n"
        "for word in family.words:\n"
        "    read = family.get(word)\n"
        "    module = importlib.import_module(read.__module__)\n"
        "    assert getattr(module, read.__name__) is read, word\n"
        "    assert word.startswith('edge') == issubclass(read, EdgeJoint)\n"
        "print(len(family.words))\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(result.stdout) == len(FAMILIES[name].words)


def read(folder: Path, text: str) -> Family[Any]:
    """A family with one file."""
    (folder / "made.py").write_text("from __future__ import annotations\n" + textwrap.dedent(text))
    things: Family[Any] = Family("thing", "made_package")
    _read(folder / "made.py", f"made_{folder.name}")
    return things


HEAD = """
    from dataclasses import dataclass
    from typing import Annotated
    from heavylift.numerics.quantity import Quantity
    from heavylift.solver.scene.connections import FORCES, Between
"""


def test_what_a_description_refers_to_is_executed_and_nothing_else(tmp_path):
    text = (
        HEAD
        + """
    raise_if_executed = 1 / int("0") if "never" else None

    LOW, HIGH = 1.0, 2.0
    if HIGH > LOW:
        DEFAULT = LOW
    else:
        DEFAULT = HIGH
    DEFAULT += 0.5

    @FORCES.describe("made_of_parts")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Made(Between):
        \"\"\"Made.\"\"\"

        CHANNELS = ()
        length: Annotated[float, Quantity("length")] = DEFAULT
        \"\"\"Length [m].\"\"\"
    """
    )
    try:
        read(tmp_path, text)
        (field,) = described_fields(FORCES.get("made_of_parts"))
        assert field.default == 1.5
    finally:
        FORCES._members.pop("made_of_parts", None)


def test_a_base_beside_its_description_is_refused(tmp_path):
    """Imported again with the kernels it would be another class."""
    text = (
        HEAD
        + """
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Base(Between):
        pass

    @FORCES.describe("made_on_a_base")
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Made(Base):
        CHANNELS = ()
    """
    )
    with pytest.raises(TypeError, match=r"Base: what descriptions are made of stands in a module without"):
        read(tmp_path, text)


def test_descriptions_are_read_without_a_compiler():
    code = (
        "import sys\n"
        "from heavylift.solver.scene.connections import FORCES, JOINTS, ROPES\n"
        "from heavylift.solver.scene.moorings import MOORINGS\n"
        "from heavylift.solver.scene.wind_loads import FLUID_LOADS\n"
        "assert JOINTS.get('screw').__name__ == 'Screw'\n"
        "assert len(JOINTS.words) >= 12\n"
        "assert {'joint_spring', 'line_bearing', 'point', 'tugger'} <= set(FORCES.words)\n"
        "assert {'equalized', 'spring', 'wire'} <= set(ROPES.words)\n"
        "assert MOORINGS.words == ('fenders', 'lines')\n"
        "assert FLUID_LOADS.words == ('coefficients', 'drag')\n"
        "kernels = [n for n in sys.modules if n.rpartition('.')[2] in ('screw', 'wire_rope', 'mooring_lines')]\n"
        "print(sorted({'numba', 'scipy'} & set(sys.modules)), kernels)\n"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[] []"


def test_an_object_is_checked_as_a_case_file_is():
    path = (RopePoint("ground", np.zeros(3)), RopePoint("load", np.zeros(3)))
    rope = ROPES.get("wire")(name="fall", path=path, axial_stiffness=1e6)
    check_object(rope)
    pulley = RopePoint("ground", np.zeros(3), 0.2, np.array([1.0, 0.0, 0.0]))
    for wrong, message in (
        (replace(rope, axial_stiffness=-1.0), r"fall: axial_stiffness: -1\.0 is too small.*a force > 0 N"),
        (replace(rope, length=np.nan), r"fall: length: nan is not finite"),
        (replace(rope, path=(pulley, path[1])), r"fall: path\.0\.radius: a pulley at an end"),
        (replace(rope, path=(path[0], replace(pulley, radius=0.0))), r"fall: path\.1\.axis: 'axis' without"),
        (replace(rope, winch=Winch(np.zeros(2), np.zeros(2))), r"fall: winch\.times: times \[0\.0, 0\.0\]"),
    ):
        with pytest.raises(InputError, match=message):
            check_object(wrong)


def test_along_a_slider_a_stiffness_is_that_of_a_travel():
    spring = FORCES.get("joint_spring")(name="coil", joint="rail", stiffness=-1.0)
    with pytest.raises(InputError, match=r"coil: stiffness: .*a stiffness >= 0 N/m"):
        check_object(spring, "travel")
    with pytest.raises(InputError, match=r"coil: stiffness: .*an angular stiffness >= 0 N m/rad"):
        check_object(spring, "angle")


def test_flags_words_and_tables_need_no_quantity_but_numbers_do():
    things = family()

    things.part(Hook)

    @dataclass(frozen=True, kw_only=True)
    class Chain(Thing):
        hooks: tuple[Hook, ...] = ()
        open: bool = False
        side: Literal["left", "right"] = "left"

    made = things.describe("chain")(Chain)
    assert [field.name for field in described_fields(made)] == ["hooks", "open", "side"]

    @dataclass(frozen=True, kw_only=True)
    class Cord(Thing):
        lengths: tuple[float, ...] = ()

    with pytest.raises(TypeError, match=r"Cord\.lengths.*expected an annotation with its quantity"):
        things.describe("cord")(Cord)


def test_fields_are_keys_with_their_quantities():
    @dataclass(frozen=True, kw_only=True)
    class Rod(Thing):
        COUNT: ClassVar[int] = 1
        length: Annotated[float, Positive("length")]
        friction: Annotated[float | None, Quantity("force")] = None

    fields = {field.name: field for field in described_fields(family().describe("rod")(Rod))}
    assert set(fields) == {"length", "friction"}
    assert fields["length"].quantity == Positive("length")
    assert fields["length"].default is MISSING
    assert fields["friction"].default is None


def test_two_descriptions_with_one_word_are_refused():
    @dataclass(frozen=True, kw_only=True)
    class First(Thing):
        pass

    @dataclass(frozen=True, kw_only=True)
    class Second(Thing):
        pass

    things = family()
    things.describe("rod")(First)
    with pytest.raises(TypeError, match=r"thing 'rod' is described twice: .*First and .*Second"):
        things.describe("rod")(Second)


def test_a_channel_that_stands_twice_is_refused():
    @dataclass(frozen=True, eq=False, kw_only=True)
    class Doubled(Joint):
        CHANNELS: ClassVar = (*Joint.CHANNELS, Joint.CHANNELS[0])

    with pytest.raises(TypeError, match="Doubled: records reaction_force twice"):
        Family[Joint]("joint", "heavylift.solver.joints").describe("doubled")(Doubled)


def test_a_field_that_hides_one_of_the_base_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class Heavy(Thing):
        mass: Annotated[float, Quantity("mass")] = 1.0

    with pytest.raises(TypeError, match="Heavy: mass hides that of Thing"):
        family().describe("heavy")(Heavy)


def test_a_key_that_hides_one_of_where_a_joint_is_is_refused():
    from heavylift.pipeline.case.joints import joint_section

    @dataclass(frozen=True, eq=False, kw_only=True)
    class Placed(Joint):
        at: Annotated[float, Quantity("length")] = 0.0

    made = Family[Joint]("joint", "heavylift.solver.joints").describe("placed")(Placed)
    with pytest.raises(TypeError, match="at hides a key"):
        joint_section(made)


def test_a_field_without_unit_is_refused():
    @dataclass(frozen=True, kw_only=True)
    class Bare(Thing):
        length: float = 1.0

    with pytest.raises(TypeError, match=r"Bare\.length.*expected an annotation with its quantity"):
        family().describe("bare")(Bare)


def test_a_channel_has_a_known_quantity_and_a_sentence():
    with pytest.raises(TypeError, match="'weird': 'furlong'"):
        ChannelKind("weird", "furlong", "how far")
    with pytest.raises(TypeError, match="'silent'"):
        ChannelKind("silent", "length", "")
    with pytest.raises(TypeError, match=r"'angle' is a length .*elsewhere a angle"):
        ChannelKind("angle", "length", "how far")
    with pytest.raises(
        TypeError, match="channel 'angle' is one number in one place, and several in another one"
    ):
        ChannelKind("angle", "angle", "how far", None)
    with pytest.raises(TypeError, match="'loss' in N, expected another name for N m"):
        ChannelKind("loss", "moment or energy", "how much", unit="N")
    assert "loss" not in known_channels()


def test_a_channel_is_a_number_a_vector_or_what_the_scene_decides():
    assert ChannelKind("angle", "angle", "how far").columns() == ("angle",)
    assert ChannelKind("reaction_force", "force", "how hard", XYZ).columns() == XYZ
    nodes = ChannelKind("reaction_force", "force", "how hard", None)
    assert nodes.columns({"reaction_force": ("1", "2")}) == ("1", "2")
    assert ChannelKind("angle", "angle", "how far").unit == "rad"
    assert ChannelKind("reaction_moment", "moment or energy", "how hard", XYZ, unit="J").unit == "J"
