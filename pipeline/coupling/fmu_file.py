"""What an .fmu of others says of itself, and whether it is one: read and checked before anything of it runs.

An .fmu is a zip with a model description and binaries (FMI 2.0.5, section 2.3; FMI 3.0.2, section 2.5). The
description is read by the package FMPy (``heavylift[fmi]``), which compares it with the schema of the standard.
"""

from __future__ import annotations

import re
import stat
import tempfile
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Dimension, describe_dimension, parse_unit

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["FmuFile", "FmuVariable", "fmpy_package", "read_fmu", "unit_factor", "unpack_fmu"]

LARGEST_CONTENT = 2 * 2**30
"""Bytes of an unpacked .fmu."""
LARGEST_DESCRIPTION = 64 * 2**20
"""Bytes of its model description."""
MOST_FILES = 50_000
REALS = {"Real": "Real", "Float64": "Float64", "Float32": "Float32"}
"""Types of variables that are exchanged, and the accessors of FMPy that carry them."""
WHOLE = {"Integer", "Enumeration", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64"}
_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")
_ENCODING = re.compile(
    rb"""(?:\xef\xbb\xbf)?\s*<(?:\?xml\b(?:[^>\0]*?\bencoding\s*=\s*["']([^"'\0]*)["'])?[^>\0]*>)?[^\0]*\Z"""
)
"""A text whose bytes are those of ASCII where they can be, and the encoding that it says."""
_READABLE = re.compile(rb"utf-?8|(?:us-)?ascii|iso-8859-\d+|windows-125\d", re.IGNORECASE)
"""Encodings in which they are; FMI has the first alone."""
_PURE = {"1", "-", "none"}
"""Names of units of pure numbers."""


@dataclass(frozen=True)
class FmuUnit:
    """A unit of an .fmu in the base units of SI: ``value [SI] = factor * value + offset``; dimension None: not defined.

    `others` tells that ampere, kelvin, mole or candela are in it.
    """

    name: str
    dimension: Dimension | None = None
    factor: float = 1.0
    offset: float = 0.0
    others: bool = False


@dataclass(frozen=True)
class FmuVariable:
    """A variable of an .fmu.

    Attributes
    ----------
    name, reference, type, causality
        As in its description; the reference is a number.
    unit
        None if it says none.
    scalar
        Whether it is no array.
    """

    name: str
    reference: int
    type: str
    causality: str
    unit: FmuUnit | None
    scalar: bool


@dataclass(frozen=True)
class FmuFile:
    """What is known of an .fmu before it runs.

    Attributes
    ----------
    path
        The file.
    version
        2 or 3.
    identifier, token
        Of its binary, and what it is instantiated with.
    gets_state, serializes, interpolates
        Whether it can get and set its state, write it as bytes, and take rates of inputs.
    fixed_step
        Its step [s] if it takes no other ones; 0 without.
    variables
        By name.
    """

    path: Path
    version: int
    identifier: str
    token: str
    gets_state: bool
    serializes: bool
    interpolates: bool
    fixed_step: float
    variables: Mapping[str, FmuVariable]


def fmpy_package() -> Any:
    """The package FMPy.

    Raises
    ------
    InputError
        If it is not installed.
    """
    try:
        import fmpy
    except ImportError:
        raise InputError(
            "the package fmpy is missing", source="fmus", expected="pip install 'heavylift[fmi]'"
        ) from None
    return fmpy


def _refuse(path: Path, problem: str, expected: str, key: str = "") -> InputError:
    return InputError(problem, source=path, key=key, expected=expected)


def _check_names(path: Path, archive: zipfile.ZipFile) -> set[str]:
    """See that what is in a zip stays below the folder into which it is unpacked; its names."""
    names: set[str] = set()
    size = 0
    if len(archive.infolist()) > MOST_FILES:
        raise _refuse(path, f"has {len(archive.infolist()):,} files", f"at most {MOST_FILES:,}")
    for entry in archive.infolist():
        name, size = entry.filename, size + entry.file_size
        inside = "a path of its own below the archive, with forward slashes"
        parts = PurePosixPath(name).parts
        if name.startswith("/") or "\\" in name or ":" in name or ".." in parts or "\0" in name or not parts:
            raise _refuse(path, "would be unpacked outside of its folder", inside, key=name)
        mode = entry.external_attr >> 16
        if stat.S_IFMT(mode) not in {0, stat.S_IFREG, stat.S_IFDIR}:
            raise _refuse(path, "is a link or a device", "files and folders", key=name)
        if name in names:
            raise _refuse(path, "occurs twice", "each file once", key=name)
        if entry.flag_bits & 1:
            raise _refuse(path, "is encrypted", "an archive without a password", key=name)
        names.add(name)
    if size > LARGEST_CONTENT:
        raise _refuse(path, f"has {size / 2**30:.1f} GiB unpacked", f"at most {LARGEST_CONTENT // 2**30} GiB")
    return names


def _check_binary(path: Path, names: set[str], version: int, identifier: str) -> None:
    """See that a binary for this machine is there."""
    fmpy = fmpy_package()
    folder = str(fmpy.platform if version == 2 else fmpy.platform_tuple)
    if f"binaries/{folder}/{identifier}{fmpy.sharedLibraryExtension}" in names:
        return
    there = sorted(
        {parts[1] for name in names if len(parts := PurePosixPath(name).parts) > 2 and parts[0] == "binaries"}
    )
    if folder in there:
        raise _refuse(
            path,
            "is missing",
            f"the binary of the model identifier {identifier!r}",
            key=f"binaries/{folder}/{identifier}{fmpy.sharedLibraryExtension}",
        )
    source = (
        "sources alone" if not there and any(name.startswith("sources/") for name in names) else "no binary"
    )
    raise _refuse(
        path,
        f"has binaries for {', '.join(there)}" if there else f"has {source}",
        f"one for this machine, in binaries/{folder}",
    )


def read_fmu(path: Path) -> FmuFile:
    """Read and check an .fmu without running anything of it.

    Raises
    ------
    InputError
        If it is no zip or one that leaves its folder, its description does not follow the standard, it is of FMI 1, or
        has no co-simulation or no binary for this machine; or if FMPy is not installed.
    """
    fmpy_package()
    try:
        with zipfile.ZipFile(path) as archive:
            names = _check_names(path, archive)
            if "modelDescription.xml" not in names:
                raise _refuse(path, "has no modelDescription.xml", "a functional mock-up unit")
            if archive.getinfo("modelDescription.xml").file_size > LARGEST_DESCRIPTION:
                raise _refuse(path, "has a description beyond 64 MiB", "a functional mock-up unit")
            damaged = archive.testzip()
            text = archive.read("modelDescription.xml") if damaged is None else b""
    except (zipfile.BadZipFile, OSError, NotImplementedError, EOFError, ValueError, zlib.error) as error:
        if isinstance(error, InputError):
            raise
        raise _refuse(
            path, f"is no zip file that can be read: {error}", "a functional mock-up unit"
        ) from None
    if damaged is not None:
        raise _refuse(path, "is damaged", "an archive whose checksums fit", key=damaged)
    return _described(path, _description(path, text), names)


def _description(path: Path, text: bytes) -> Any:
    """The model description, as FMPy reads it."""
    key, expected = "modelDescription.xml", "a description as the FMI standard has it"
    encoding = _ENCODING.match(text)
    if encoding is None or not (encoding[1] is None or _READABLE.fullmatch(encoding[1])):
        raise _refuse(
            path, "is not in UTF-8", expected, key=key
        )  # what is in it could not be seen before it is read
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:  # which may name files of this machine
        raise _refuse(path, "defines entities", expected, key=key)
    with tempfile.TemporaryDirectory(prefix="heavylift_fmu_") as folder:
        (Path(folder) / "modelDescription.xml").write_bytes(text)
        try:
            return fmpy_package().read_model_description(folder)
        except InputError:
            raise
        except Exception as error:  # noqa: BLE001  of lxml, of FMPy, of what it converts
            problems = getattr(error, "problems", None) or [str(error) or type(error).__name__]
            raise _refuse(path, str(problems[0]), expected, key=key) from None


def _described(path: Path, about: Any, names: set[str]) -> FmuFile:
    version = int(str(about.fmiVersion).partition(".")[0])
    if version not in {2, 3}:
        raise _refuse(path, f"is of FMI {about.fmiVersion}", "FMI 2.0 or 3.0")
    how = about.coSimulation
    if how is None:
        kinds = {"model exchange": about.modelExchange, "scheduled execution": about.scheduledExecution}
        only = " and ".join(name for name, one in kinds.items() if one is not None)
        raise _refuse(
            path, f"has {only or 'no interface'} only", "co-simulation, which brings its own solver"
        )
    identifier = str(how.modelIdentifier)
    if not _PLAIN.match(identifier):
        raise _refuse(path, f"model identifier {identifier!r}", "letters, digits and underscores")
    _check_binary(path, names, version, identifier)
    units = {unit.name: _unit(unit) for unit in about.unitDefinitions}
    fixed = 0.0
    if not how.canHandleVariableCommunicationStepSize and how.fixedInternalStepSize:
        fixed = float(how.fixedInternalStepSize)
    return FmuFile(
        path=path,
        version=version,
        identifier=identifier,
        token=str(about.guid),
        gets_state=bool(how.canGetAndSetFMUstate),
        serializes=bool(how.canGetAndSetFMUstate and how.canSerializeFMUstate),
        interpolates=bool(version == 2 and how.canInterpolateInputs),
        fixed_step=fixed,
        variables={one.name: _variable(one, units) for one in about.modelVariables},
    )


def _unit(unit: Any) -> FmuUnit:
    base = unit.baseUnit
    if base is None:
        return FmuUnit(unit.name)
    power = {name: int(getattr(base, name) or 0) for name in ("kg", "m", "s", "rad", "A", "K", "mol", "cd")}
    return FmuUnit(
        unit.name,
        Dimension(power["m"], power["kg"], power["s"], power["rad"]),
        float(base.factor),
        float(base.offset),
        others=any(power[name] for name in ("A", "K", "mol", "cd")),
    )


def _variable(one: Any, units: Mapping[str, FmuUnit]) -> FmuVariable:
    declared = one.declaredType.unit if one.declaredType is not None else None
    name = one.unit or declared
    return FmuVariable(
        name=one.name,
        reference=int(one.valueReference),
        type=str(one.type),
        causality=str(one.causality or "local"),
        unit=None if not name else units.get(name, FmuUnit(name)),
        scalar=not one.dimensions,
    )


def unit_factor(variable: FmuVariable, ours: str) -> float:
    """Factor from a value in a unit of heavylift to one of a variable.

    Parameters
    ----------
    variable
        A variable without a unit takes our number as it is.
    ours
        Unit of the channel or input, as in its name.

    Raises
    ------
    InputError
        If both measure different things, or the unit of the variable is not defined.
    """
    unit = variable.unit
    if unit is None:
        return 1.0
    scale, dimension = parse_unit(ours)
    if unit.dimension is None:
        if unit.name == ours or (unit.name in _PURE and ours in _PURE):
            return 1.0
        try:
            factor, own = parse_unit("1" if unit.name in _PURE else unit.name.replace(".", " "))
        except InputError:
            raise InputError(
                f"{variable.name!r} has the unit {unit.name!r}, which its description does not define",
                expected=f"a BaseUnit there, to compare it with {ours}",
            ) from None
        unit = FmuUnit(unit.name, own, factor)
    if unit.others or unit.dimension != dimension:
        what = "another quantity" if unit.others else describe_dimension(unit.dimension or Dimension())
        raise InputError(
            f"{variable.name!r} is in {unit.name}, {what}",
            expected=f"{describe_dimension(dimension)} [{ours}]",
        )
    if unit.offset:
        raise InputError(
            f"{variable.name!r} is in {unit.name}, which has an offset", expected=f"a multiple of {ours}"
        )
    return scale / unit.factor


def unpack_fmu(fmu: FmuFile, folder: Path) -> None:
    """Unpack an .fmu that has been read into an empty folder."""
    with zipfile.ZipFile(fmu.path) as archive:
        _check_names(fmu.path, archive)
        archive.extractall(folder)
