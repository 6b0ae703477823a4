"""Runs of Lacuna as NumPy arrays, and the commands that make them.

    import lacuna
    run = lacuna.fit("experiments/hidden_effect.yaml")
    print(run.model.parameters)               # with units and 95 % intervals
    motion = run.model.motion(recording=0)
    error = motion.predicted - motion.measured  # (frames, points, 3), m
    print(lacuna.diagnose(run).model.diagnosis.verdict)

All numbers are in SI units. Finished runs are read by the code of Lacuna itself. `fit`, `compare`
and `diagnose` start the program `lacuna`, so that a computation can be stopped with Ctrl-C and
continues when it is called again.
"""

from ._program import ProgramError, compare, diagnose, fit, program
from ._records import (Diagnosis, Errors, Hypothesis, InputError, Model, Motion, Parameter,
                       Recording)
from ._records import version as __version__
from ._run import Run, open_run

__all__ = [
    "Diagnosis", "Errors", "Hypothesis", "InputError", "Model", "Motion", "Parameter",
    "ProgramError", "Recording", "Run", "compare", "diagnose", "fit", "open_run", "program",
]
