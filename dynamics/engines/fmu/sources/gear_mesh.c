#include "gear_mesh.h"

#include <string.h>

static const double TWO_PI = 6.283185307179586;

static const double REAL_START[REAL_COUNT] = REAL_START_VALUES;
static const int32_t INTEGER_START[INTEGER_COUNT] = INTEGER_START_VALUES;
static const int32_t BOOLEAN_START[BOOLEAN_COUNT] = BOOLEAN_START_VALUES;

void start_values(mesh_values *values) {
    memcpy(values->real, REAL_START, sizeof REAL_START);
    memcpy(values->integer, INTEGER_START, sizeof INTEGER_START);
    memcpy(values->boolean, BOOLEAN_START, sizeof BOOLEAN_START);
}

/* Base pitches by the driver's angle, less whole periods of the whole turns: exact however many there are. */
static double position(const mesh_values *values, int64_t period) {
    const int64_t turned = (int64_t)values->integer[DRIVER_TURNS] * DRIVER_TEETH;
    return (double)(turned % period) + values->real[DRIVER_ANGLE] * DRIVER_TEETH / TWO_PI +
           values->real[POSITION_OFFSET];
}

/* What the rotations make of the transmission error, and its rate; what whole turns leave is a whole number of
   base pitches, without rounding. */
static void rotation_error(const mesh_values *values, double *error, double *rate) {
    const double *real = values->real;
    *error = *rate = 0.0;
    if (values->boolean[DTE_FROM_ANGLES]) {
        const int64_t pitches = (int64_t)values->integer[DRIVER_TURNS] * DRIVER_TEETH -
                                (int64_t)values->integer[DRIVEN_TURNS] * DRIVEN_TEETH;
        *error = (double)pitches * BASE_PITCH +
                 (DRIVER_BASE_RADIUS * real[DRIVER_ANGLE] - DRIVEN_BASE_RADIUS * real[DRIVEN_ANGLE]);
        *rate = DRIVER_BASE_RADIUS * real[DRIVER_SPEED] - DRIVEN_BASE_RADIUS * real[DRIVEN_SPEED];
    }
}

typedef struct {
    double force, stiffness, viscosity; /* its derivatives in approach and rate */
} flank;

/* Elastic force and damping that fades to zero at lift-off and never pulls. */
static flank flank_force(const double *real, table_force elastic, double rate) {
    double ratio = elastic.force / real[DAMPING_REACH];
    double fade, fade_slope, force;
    flank found = {0.0, 0.0, 0.0};
    if (ratio > 1.0) ratio = 1.0;
    fade = ratio * ratio * (3.0 - 2.0 * ratio);
    fade_slope = 6.0 * ratio * (1.0 - ratio) / real[DAMPING_REACH];
    force = elastic.force + real[DAMPING] * fade * rate;
    if (force < 0.0) return found;
    found.force = force;
    found.stiffness = elastic.stiffness * (1.0 + real[DAMPING] * fade_slope * rate);
    found.viscosity = real[DAMPING] * fade;
    return found;
}

/* The driving flanks; returns whether they touch. */
static int drive(const mesh_table *table, mesh_values *values) {
    double *real = values->real;
    const table_force elastic =
        look_up(table, real[POSITION], real[DTE], real[MISALIGNMENT], real[CENTER_DISTANCE_CHANGE]);
    const flank found = flank_force(real, elastic, real[DTE_RATE]);
    real[ELASTIC_FORCE] = elastic.force;
    real[MESH_FORCE] = found.force;
    real[STIFFNESS] = found.stiffness;
    real[VISCOSITY] = found.viscosity;
    values->integer[VALIDITY] = elastic.validity;
    return elastic.force > 0.0;
}

/* The backs of the teeth: turned by pi about the line of centers the pair is itself driven in the other sense, at
   the driver's thickness less the position; the gap of a misalignment grows towards the other end. */
static int coast(const mesh_table *table, mesh_values *values, double rate) {
    double *real = values->real;
    table_force elastic;
    flank found;
    real[COAST_FORCE] = real[COAST_STIFFNESS] = real[COAST_VISCOSITY] = 0.0;
    if (!values->boolean[COAST_FLANK]) return 0;
    elastic = look_up(table, wrapped(real[TOOTH_THICKNESS] - real[POSITION], (double)table->period),
                      real[COAST_APPROACH], -real[MISALIGNMENT], real[CENTER_DISTANCE_CHANGE]);
    found = flank_force(real, elastic, rate);
    real[COAST_FORCE] = found.force;
    real[COAST_STIFFNESS] = found.stiffness;
    real[COAST_VISCOSITY] = found.viscosity;
    if (elastic.force > 0.0) values->integer[VALIDITY] |= elastic.validity;
    return elastic.force > 0.0;
}

void evaluate(const mesh_table *table, mesh_values *values) {
    double *real = values->real;
    double error, rate, along;
    int driving, coasting;
    real[POSITION] = wrapped(position(values, table->period), (double)table->period);
    rotation_error(values, &error, &rate);
    real[DTE] = real[DISPLACEMENT] + error;
    real[DTE_RATE] = real[DISPLACEMENT_RATE] + rate;
    real[COAST_APPROACH] = real[COAST_DISPLACEMENT] - error - real[BACKLASH];
    driving = drive(table, values);
    coasting = coast(table, values, real[COAST_DISPLACEMENT_RATE] - rate);
    along = real[MESH_FORCE] - real[COAST_FORCE];
    real[DRIVER_TORQUE] = -along * DRIVER_BASE_RADIUS;
    real[DRIVEN_TORQUE] = along * DRIVEN_BASE_RADIUS;
    real[DRIVER_AXIAL_FORCE] = along * TAN_BASE_HELIX_ANGLE;
    values->integer[CONTACT_STATE] = (driving ? IN_CONTACT : APART) | (coasting ? COAST_IN_CONTACT : APART);
}
