"""What is written of coupled scenes: a file ``coupling.toml`` beside the folders of their cases."""

# Annotations are evaluated by pydantic, so the imports below are needed at run time.

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from heavylift.numerics.outcome import InputErrors
from heavylift.pipeline.case.case_file import check_values, read_document
from heavylift.pipeline.case.errors import input_errors
from heavylift.pipeline.case.fields import CaseContext, InFolder, Name, Positive, Section, reject
from heavylift.pipeline.coupling.master import Method

__all__ = ["COUPLING_FILE", "Coupling", "LinkSection", "SceneSection", "load_coupling"]

COUPLING_FILE = "coupling.toml"


class SceneSection(Section):
    """A scene: a case of its own, which need not know that it is coupled."""

    case: Annotated[str, InFolder(folder=True)]
    """Folder of its case."""
    set: tuple[str, ...] = ()
    """Changes of the case, as those of ``--set``."""
    process: Literal["same", "own", "served"] = "same"
    """``same``: it runs here; ``own``: in a process of its own, which is started and ended with the run; ``served``:
    where `heavylift serve` runs it, which has written `token_file`."""
    token_file: str | None = None
    """File that ``heavylift serve --token-file`` has written, of a scene that is served."""

    @model_validator(mode="after")
    def _is_somewhere(self) -> "SceneSection":
        served = self.process == "served"
        if (self.token_file is not None) != served:
            reject(
                f"{'no ' if served else ''}'token_file' with process {self.process!r}",
                "'token_file' of a scene that is served, and of no other one",
                key="token_file",
            )
        if served and self.set:
            reject("changes of a scene that is served", "them at its server", key="set")
        return self


class LinkSection(Section):
    """An output of a scene that is an input of another one: ``input = factor * output + offset``, in SI units."""

    output: str
    """``SCENE.OUTPUT``: name of the scene, and of a channel with its component."""
    input: str
    """``SCENE.INPUT``: name of the scene, and of one of its inputs."""
    factor: float = 1.0
    """By which the output is multiplied; -1 makes a reaction of an action."""
    offset: float | Literal["start"] = 0.0
    """That is added, in the SI unit of the input; ``start``: what makes the input keep its value at the start."""

    @model_validator(mode="after")
    def _names_both(self) -> "LinkSection":
        for key in ("output", "input"):
            scene, dot, name = getattr(self, key).partition(".")
            if not (scene and dot and name):
                reject(f"{getattr(self, key)!r}", "SCENE.NAME", key=key)
        return self

    @property
    def source(self) -> tuple[str, str]:
        """Scene and output."""
        scene, _, name = self.output.partition(".")
        return scene, name

    @property
    def target(self) -> tuple[str, str]:
        """Scene and input."""
        scene, _, name = self.input.partition(".")
        return scene, name


class ExchangeSection(Section):
    """When and how the scenes exchange what their links say."""

    method: Method = "iterated"
    """``held``: constant over an interval, first order; ``sequential``: scenes one after the other, first order;
    ``extrapolated``: with the rate over the last interval, second order; ``iterated``: the interval is repeated until
    both sides agree, second order."""
    interval: Annotated[float, Positive("time")]
    """Between exchanges [s], a multiple of the steps of all scenes."""
    duration: Annotated[float, Positive("time")] | None = None
    """[s]; the shortest of the scenes if absent."""
    tolerance: Annotated[float, Field(gt=0.0, lt=1.0)] = 1e-9
    """Of ``iterated``: largest misfit of a link, relative to the largest value that it has had."""


class Coupling(Section):
    """Scenes, what they exchange, and how."""

    title: str
    """One line that describes the whole."""
    sources: tuple[str, ...] = ()
    """Where the numbers come from."""
    scenes: dict[Name, SceneSection]
    """The scenes; the first is advanced first."""
    links: tuple[LinkSection, ...]
    """What they exchange."""
    exchange: ExchangeSection
    """When and how."""

    _file: Path = PrivateAttr(default=Path(COUPLING_FILE))

    @model_validator(mode="after")
    def _fits(self) -> "Coupling":
        if len(self.scenes) < 2:
            reject(f"{len(self.scenes)} scenes", "two or more", key="scenes")
        if not self.links:
            reject("no links", "one or more", key="links")
        taken: set[tuple[str, str]] = set()
        for index, link in enumerate(self.links):
            for key, (scene, _) in (("output", link.source), ("input", link.target)):
                if scene not in self.scenes:
                    reject(
                        f"there is no scene {scene!r}",
                        f"one of: {', '.join(self.scenes)}",
                        key=f"links.{index}.{key}",
                    )
            if link.source[0] == link.target[0]:
                reject(f"both ends are in {link.source[0]!r}", "two scenes", key=f"links.{index}.input")
            if link.target in taken:
                reject(
                    f"{link.input!r} has a link already",
                    "one link for each input",
                    key=f"links.{index}.input",
                )
            taken.add(link.target)
        return self

    @property
    def file(self) -> Path:
        """The file that it was read from."""
        return self._file

    @property
    def folder(self) -> Path:
        """Folder of that."""
        return self._file.parent


def load_coupling(path: Path | str, changes: dict[str, Any] | None = None) -> Coupling:
    """Read and check a file of coupled scenes.

    Parameters
    ----------
    path
        The file, or its folder.
    changes
        Values of [exchange] that replace those of the file.

    Raises
    ------
    InputError
        If the file is missing or is no TOML.
    InputErrors
        Everything that is wrong with its content.
    """
    file = Path(path)
    if file.is_dir():
        file = file / COUPLING_FILE
    document = read_document(file)
    check_values(document, file)
    if changes and isinstance(document.get("exchange"), dict):
        document = {**document, "exchange": {**document["exchange"], **changes}}
    try:
        made = Coupling.model_validate(document, context=CaseContext(file.parent))
    except ValidationError as error:
        raise InputErrors(input_errors(error, document, Coupling, file)) from None
    made._file = file  # noqa: SLF001
    return made
