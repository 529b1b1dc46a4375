"""Runs and scenes of the program aligngs as numpy arrays.

    import aligngs

    scene = aligngs.Scene(images, intrinsics, poses, depths=depths)
    scene.write("scene")
    run = aligngs.run("scene", "run", "--preset", "preview")
    print(run.metrics["nvs"]["psnr"], run.gaussians.positions.shape)
"""
from .errors import (AlignGSError, BadInputError, BelowThresholdError, FailedError, ProgramMissingError, ResourcesError,
                     StoppedError, UsageError, WeightsError)
from .program import demo, find_program, follow_events, run
from .results import Camera, Gaussians, LabelClass, Labels, Mesh, Run
from .scene import Intrinsics, Points, Scene

__all__ = [
    "AlignGSError", "BadInputError", "BelowThresholdError", "Camera", "FailedError", "Gaussians", "Intrinsics", "LabelClass",
    "Labels", "Mesh", "Points", "ProgramMissingError", "ResourcesError", "Run", "Scene", "StoppedError", "UsageError",
    "WeightsError", "demo", "find_program", "follow_events", "run",
]
__version__ = "0.2.0"
