"""A case in Python: made of components or read from a case file, changed, saved, run."""

from __future__ import annotations

import copy
import re
import shutil
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from heavylift.numerics.outcome import InputError
from heavylift.numerics.words import nearest
from heavylift.pipeline.case.case_file import CASE_FILE, Case, check_values, make_case, read_document
from heavylift.pipeline.case.overrides import REMOVED, assign, entry_index
from heavylift.pipeline.case.tables import TABLES
from heavylift.pipeline.equipment.builders import BUILDERS
from heavylift.pipeline.log import Log
from heavylift.pipeline.model.components import (
    TABLES_OF_CASE,
    CaseTable,
    Component,
    class_of_row,
    line_of_program,
    told,
)
from heavylift.pipeline.model.plain import plain
from heavylift.pipeline.results.provenance import files_of_case
from heavylift.pipeline.results.storage import replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from heavylift.pipeline.model.results import Run

__all__ = ["Model", "load"]

C = TypeVar("C", bound=Component)


class Model:
    """A scene with all that a case file says of it: components by name, the sea, the run, checks and criteria.

    Parameters
    ----------
    title
        One line that describes it.
    sources
        Where the numbers come from.
    folder
        Folder in which the files are that components name, such as meshes and databases; names are relative to it.

    Examples
    --------
    A load of 20 t hangs on a rope of 10 m; its tension is that of its weight:

    >>> import heavylift as hl
    >>> model = hl.Model("A load on a rope")
    >>> path = [{"body": "ground", "point": [0, 0, 10]}, {"body": "load", "point": [0, 0, 0]}]
    >>> gravity = model.add(
    ...     hl.Gravity(acceleration=[0, 0, -9.81]),
    ...     hl.RigidBody("load", mass="20 t", inertia=[1e4, 1e4, 1e4], frame={"motion": "free"}),
    ...     hl.Rope("hoist", path=path, axial_stiffness="50 MN"),
    ...     hl.Simulate(start="equilibrium", step="10 ms", duration="1 s", output_interval="0.1 s"),
    ... )
    >>> result = model.run()
    >>> print(f"{result['hoist.tension'][-1]:.1f} {result.unit('hoist.tension')}")
    196200.0 N
    """

    def __init__(self, title: str, *, sources: Sequence[str] = (), folder: Path | str = ".") -> None:
        self._document: dict[str, Any] = {"title": plain(title, "title")}
        if sources:
            self._document["sources"] = plain(list(sources), "sources")
        slug = re.sub(r"[^A-Za-z0-9]+", "_", str(title)).strip("_").lower()[:60] or "model"
        self._file = Path(folder) / f"{slug}.toml"
        self._text: str | None = None
        self._made_at = line_of_program()
        # components that the program holds, by the identity of their tables, which they keep alive
        self._held: dict[int, Component] = {}
        self._taken: dict[tuple[str, str], tuple[str, dict[str, Any]]] | None = None
        self._last: weakref.ref[Run] | None = None

    @property
    def title(self) -> str:
        """One line that describes it."""
        return str(self._document["title"])

    @title.setter
    def title(self, text: str) -> None:
        self._document["title"] = plain(text, "title")

    @property
    def folder(self) -> Path:
        """Folder of the files that it names."""
        return self._file.parent

    @property
    def document(self) -> dict[str, Any]:
        """A copy of what its case file has, as `tomllib` reads it; tables in the order of a case."""
        keys = ("title", "sources", "parameters", "repeat", *TABLES_OF_CASE)
        ordered = {key: self._document[key] for key in keys if key in self._document}
        return copy.deepcopy({**ordered, **self._document})

    def add(self, component: C, /, *more: Component) -> C:
        """Add components.

        Parameters
        ----------
        component, more
            Of the classes of this package. One that is in another model already is copied.

        Returns
        -------
        Component
            The first one, as it is in this model.

        Raises
        ------
        InputError
            If its name is taken, or it is no component.

        Examples
        --------
        >>> import heavylift as hl
        >>> model = hl.Model("Nothing moves")
        >>> model.add(hl.Gravity(acceleration=[0, 0, "-9.81 m/s^2"])).acceleration
        [0, 0, '-9.81 m/s^2']
        """
        found = self._add(component)
        for one in more:
            self._add(one)
        return found

    def _add(self, component: C) -> C:
        if not isinstance(component, Component) or type(component) is Component:
            kind = component.__name__ if isinstance(component, type) else type(component).__name__
            raise InputError(
                f"{component!r} is a {kind}",
                source=line_of_program(),
                key="Model.add",
                expected="a component such as heavylift.RigidBody(...) or heavylift.Rope(...)",
            )
        table, name = component.TABLE, component._own_name  # noqa: SLF001
        self._refuse_taken(component, table, name)
        if component._model is not None:  # noqa: SLF001
            component = component._copied()  # noqa: SLF001
        row = component._row  # noqa: SLF001
        if table.form == "single":
            self._document[table.key] = row
        elif table.form == "named":
            self._document.setdefault(table.key, {})[name] = row
        else:
            self._document.setdefault(table.key, []).append(row)
        object.__setattr__(component, "_model", self)
        self._held[id(row)] = component
        if name is not None:
            self._names()["" if table.shares else table.key, name] = (table.key, row)
        return component

    def _refuse_taken(self, component: Component, table: CaseTable, name: str | None) -> None:
        """Refuse a name, or a table, that is there."""
        if table.form == "single":
            if table.key in self._document:
                raise component._told(  # noqa: SLF001
                    InputError(
                        f"the model has its [{table.key}] already{self._where(self._document[table.key])}",
                        expected=f"one of them; change it, or remove it by Model.remove({table.key!r})",
                    )
                )
            return
        taken = self._names().get(("" if table.shares else table.key, name or ""))
        if taken is not None:
            key, row = taken
            raise component._told(  # noqa: SLF001
                InputError(
                    f"{name!r} is the name of a {class_of_row(key, row).__name__} already{self._where(row)}",
                    expected="another name",
                )
            )

    def _names(self) -> dict[tuple[str, str], tuple[str, dict[str, Any]]]:
        """Tables by their names: in a space that many share, or by the key of their table."""
        if self._taken is None:
            self._taken = {
                ("" if table.shares else table.key, name): (table.key, row)
                for table, name, row in self._entries()
                if name is not None
            }
        return self._taken

    def _where(self, row: Mapping[str, Any]) -> str:
        """Where the component of a table was made, in words."""
        held = self._held.get(id(row))
        return f", of {held._made_at}" if held is not None and held._made_at else ""  # noqa: SLF001

    def _entries(self) -> Iterator[tuple[CaseTable, str | None, dict[str, Any]]]:
        """Its tables: which table of a case, name, content."""
        for key, table in TABLES_OF_CASE.items():
            content = self._document.get(key)
            if content is None:
                continue
            if table.form == "single":
                yield table, None, content
            elif table.form == "named":
                yield from ((table, name, row) for name, row in content.items())
            else:
                yield from ((table, row.get(table.label), row) for row in content if isinstance(row, dict))

    def _component(self, table: CaseTable, name: str | None, row: dict[str, Any]) -> Component:
        held = self._held.get(id(row))
        if held is None:
            held = class_of_row(table.key, row)._of(row, name if table.form == "named" else None)  # noqa: SLF001
            object.__setattr__(held, "_model", self)
            self._held[id(row)] = held
        return held

    def __iter__(self) -> Iterator[Component]:
        """Its components, in the order of a case."""
        for table, name, row in list(self._entries()):
            yield self._component(table, name, row)

    def __len__(self) -> int:
        return sum(1 for _ in self._entries())

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and bool(self._found(name))

    def _found(self, name: str) -> list[tuple[CaseTable, str | None, dict[str, Any]]]:
        """Entries with a name: ``"hoist"``, ``"ropes.hoist"``, ``"simulate"``; those that channels are named by."""
        head, dot, own = name.partition(".")
        entries = list(self._entries())
        found = [entry for entry in entries if entry[1] == name]
        shared = [entry for entry in found if entry[0].shares]
        if dot and head in TABLES_OF_CASE:
            return [
                entry
                for number, entry in enumerate(one for one in entries if one[0].key == head)
                if entry[1] == own or (entry[0].form == "list" and own == str(number))
            ]
        return (
            shared
            or found
            or [entry for entry in entries if entry[0].form == "single" and entry[0].key == name]
        )

    def _one(self, name: str) -> tuple[CaseTable, str | None, dict[str, Any]]:
        found = self._found(name)
        if len(found) == 1:
            return found[0]
        paths = [self._path(table, own) for table, own, _ in found]
        if paths:
            raise InputError(
                f"{name!r} is the name of several", source=line_of_program(), expected=" or ".join(paths)
            )
        known = [own if own is not None else table.key for table, own, _ in self._entries()]
        near = nearest(name, known)
        hint = f"; did you mean {near!r}?" if near else ""
        raise InputError(
            f"{name!r} does not exist{hint}",
            source=line_of_program(),
            expected=f"one of: {', '.join(known) or 'none'}",
        )

    @staticmethod
    def _path(table: CaseTable, name: str | None) -> str:
        return table.key if name is None else f"{table.key}.{name}"

    def __getitem__(self, name: str) -> Component:
        """A component by name, by table and name (``"hulls.barge"``, ``"repeat.0"``), or by table (``"simulate"``)."""
        return self._component(*self._one(name))

    def remove(self, name: str) -> Component:
        """Take a component out; what refers to it stays, and is told by `case`.

        Parameters
        ----------
        name
            As for ``model[name]``.

        Raises
        ------
        InputError
            If there is none.
        """
        table, own, row = self._one(name)
        found = self._component(table, own, row)
        content = self._document[table.key]
        if table.form == "single":
            del self._document[table.key]
        elif table.form == "named":
            del content[own]
        else:
            content[:] = [one for one in content if one is not row]
        if table.form != "single" and not content:
            del self._document[table.key]
        object.__setattr__(found, "_model", None)
        self._taken = None
        return found

    def rename(self, name: str, new: str) -> Component:
        """Give a component another name, and what names it the same one: sides, paths, channels, quantities.

        Parameters
        ----------
        name
            As for ``model[name]``.
        new
            Its name from now on. Patterns of names (``"sling_*.tension"``) stay as they are.

        Raises
        ------
        InputError
            If there is no such component, the new name is taken or is none, or something would not fit afterwards;
            nothing is changed then.
        """
        table, own, row = self._one(name)
        component = self._component(table, own, row)
        if own is None:
            raise InputError(
                "has no name", source=line_of_program(), key=f"rename({name!r})", expected="one with a name"
            )
        self._refuse_taken(component, table, new)
        trial = self.copy()
        trial._rename(table, own, new)  # noqa: SLF001
        trial.case()
        self._rename(table, own, new)
        self._taken = None
        return self[self._path(table, new)]

    def _rename(self, table: CaseTable, old: str, new: str) -> None:
        """Rename a component, and all that names it, in place."""
        known = {name for _, name, _ in self._entries() if name is not None} - {old}
        ends = r"(?=[._]|$)" if table.key in BUILDERS else r"(?=\.)"  # what a builder writes is named by it
        place = rf"(?<![\w-])(?<!deviation\.){re.escape(old)}{ends}"
        if table.key == "reference":
            place = rf"(?<=deviation\.){re.escape(old)}(?![\w-])"

        def changed(found: re.Match[str]) -> str:
            word = re.match(r"[\w-]+", found.string[found.start() :])
            return found[0] if word is not None and word[0] in known else new

        def renamed(text: str) -> str:
            return new if text == old and table.key != "reference" else re.sub(place, changed, text)

        if table.shares or table.key in {*BUILDERS, "reference", "decks"}:  # others are named by nothing
            for other, _, row in list(self._entries()):
                label = {other.label: row[other.label]} if other.form == "list" and other.label in row else {}
                _rewrite(row, renamed)
                row.update(label)
        if table.form == "list":
            self._one(self._path(table, old))[2][table.label] = new
        content = self._document[table.key]
        if table.form == "named":
            held = self._held.get(id(content[old]))
            if held is not None:
                object.__setattr__(held, "_name", new)
            _rename_key(content, old, new)
        if table.key == "bodies":  # what is beside a body has its name
            for key, beside in TABLES.items():
                if beside.names == "bodies" and old in self._document.get(key, {}):
                    held = self._held.get(id(self._document[key][old]))
                    if held is not None:
                        object.__setattr__(held, "_name", new)
                    _rename_key(self._document[key], old, new)

    def set(self, key: str, value: Any) -> None:
        """Set a key as ``--set`` does.

        Parameters
        ----------
        key
            Dotted key as in the case file, ``"simulate.step"``; elements of lists by name or index,
            ``"ropes.hoist.length"``, ``"ropes.0.length"``.
        value
            A number in SI, a text with a unit, a list or a table; None removes the key.

        Raises
        ------
        InputError
            If the key leads nowhere, or the value cannot be right.
        """
        source, keys = line_of_program(), key.split(".")
        try:
            given = REMOVED if value is None else plain(value)
        except InputError as error:
            place = ".".join(filter(None, (key, error.key)))
            raise InputError(error.problem, source=source, key=place, expected=error.expected) from None
        trial = copy.deepcopy(self._document)
        places = assign(trial, keys, given, Case, f"{source}: Model.set").split(".")
        self._check_entry(trial, places, source)
        assign(self._document, keys, given, Case, source)
        self._taken = None
        name = ".".join(places[:1] if TABLES_OF_CASE.get(places[0], _TITLE).form == "single" else places[:2])
        if len(places) > 1 and name in self:
            self[name]._tell_line()  # noqa: SLF001

    @staticmethod
    def _check_entry(document: Mapping[str, Any], places: Sequence[str], source: str) -> None:
        """See that the table of a case in which a key was set can be right."""
        table, content = TABLES_OF_CASE.get(places[0]), document.get(places[0])
        if table is None or content is None:
            return
        part = {"named": dict, "list": list, "single": dict}[table.form]
        if not isinstance(content, part):
            expected = "a list of tables" if part is list else "a table"
            raise InputError(f"{content!r}", source=source, key=table.key, expected=expected)
        entries: Iterable[tuple[str | None, Any]] = [(None, content)]
        if isinstance(content, list):
            index = entry_index(content, places[1]) if len(places) > 1 else None
            entries = [(None, row) for row in (content if index is None else [content[index]])]
        elif table.form == "named":
            entries = [(name, row) for name, row in content.items() if len(places) < 2 or name == places[1]]
        for name, row in entries:
            if not isinstance(row, dict):
                place = table.key if name is None else f"{table.key}.{name}"
                raise InputError(f"{row!r} is not a table", source=source, key=place, expected="a table")
            made = class_of_row(table.key, row)._of(row, name)  # noqa: SLF001
            object.__setattr__(made, "_made_at", source)
            made._check()  # noqa: SLF001

    def copy(self) -> Model:
        """An independent model with the same content."""
        made = copy.deepcopy(self)
        made._last = self._last  # noqa: SLF001
        return made

    def __getstate__(self) -> dict[str, Any]:
        """What copies and pickles are made of: identities are others there."""
        return {**self.__dict__, "_held": list(self._held.values()), "_taken": None, "_last": None}

    def __setstate__(self, state: dict[str, Any]) -> None:
        held = {id(one._row): one for one in state["_held"]}  # noqa: SLF001
        self.__dict__.update({**state, "_held": held})

    def case(self) -> Case:
        """The case that it is, checked as one that is read from a file.

        Raises
        ------
        InputError
            One line for each thing that is wrong: line of the program, component and key.

        Examples
        --------
        >>> import heavylift as hl
        >>> model = hl.Model("A body that is held")
        >>> body = model.add(hl.RigidBody("load", mass=1, inertia=[1, 1, 1], frame={"motion": "fixed"}))
        >>> list(model.case().bodies)
        ['load']
        """
        document = self.document
        with told(self.located):
            check_values(document, self._file)
            return make_case(document, self._file)

    def located(self, error: InputError) -> InputError:
        """An error of its case at the component that the program made, or at the key of the case file."""
        if error.source not in {"", str(self._file)}:  # a file that the case names, or the output folder
            return error
        parts = error.key.split(".")
        table = TABLES_OF_CASE.get(parts[0])
        content: Any = self._document.get(parts[0])
        row, rest = content, parts[1:]
        if table is not None and table.form != "single" and rest:
            index = entry_index(content, rest[0]) if isinstance(content, list) else None
            row = (
                content[index]
                if index is not None
                else content.get(rest[0])
                if isinstance(content, dict)
                else None
            )
            rest = rest[1:]
        held = self._held.get(id(row))
        if held is not None and held._made_at:  # noqa: SLF001
            return held._told(error, ".".join(rest))  # noqa: SLF001
        source = error.source if self._text is not None else f"{self._made_at}: Model({self.title!r})"
        return InputError(error.problem, source=source, key=error.key, expected=error.expected)

    def save(self, path: Path | str, *, overwrite: bool = False) -> Path:
        """Write its case folder: ``case.toml``, and the files that it names.

        Parameters
        ----------
        path
            The case folder, which is made if it is not there; or a case file, ``"lift/other.toml"``.
        overwrite
            Whether files that are there already may be replaced.

        Returns
        -------
        Path
            The case file. Comments of a case that was loaded are kept.

        Raises
        ------
        InputError
            If the model is no sound case, or a file is there and must not be replaced.
        """
        from heavylift.pipeline.model.toml_text import case_text, changed_text

        case, document = self.case(), self.document
        file = Path(path) if Path(path).suffix == ".toml" else Path(path) / CASE_FILE
        copies = {
            file.parent / name: case.folder / name
            for name in sorted(files_of_case(case))
            if (file.parent / name).resolve() != (case.folder / name).resolve()
        }
        for target in () if overwrite else (file, *copies):
            if target.exists():
                raise InputError(
                    "is there already",
                    source=target,
                    expected="another folder, or overwrite=True to replace it",
                )
        text = case_text(document) if self._text is None else changed_text(self._text, document)
        try:
            for target, source in copies.items():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, target)
            file.parent.mkdir(parents=True, exist_ok=True)
            with replacing(file) as temporary:
                temporary.write_text(text, encoding="utf-8")
        except OSError as error:
            raise InputError(
                str(error.strerror or error),
                source=error.filename or file,
                expected="a folder that can be written",
            ) from None
        return file

    def run(self, *, out: Path | str | None = None, quiet: bool = True) -> Run:
        """Run it: mesh and modes as far as it needs them, and the simulation.

        Parameters
        ----------
        out
            Output folder that stays, from which an interrupted run goes on; by default a temporary folder that goes
            with the results.
        quiet
            Whether nothing is printed; if not, what the commands say.

        Returns
        -------
        Run
            Its results. A run that stops by itself has results up to there, and says so in ``outcome`` and ``message``.
            As long as they are there, another run takes their meshes and modes where its own would be the same, as it
            takes those in the folder of a case that was loaded.

        Raises
        ------
        InputError
            If something is wrong with the model.
        StopError
            If there is nothing to return: a stage before the simulation stopped.
        """
        from heavylift.pipeline.model.results import run_model

        case = self.case()
        last = None if self._last is None else self._last()
        before = [case.output_folder, *([] if last is None else [last.out])]
        reuse = [folder for folder in before if folder.is_dir()]
        run = run_model(case, self.located, out=out, log=Log(quiet=quiet), reuse=reuse)
        self._last = weakref.ref(run)
        return run

    def page(self) -> str:
        """The scene before its run as an interactive page, the text of one HTML file: names, markers, rope paths.

        Meshes and modes are made for it.

        Raises
        ------
        InputError
            If something is wrong with the model, or k3d is not installed.
        StopError
            If a stage stops by itself.
        """
        from heavylift.pipeline.model.results import start_page

        return start_page(self.case(), self.located)

    def _repr_html_(self) -> str:
        """The page in a cell of a notebook."""
        from heavylift.pipeline.model.results import in_cell

        return in_cell(self.page())

    def __repr__(self) -> str:
        return f"<Model {self.title!r}: {len(self)} components>"


_NO_NAMES = {"type", "motion", "law", "title", "sources", "source", "file", "folder", "note"}
"""Keys whose texts are no names of components."""
_OF_GROUPS = {"on", "clamp", "interface", "static_groups", "group", "groups"}
"""Keys whose texts are names of groups of nodes."""


def _rewrite(node: Any, changed: Callable[[str], str]) -> None:
    """Change the texts of tables and lists that may name components, in place."""
    pairs = list(node.items()) if isinstance(node, dict) else list(enumerate(node))
    for key, value in pairs:
        if key in _NO_NAMES or key in _OF_GROUPS:
            continue
        if isinstance(value, str):
            node[key] = changed(value)
        elif isinstance(value, (dict, list)):
            _rewrite(value, changed)


def _rename_key(table: dict[str, Any], old: str, new: str) -> None:
    """Rename a key in its place."""
    entries = [(new if key == old else key, value) for key, value in table.items()]
    table.clear()
    table.update(entries)


_TITLE = CaseTable("title", "single")
"""What is set where there is no table."""


def load(path: Path | str) -> Model:
    """Read a case as a model that can be changed.

    Parameters
    ----------
    path
        A case folder or a case file.

    Raises
    ------
    InputError
        Everything that is wrong with it.

    Examples
    --------
    >>> import heavylift as hl
    >>> model = hl.load("cases/hoist")
    >>> model["fall"].length, model["simulate"].step
    ('100 m', '10 ms')
    >>> model.set("ropes.fall.length", 101.0)
    >>> model.case().ropes[0].length
    101.0
    """
    file = Path(path)
    file = file / CASE_FILE if file.is_dir() else file
    model = Model("", folder=file.parent)
    model._document = read_document(file)  # noqa: SLF001
    model._file, model._text = file, file.read_bytes().decode("utf-8")  # noqa: SLF001
    model.case()
    return model
