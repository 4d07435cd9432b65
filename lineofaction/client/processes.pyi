# Written by scripts/client_types.py from lineofaction.gearbox.registry: do not edit.
# fmt: off
# ruff: noqa: E501 (a line for each parameter)
from collections.abc import Callable, Sequence
from typing import Any, Concatenate, Literal, ParamSpec, TypeVar

from dynamics.ablation import Ablation as DynamicsAblation
from dynamics.accuracy import Frontier as DynamicsFrontier
from dynamics.linearize.forced_response import ForcedResponse as DynamicsForcedResponse
from dynamics.linearize.modal_analysis import ModalAnalysis as DynamicsModalAnalysis
from dynamics.noise.radiated_sound import RadiatedSound as DynamicsRadiatedSound
from dynamics.periodic.steady_states import SteadyStates as DynamicsSteadyStates
from dynamics.results import RunResult
from dynamics.study.run_study import Study as DynamicsStudy
from fe_contact.analysis.flanks.load_distribution import LoadDistribution as FeContactLoadDistribution
from fe_contact.analysis.studies.ablation import Ablation as FeContactAblation
from fe_contact.analysis.studies.frontier import Frontier as FeContactFrontier
from fe_contact.microgeometry.optimization import Optimization as FeContactOptimization
from fe_contact.microgeometry.tolerance_study import ToleranceStudy as FeContactToleranceStudy
from fe_contact.ste import SteDatabase
from lineofaction.client.process import Offered
from lineofaction.client.surface import Surface
from lineofaction.gearbox.schemas.figures import Figures, RunFigures, TableFigures
from lineofaction.gearbox.studies.ablate import AblationFigures as GearboxAblationFigures
from lineofaction.gearbox.studies.deflect import DeflectionFigures as GearboxDeflectionFigures
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection as GearboxGearboxDeflection
from lineofaction.gearbox.studies.flank import FlankFigures as GearboxFlankFigures
from lineofaction.gearbox.studies.frontier import FrontierFigures as GearboxFrontierFigures
from lineofaction.gearbox.studies.listen import RecordingFigures as GearboxRecordingFigures
from lineofaction.gearbox.studies.listen.heard_run import HeardRun as GearboxHeardRun
from lineofaction.gearbox.studies.modes import ModesFigures as GearboxModesFigures
from lineofaction.gearbox.studies.noise import NoiseFigures as GearboxNoiseFigures
from lineofaction.gearbox.studies.optimize import OptimizationFigures as GearboxOptimizationFigures
from lineofaction.gearbox.studies.response import ResponseFigures as GearboxResponseFigures
from lineofaction.gearbox.studies.root_stress import RootStressFigures as GearboxRootStressFigures
from lineofaction.gearbox.studies.root_stress.run import Roots as GearboxRoots
from lineofaction.gearbox.studies.scatter import ScatterFigures as GearboxScatterFigures
from lineofaction.gearbox.studies.sensitivity import SensitivityFigures as GearboxSensitivityFigures
from lineofaction.gearbox.studies.sensitivity.run import PairStudy as GearboxPairStudy
from lineofaction.gearbox.studies.steady import SteadyFigures as GearboxSteadyFigures
from lineofaction.gearbox.studies.study import StudyFigures as GearboxStudyFigures
from lineofaction.gearbox.studies.sweep import SweepFigures as GearboxSweepFigures
from lineofaction.gearbox.studies.sweep.run import SweepResult as GearboxSweepResult
from lineofaction.gearbox.studies.vibration import VibrationFigures as GearboxVibrationFigures
from lineofaction.gearbox.studies.vibration.run import HousingVibrationResult as GearboxHousingVibrationResult
from lineofaction.gearbox.subjects import CaseLike, SceneLike, StudyLike

P = ParamSpec("P")
T = TypeVar("T")
F = TypeVar("F", bound=Figures)

def _offered(figures: type[F]) -> Callable[[Callable[Concatenate[Any, P], T]], Offered[P, T, F]]: ...

class Processes(Surface):
    @_offered(TableFigures)
    def analyze(self, case: CaseLike) -> SteDatabase: ...
    @_offered(RunFigures)
    def simulate(self, scene: SceneLike) -> RunResult: ...
    @_offered(GearboxFlankFigures)
    def flank(
        self,
        case: CaseLike,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> FeContactLoadDistribution: ...
    @_offered(GearboxAblationFigures)
    def ablate(
        self,
        given: CaseLike | SceneLike,
        *,
        only: Sequence[str] | None = ...,
    ) -> FeContactAblation | DynamicsAblation: ...
    @_offered(GearboxFrontierFigures)
    def frontier(
        self,
        given: CaseLike | SceneLike,
        *,
        rungs: Sequence[str] | None = ...,
        up_to: Literal["corrected_fine", "3d_draft", "3d_standard", "3d_fine"] = ...,
        full_contact: int | None = ...,
    ) -> FeContactFrontier | DynamicsFrontier: ...
    @_offered(GearboxSensitivityFigures)
    def sensitivity(
        self,
        case: CaseLike,
        *,
        misalignment_um: Sequence[float] = ...,
        center_distance_change_percent: Sequence[float] = ...,
    ) -> tuple[GearboxPairStudy, ...]: ...
    @_offered(GearboxRootStressFigures)
    def root_stress(
        self,
        case: CaseLike,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> GearboxRoots: ...
    @_offered(GearboxOptimizationFigures)
    def optimize(
        self,
        case: CaseLike,
        study: StudyLike,
    ) -> FeContactOptimization: ...
    @_offered(GearboxScatterFigures)
    def scatter(
        self,
        case: CaseLike,
        *,
        tolerance_class: int = ...,
        misalignment_um: float = ...,
        distribution: Literal["normal", "uniform"] = ...,
        samples: int = ...,
        seed: int = ...,
    ) -> FeContactToleranceStudy: ...
    @_offered(GearboxSweepFigures)
    def sweep(
        self,
        case: CaseLike,
        *,
        over: Sequence[str] = ...,
        show: Sequence[Literal["peak_to_peak", "harmonic_1", "harmonic_2", "harmonic_3", "max_pressure", "face_load_factor"]] = ...,
    ) -> GearboxSweepResult: ...
    @_offered(GearboxModesFigures)
    def modes(
        self,
        scene: SceneLike,
        *,
        speed_rpm: Sequence[float] = ...,
        orders: int = ...,
        highest_frequency_hz: float | None = ...,
    ) -> DynamicsModalAnalysis: ...
    @_offered(GearboxResponseFigures)
    def response(
        self,
        scene: SceneLike,
        *,
        speed_rpm: Sequence[float],
        orders: int = ...,
    ) -> DynamicsForcedResponse: ...
    @_offered(GearboxNoiseFigures)
    def noise(
        self,
        scene: SceneLike,
        *,
        speed_rpm: Sequence[float] = ...,
        orders: int = ...,
        run: str | None = ...,
        band: bool = ...,
        sensitivities: bool = ...,
        housing_damping: Sequence[float] = ...,
        housing_frequency: Sequence[float] = ...,
        mount_stiffness: Sequence[float] = ...,
        bearing_stiffness: Sequence[float] = ...,
        mesh_damping: Sequence[float] = ...,
        radiation: Literal["monopoles", "equivalent_radiated_power"] = ...,
        boundary_elements: bool = ...,
    ) -> DynamicsRadiatedSound: ...
    @_offered(GearboxVibrationFigures)
    def vibration(
        self,
        scene: SceneLike,
        *,
        speed_rpm: Sequence[float] = ...,
        orders: int = ...,
        run: str | None = ...,
        housing: str | None = ...,
        at_rpm: float | None = ...,
        at_order: float | None = ...,
        mode: int | None = ...,
    ) -> GearboxHousingVibrationResult: ...
    @_offered(GearboxRecordingFigures)
    def listen(
        self,
        scene: SceneLike,
        *,
        run: str,
        microphone_mm: Sequence[float] | None = ...,
        point: str | None = ...,
        direction: Literal["x", "y", "z", "principal"] | None = ...,
    ) -> GearboxHeardRun: ...
    @_offered(GearboxSteadyFigures)
    def steady(
        self,
        scene: SceneLike,
        *,
        speed_rpm: Sequence[float],
        branch: bool = ...,
        repeat: int = ...,
        settling_periods: int = ...,
    ) -> DynamicsSteadyStates: ...
    @_offered(GearboxDeflectionFigures)
    def deflect(
        self,
        scene: SceneLike,
        study: StudyLike = ...,
    ) -> GearboxGearboxDeflection: ...
    @_offered(GearboxStudyFigures)
    def study(
        self,
        scene: SceneLike,
        study: StudyLike,
    ) -> DynamicsStudy: ...
