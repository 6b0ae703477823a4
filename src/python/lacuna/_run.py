"""A run: the folder that `lacuna fit` writes, with the models that belong to it."""

from dataclasses import dataclass
from pathlib import Path

from ._records import Model, open_models


@dataclass(frozen=True)
class Run:
    folder: Path
    # The model of this folder and those that `diagnose` or `lacuna add` made from it, each with one
    # effect more than the one before.
    models: list[Model]

    @property
    def model(self) -> Model:
        """The model of this folder."""
        for model in self.models:
            if model.folder.resolve() == self.folder.resolve():
                return model
        raise LookupError(f"{self.folder}: the run's own model is not among its models")


def open_run(folder) -> Run:
    """Reads a finished run. Raises InputError where the folder holds none or is damaged."""
    folder = Path(folder)
    return Run(folder, open_models(folder))
