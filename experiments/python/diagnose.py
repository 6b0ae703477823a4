#!/usr/bin/env python3
"""Fits an experiment, diagnoses it, and shows what was found with NumPy.

    python3 experiments/python/diagnose.py [EXPERIMENT [REFITS]]

The cells between the marks "# %%" can be run one by one in editors such as Spyder or VS Code.
"""

# %% Fit the model. Run again, this reads the finished run back.
import sys

import numpy as np

import lacuna

experiment = sys.argv[1] if len(sys.argv) > 1 else "experiments/hidden_effect.yaml"
refits = int(sys.argv[2]) if len(sys.argv) > 2 else None  # None: as many as lacuna diagnose
run = lacuna.fit(experiment)
model = run.model

# %% The parameters, in SI units: the value of the fit, the one with infinitely fine elements and
# time steps (blank: not computed), and the 95 % interval of the latter.
for parameter in model.parameters:
    limit = "" if parameter.at_limit is None else f"{parameter.at_limit:.4g}"
    print(f"{parameter.name:35} {parameter.value:11.4g} {limit:>11}   "
          f"{parameter.low:11.4g} to {parameter.high:11.4g} {parameter.unit}")

# %% The error of each recording, on frames that were fitted and on those that were not.
for recording in model.recordings:
    print(f"\n{recording.name}: {1e3 * recording.in_fit.rms:.3f} mm fitted, "
          f"{1e3 * recording.held_out.rms:.3f} mm held out "
          f"({recording.held_out.rms_over_sigma:.1f} times the noise)")

# %% When and where the model fails: predicted minus measured places of the points.
for number, recording in enumerate(model.recordings):
    motion = model.motion(number)
    length = np.linalg.norm(motion.predicted - motion.measured, axis=2)  # (frames, points), m
    frame, point = np.unravel_index(np.nanargmax(length), length.shape)
    print(f"{recording.name}: largest error {1e3 * length[frame, point]:.2f} mm, "
          f"point {point} at {motion.times[frame]:.2f} s")

# %% What the model lacks. This takes longer than the fit; Ctrl-C stops it, and the next call
# continues.
diagnosis = lacuna.diagnose(run, refits=refits).model.diagnosis
print(f"\n{diagnosis.verdict}: {', '.join(diagnosis.effects) or 'no effect is named'}")
for hypothesis in diagnosis.hypotheses[:3]:
    print(f"  {hypothesis.probability:6.1%}  {' and '.join(hypothesis.names) or 'nothing'}")
