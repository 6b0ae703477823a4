"""Starts the program `lacuna`, and turns the way it ends into exceptions."""

import json
import os
import re
import shutil
import signal
import subprocess
import tempfile
import warnings
from pathlib import Path

from ._installation import PREFIX
from ._records import InputError
from ._run import Run, open_run

_UNUSABLE_RESULT = 1
_UNUSABLE_INPUT = 2


class ProgramError(RuntimeError):
    """The program ended otherwise than by itself, for instance by a signal."""


def program() -> str:
    """The program: $LACUNA_PROGRAM, the one installed with this module, or the first in PATH."""
    given = os.environ.get("LACUNA_PROGRAM")
    if given:
        return given
    beside = os.path.normpath(Path(__file__).resolve().parent / PREFIX / "bin/lacuna")
    found = beside if os.access(beside, os.X_OK) else shutil.which("lacuna")
    if found is None:
        raise FileNotFoundError("the program lacuna is not in PATH; LACUNA_PROGRAM can name it")
    return found


def _run_program(arguments, progress) -> str:
    """Runs one command and returns what it printed.

    `progress` is called with a dict for each event that the program reports. Raises InputError,
    ProgramError, and KeyboardInterrupt after Ctrl-C, once the program has stopped where it can
    resume.
    """
    # A process group of its own: Ctrl-C reaches Python alone, which passes it on exactly once. A
    # second one would end the program before it has saved its work.
    with tempfile.TemporaryFile("w+") as printed:
        said = []
        with subprocess.Popen([program(), *map(str, arguments)], stdin=subprocess.DEVNULL,
                              stdout=printed, stderr=subprocess.PIPE, text=True,
                              process_group=0) as child:
            try:
                for line in child.stderr:
                    if line.startswith("{"):
                        if progress is not None:
                            progress(json.loads(line))
                    elif line.startswith("warning: "):
                        warnings.warn(line.removeprefix("warning: ").strip(), stacklevel=3)
                    else:
                        said.append(line)
                status = child.wait()
            except BaseException:  # KeyboardInterrupt, or an exception of `progress`
                child.send_signal(signal.SIGINT)
                child.communicate()
                raise
        printed.seek(0)
        text = printed.read()
    message = "".join(said).strip().removeprefix("lacuna: ")
    if status == _UNUSABLE_INPUT:
        raise InputError(message)
    if status == 128 + signal.SIGINT:
        raise KeyboardInterrupt
    if status not in (0, _UNUSABLE_RESULT):
        raise ProgramError(f"{' '.join(child.args)} ended with status {status}: {message}")
    return text


def _folder(run) -> Path:
    return run.folder if isinstance(run, Run) else Path(run)


def _report(wanted: bool) -> list[str]:
    return [] if wanted else ["--no-report"]


def fit(experiment, *, report=False, progress=None) -> Run:
    """Fits the model of an experiment, as `lacuna fit`.

    A fit that did not succeed is returned, too: `run.model.usable` is False then, and
    `run.model.message` says why. `report`: write the page for the browser as well.
    """
    printed = _run_program(["fit", experiment, *_report(report)], progress)
    written = re.search(r"^The run was written to (.*)$", printed, re.MULTILINE)
    if written is None:
        raise ProgramError(f"lacuna fit {experiment} did not say where it wrote the run")
    return open_run(written[1])


def compare(run, *, files_only=False, report=False, progress=None) -> Run:
    """Compares a fitted model with its recordings, as `lacuna compare`, and reads the run again."""
    options = ["--files-only"] if files_only else []
    _run_program(["compare", _folder(run), *options, *_report(report)], progress)
    return open_run(_folder(run))


def diagnose(run, *, refits=None, until_done=False, most=None, follow_best=False, report=False,
             progress=None) -> Run:
    """Finds the effect that a fitted model lacks, as `lacuna diagnose`, and reads the run again."""
    options = [] if refits is None else ["--refits", refits]
    options += ["--until-done"] if until_done else []
    options += [] if most is None else ["--most", most]
    options += ["--follow-best"] if follow_best else []
    _run_program(["diagnose", _folder(run), *options, *_report(report)], progress)
    return open_run(_folder(run))
