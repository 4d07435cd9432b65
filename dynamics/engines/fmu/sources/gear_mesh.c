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

/* Transmission error: what whole turns leave is a whole number of base pitches, without rounding. */
static void transmission_error(mesh_values *values) {
    double *real = values->real;
    real[DTE] = real[DISPLACEMENT];
    real[DTE_RATE] = real[DISPLACEMENT_RATE];
    if (values->boolean[DTE_FROM_ANGLES]) {
        const int64_t pitches = (int64_t)values->integer[DRIVER_TURNS] * DRIVER_TEETH -
                                (int64_t)values->integer[DRIVEN_TURNS] * DRIVEN_TEETH;
        real[DTE] += (double)pitches * BASE_PITCH +
                     (DRIVER_BASE_RADIUS * real[DRIVER_ANGLE] - DRIVEN_BASE_RADIUS * real[DRIVEN_ANGLE]);
        real[DTE_RATE] += DRIVER_BASE_RADIUS * real[DRIVER_SPEED] - DRIVEN_BASE_RADIUS * real[DRIVEN_SPEED];
    }
}

/* Elastic force and damping that fades to zero at lift-off and never pulls. */
static void flank_force(mesh_values *values, table_force elastic) {
    double *real = values->real;
    double ratio = elastic.force / real[DAMPING_REACH];
    double fade, fade_slope, force;
    if (ratio > 1.0) ratio = 1.0;
    fade = ratio * ratio * (3.0 - 2.0 * ratio);
    fade_slope = 6.0 * ratio * (1.0 - ratio) / real[DAMPING_REACH];
    force = elastic.force + real[DAMPING] * fade * real[DTE_RATE];
    real[ELASTIC_FORCE] = elastic.force;
    real[MESH_FORCE] = force > 0.0 ? force : 0.0;
    real[STIFFNESS] = 0.0;
    real[VISCOSITY] = 0.0;
    if (force < 0.0) return;
    real[STIFFNESS] = elastic.stiffness * (1.0 + real[DAMPING] * fade_slope * real[DTE_RATE]);
    real[VISCOSITY] = real[DAMPING] * fade;
}

void evaluate(const mesh_table *table, mesh_values *values) {
    double *real = values->real;
    table_force elastic;
    real[POSITION] = wrapped(position(values, table->period), (double)table->period);
    transmission_error(values);
    elastic = look_up(table, real[POSITION], real[DTE], real[MISALIGNMENT], real[CENTER_DISTANCE_CHANGE]);
    flank_force(values, elastic);
    real[DRIVER_TORQUE] = -real[MESH_FORCE] * DRIVER_BASE_RADIUS;
    real[DRIVEN_TORQUE] = real[MESH_FORCE] * DRIVEN_BASE_RADIUS;
    real[DRIVER_AXIAL_FORCE] = real[MESH_FORCE] * TAN_BASE_HELIX_ANGLE;
    values->integer[CONTACT_STATE] = elastic.force > 0.0 ? IN_CONTACT : APART;
    values->integer[VALIDITY] = elastic.validity;
}
