"""Many scenes: a design of experiments over a scene, the responses of its runs, and their statistics."""

from dynamics.study.design import Design, Factor, Levels, Listed, Normal, Uniform
from dynamics.study.responses import QUANTITIES, Response, responses_of
from dynamics.study.run_study import Study, StudyTask, keep_runs, study, with_effects

__all__ = [
    "QUANTITIES",
    "Design",
    "Factor",
    "Levels",
    "Listed",
    "Normal",
    "Response",
    "Study",
    "StudyTask",
    "Uniform",
    "keep_runs",
    "responses_of",
    "study",
    "with_effects",
]
