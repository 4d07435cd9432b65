/* The gear-mesh force: from angles and speeds of two gears to force, torques and contact state. */
#ifndef GEAR_MESH_H
#define GEAR_MESH_H

#include "mesh_table.h"
#include "variables.h" /* generated with the model description: places, start values, facts of the pair */

/* All variables, by their value references; plain memory, so that a state is a copy of it. */
typedef struct {
    double real[REAL_COUNT];
    int32_t integer[INTEGER_COUNT];
    int32_t boolean[BOOLEAN_COUNT];
} mesh_values;

enum { APART = 0, IN_CONTACT = 1, COAST_IN_CONTACT = 2 };

void start_values(mesh_values *values);

/* Set all outputs from inputs and parameters. */
void evaluate(const mesh_table *table, mesh_values *values);

#endif
