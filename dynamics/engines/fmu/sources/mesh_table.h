/* The mesh-force table: transmission error of levels of constant force over position, as a file holds it. */
#ifndef MESH_TABLE_H
#define MESH_TABLE_H

#include <stddef.h>
#include <stdint.h>

enum { NODE_VALUES = 4, IDENTITY_LENGTH = 32, MESSAGE_LENGTH = 512 };

/* Arrays of lengths M, D, P, L; `node` holds per (m, d, p, l) in this order: deflection (m), its slope (m per
   base pitch), stiffness (N/m), its slope. `period` counts base pitches. */
typedef struct {
    size_t misalignments, distances, positions, levels;
    int64_t period;
    const double *misalignment, *distance, *position, *level, *node;
    double *memory;
} mesh_table;

/* Bits of the validity of a look-up; 0 is inside the table (parted flanks are inside). */
enum { BEYOND_FORCE = 1, BEYOND_MISALIGNMENT = 2, BEYOND_DISTANCE = 4 };

typedef struct {
    double force;     /* transverse, N; 0 below lift-off */
    double stiffness; /* its derivative in deflection, N/m */
    int validity;
} table_force;

/* Read the file of the given identity; 0, or an error with its message. */
int read_mesh_table(const char *path, const char *identity, mesh_table *table, char *message);
void free_mesh_table(mesh_table *table);

/* Position less whole periods, which drop exactly: in [0, period). */
double wrapped(double position, double period);

/* Force at a position (base pitches), a deflection, a misalignment and a change of center distance (m). Outside
   the axes the nearest place is used; above the last level the force goes straight on. Both are flagged. */
table_force look_up(const mesh_table *table, double position, double deflection, double misalignment,
                    double distance);

#endif
