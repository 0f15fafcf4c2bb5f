"""What an .fmu of others says of itself, and whether it is one: read and checked before anything of it runs.

An .fmu is a zip with a model description and binaries or sources (FMI 2.0.5, section 2.3; FMI 3.0.2, section 2.5). It
may lie there unpacked too: then the file is its modelDescription.xml. The
description is read by the package FMPy (``heavylift[fmi]``), which compares it with the schema of the standard.
"""

from __future__ import annotations

import re
import shutil
import stat
import tempfile
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from heavylift.numerics.classes import dataclass
from heavylift.numerics.outcome import InputError
from heavylift.numerics.units import Dimension, describe_dimension, parse_unit
from heavylift.pipeline.coupling.compiler import c_compiler, compile_library

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = [
    "FmuFile",
    "FmuVariable",
    "fmpy_package",
    "read_fmu",
    "unit_factor",
    "unpack_fmu",
    "unpacked_files",
]

DESCRIPTION = "modelDescription.xml"
BUILD = "sources/buildDescription.xml"
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
        The file, or the modelDescription.xml of an unpacked one.
    version
        2 or 3.
    identifier, token
        Of its binary, and what it is instantiated with.
    gets_state, serializes, interpolates
        Whether it can get and set its state, write it as bytes, and take rates of inputs.
    fixed_step
        Its step [s] if it takes no other ones; 0 without.
    sources
        Sources that are to be compiled, below its folder ``sources``, with options; empty if it has a binary.
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
    sources: tuple[str, ...]
    variables: Mapping[str, FmuVariable]

    @property
    def title(self) -> str:
        """Name of the file, or of its folder."""
        return self.path.parent.name if self.path.name == DESCRIPTION else self.path.name

    @property
    def library(self) -> str:
        """Its binary for this machine, below its folder."""
        return _library(self.version, self.identifier)


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


def _library(version: int, identifier: str) -> str:
    """Where the binary for this machine is in an FMU."""
    fmpy = fmpy_package()
    folder = fmpy.platform if version == 2 else fmpy.platform_tuple
    return f"binaries/{folder}/{identifier}{fmpy.sharedLibraryExtension}"


def _sources(path: Path, names: set[str], version: int, about: Any) -> tuple[str, ...]:
    """Sources and options for the compiler; none if there is a binary for this machine.

    Raises
    ------
    InputError
        If there is neither.
    """
    identifier = str(about.coSimulation.modelIdentifier)
    library = _library(version, identifier)
    if library in names:
        return ()
    builds = [one for one in about.buildConfigurations if one.modelIdentifier == identifier]
    found: list[str] = []
    for part in builds[0].sourceFileSets if builds else ():
        for file in part.sourceFiles:
            if ".." in PurePosixPath(file).parts or f"sources/{file}" not in names or file.startswith("-"):
                raise _refuse(
                    path, "is missing", "a source that the description lists", key=f"sources/{file}"
                )
            found.append(file)
        definitions = {one.name: one.value for one in part.preprocessorDefinitions}
        found += [f"-D{name}={value}" if value else f"-D{name}" for name, value in definitions.items()]
    if found:
        c_compiler()
        return tuple(found)
    there = sorted(
        {parts[1] for name in names if len(parts := PurePosixPath(name).parts) > 2 and parts[0] == "binaries"}
    )
    folder = PurePosixPath(library).parent.as_posix()
    if folder.rpartition("/")[2] in there:
        raise _refuse(path, "is missing", f"the binary of the model identifier {identifier!r}", key=library)
    listed = any(name.startswith("sources/") for name in names)
    source = "sources that its description does not list" if not there and listed else "no binary"
    raise _refuse(
        path,
        f"has binaries for {', '.join(there)}" if there else f"has {source}",
        f"one for this machine, in {folder}",
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
    names, texts = _unpacked(path) if path.name == DESCRIPTION else _packed(path)
    return _described(path, _description(path, texts), names)


def _packed(path: Path) -> tuple[set[str], dict[str, bytes]]:
    """Names in an archive, and its descriptions."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = _check_names(path, archive)
            if DESCRIPTION not in names:
                raise _refuse(path, f"has no {DESCRIPTION}", "a functional mock-up unit")
            wanted = [name for name in (DESCRIPTION, BUILD) if name in names]
            if any(archive.getinfo(name).file_size > LARGEST_DESCRIPTION for name in wanted):
                raise _refuse(path, "has a description beyond 64 MiB", "a functional mock-up unit")
            damaged = archive.testzip()
            texts = {name: archive.read(name) for name in wanted} if damaged is None else {}
    except (zipfile.BadZipFile, OSError, NotImplementedError, EOFError, ValueError, zlib.error) as error:
        if isinstance(error, InputError):
            raise
        raise _refuse(
            path, f"is no zip file that can be read: {error}", "a functional mock-up unit"
        ) from None
    if damaged is not None:
        raise _refuse(path, "is damaged", "an archive whose checksums fit", key=damaged)
    return names, texts


def _unpacked(path: Path) -> tuple[set[str], dict[str, bytes]]:
    """Names in the folder of an unpacked FMU, and its descriptions."""
    files = unpacked_files(path.parent)
    wanted = {name: files[name] for name in (DESCRIPTION, BUILD) if name in files}
    if any(file.stat().st_size > LARGEST_DESCRIPTION for file in wanted.values()):
        raise _refuse(path, "has a description beyond 64 MiB", "a functional mock-up unit")
    return set(files), {name: file.read_bytes() for name, file in wanted.items()}


def unpacked_files(folder: Path) -> dict[str, Path]:
    """Files of an unpacked FMU by their names in it, but hidden ones.

    Raises
    ------
    InputError
        If one leads out of the folder, or there are too many.
    """
    found: dict[str, Path] = {}
    size, root = 0, folder.resolve()
    for file in sorted(folder.rglob("*")):
        parts = file.relative_to(folder).parts
        if not file.is_file() or any(part.startswith(".") for part in parts):
            continue
        if not file.resolve().is_relative_to(root):
            raise _refuse(file, "leads out of the folder of the FMU", "files inside of it")
        size += file.stat().st_size
        if len(found) >= MOST_FILES or size > LARGEST_CONTENT:
            raise _refuse(
                folder, "is no unpacked FMU: it has too many or too large files", "its folder alone"
            )
        found["/".join(parts)] = file
    return found


def _description(path: Path, texts: Mapping[str, bytes]) -> Any:
    """The model description, as FMPy reads it."""
    expected = "a description as the FMI standard has it"
    for name, text in texts.items():
        encoding = _ENCODING.match(text)
        if encoding is None or not (encoding[1] is None or _READABLE.fullmatch(encoding[1])):
            # what is in it could not be seen before it is read
            raise _refuse(path, "is not in UTF-8", expected, key=name)
        if b"<!DOCTYPE" in text or b"<!ENTITY" in text:  # which may name files of this machine
            raise _refuse(path, "defines entities", expected, key=name)
    with tempfile.TemporaryDirectory(prefix="heavylift_fmu_") as folder:
        for name, text in texts.items():
            file = Path(folder) / name
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(text)
        try:
            return fmpy_package().read_model_description(folder)
        except InputError:
            raise
        except Exception as error:  # noqa: BLE001  of lxml, of FMPy, of what it converts
            problems = getattr(error, "problems", None) or [str(error) or type(error).__name__]
            raise _refuse(path, str(problems[0]), expected, key=DESCRIPTION) from None


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
    sources = _sources(path, names, version, about)
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
        sources=sources,
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
    """Unpack an FMU that has been read into an empty folder, and compile it if it has sources alone.

    Raises
    ------
    InputError
        If it does not compile.
    """
    if fmu.path.name == DESCRIPTION:
        for name, file in unpacked_files(fmu.path.parent).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, folder / name)
    else:
        with zipfile.ZipFile(fmu.path) as archive:
            _check_names(fmu.path, archive)
            archive.extractall(folder)
    if fmu.sources:
        library = folder / fmu.library
        library.parent.mkdir(parents=True, exist_ok=True)
        headers = str(Path(str(fmpy_package().__file__)).parent / "c-code")  # those of the standard
        compile_library(["-I", ".", "-I", headers, *fmu.sources], library, folder / "sources")
