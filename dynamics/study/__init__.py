"""Many scenes: a design of experiments over a scene, the responses of its runs, and their statistics."""

from dynamics.study.design import Design, Distribution, Factor, Levels, Listed, Normal, Uniform
from dynamics.study.responses import QUANTITIES, Response, responses_of
from dynamics.study.run_study import OneByOne, Scenes, Spread, Study, StudyTask, Workers, keep_runs, study

__all__ = [
    "QUANTITIES",
    "Design",
    "Distribution",
    "Factor",
    "Levels",
    "Listed",
    "Normal",
    "OneByOne",
    "Response",
    "Scenes",
    "Spread",
    "Study",
    "StudyTask",
    "Uniform",
    "Workers",
    "keep_runs",
    "responses_of",
    "study",
]
