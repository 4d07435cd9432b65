#include "mesh_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- file: 8 characters, identity, five 64-bit sizes, then the arrays; little-endian ---- */

static const char MAGIC[8] = {'L', 'O', 'A', 'M', 'E', 'S', 'H', '1'};
static const uint64_t LARGEST = (uint64_t)1 << 32;

static int little_endian(void) {
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 1;
}

static int fail(char *message, const char *path, const char *what) {
    snprintf(message, MESSAGE_LENGTH, "mesh-force table %.300s: %s", path, what);
    return 1;
}

static void lay_out(mesh_table *table, const uint64_t *size) {
    double *next = table->memory;
    table->misalignments = (size_t)size[0];
    table->distances = (size_t)size[1];
    table->positions = (size_t)size[2];
    table->levels = (size_t)size[3];
    table->period = (int64_t)size[4];
    table->misalignment = next, next += table->misalignments;
    table->distance = next, next += table->distances;
    table->position = next, next += table->positions;
    table->level = next, next += table->levels;
    table->node = next;
}

static int read_content(FILE *file, const char *path, const char *identity, mesh_table *table, char *message) {
    char head[8 + IDENTITY_LENGTH];
    uint64_t size[5], nodes;
    size_t count;
    if (fread(head, 1, sizeof head, file) != sizeof head || memcmp(head, MAGIC, sizeof MAGIC) != 0)
        return fail(message, path, "no table of this kind");
    if (memcmp(head + sizeof MAGIC, identity, IDENTITY_LENGTH) != 0)
        return fail(message, path, "not the table this unit was made with");
    if (fread(size, sizeof size[0], 5, file) != 5) return fail(message, path, "cut short");
    nodes = 1;
    for (int axis = 0; axis < 4; axis++) {
        if (size[axis] == 0 || size[axis] > LARGEST / nodes) return fail(message, path, "damaged sizes");
        nodes *= size[axis];
    }
    if (size[3] < 2 || size[4] == 0 || size[4] > LARGEST) return fail(message, path, "damaged sizes");
    count = (size_t)(size[0] + size[1] + size[2] + size[3] + NODE_VALUES * nodes);
    table->memory = malloc(count * sizeof(double));
    if (table->memory == NULL) return fail(message, path, "too large for the memory");
    if (fread(table->memory, sizeof(double), count, file) != count) return fail(message, path, "cut short");
    lay_out(table, size);
    return 0;
}

int read_mesh_table(const char *path, const char *identity, mesh_table *table, char *message) {
    FILE *file;
    int status;
    memset(table, 0, sizeof *table);
    if (!little_endian()) return fail(message, path, "needs a little-endian machine");
    file = fopen(path, "rb");
    if (file == NULL) return fail(message, path, "cannot be opened");
    status = read_content(file, path, identity, table, message);
    fclose(file);
    if (status != 0) free_mesh_table(table);
    return status;
}

void free_mesh_table(mesh_table *table) {
    free(table->memory);
    memset(table, 0, sizeof *table);
}

/* ---- look-up ---- */

typedef struct {
    const double *node[2][4]; /* of the two knots of position, at the four corners of the axes: level 0 */
    double weight[4];
    double u, width;          /* place in the interval of position, its width in base pitches */
} section;

/* First k of 0..last with value < knot[k + 1], else last. */
static size_t interval(const double *knot, size_t last, double value) {
    size_t low = 0, high = last;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (value < knot[middle + 1])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* Interval and weight of its upper end on an axis; a place beyond it moves to the end and says so. */
static size_t place_on_axis(const double *knot, size_t count, double value, double *weight, int *beyond) {
    size_t k;
    *weight = 0.0;
    *beyond = value < knot[0] || value > knot[count - 1];
    if (count == 1 || value <= knot[0]) return 0;
    k = interval(knot, count - 2, value);
    *weight = value >= knot[count - 1] ? 1.0 : (value - knot[k]) / (knot[k + 1] - knot[k]);
    return k;
}

double wrapped(double position, double period) {
    double phase = position;
    if (!(phase >= 0.0 && phase < period)) {
        phase -= period * floor(phase / period);
        if (!(phase >= 0.0 && phase < period)) phase = 0.0; /* a tiny negative one rounds up to a period */
    }
    return phase;
}

static section cut(const mesh_table *table, double position, double misalignment, double distance, int *validity) {
    section s;
    double weight_m, weight_d, start, end;
    int beyond_m, beyond_d;
    const size_t last = table->positions - 1, per_knot = table->levels * NODE_VALUES;
    const size_t m = place_on_axis(table->misalignment, table->misalignments, misalignment, &weight_m, &beyond_m);
    const size_t d = place_on_axis(table->distance, table->distances, distance, &weight_d, &beyond_d);
    const double phase = wrapped(position - table->position[0], (double)table->period);
    const size_t p = last == 0 ? 0 : interval(table->position, last, phase + table->position[0]);
    *validity = (beyond_m ? BEYOND_MISALIGNMENT : 0) | (beyond_d ? BEYOND_DISTANCE : 0);
    start = table->position[p] - table->position[0];
    end = p == last ? (double)table->period : table->position[p + 1] - table->position[0];
    s.width = end - start;
    s.u = (phase - start) / s.width;
    for (int corner = 0; corner < 4; corner++) {
        const int up_m = corner & 1, up_d = corner >> 1;
        const size_t at_m = m + (size_t)(up_m && table->misalignments > 1);
        const size_t at_d = d + (size_t)(up_d && table->distances > 1);
        const double *block = table->node + (at_m * table->distances + at_d) * table->positions * per_knot;
        s.weight[corner] = (up_m ? weight_m : 1.0 - weight_m) * (up_d ? weight_d : 1.0 - weight_d);
        s.node[0][corner] = block + p * per_knot;
        s.node[1][corner] = block + (p == last ? 0 : p + 1) * per_knot;
    }
    return s;
}

/* Value number `which` of a level's node, interpolated in the axes. */
static double blended(const section *s, int knot, size_t index) {
    double sum = 0.0;
    for (int corner = 0; corner < 4; corner++)
        if (s->weight[corner] != 0.0) sum += s->weight[corner] * s->node[knot][corner][index];
    return sum;
}

/* Cubic Hermite in position: `first` is 0 for the deflection, 2 for the stiffness of a level. */
static double over_position(const section *s, size_t level, size_t first) {
    const size_t index = level * NODE_VALUES + first;
    const double value = blended(s, 0, index), end = blended(s, 1, index);
    const double rise = blended(s, 0, index + 1) * s->width, fall = blended(s, 1, index + 1) * s->width;
    const double step = end - value, c2 = 3.0 * step - 2.0 * rise - fall, c3 = rise + fall - 2.0 * step;
    return value + s->u * (rise + s->u * (c2 + s->u * c3));
}

static table_force between(const mesh_table *table, const section *s, size_t k, double low, double high,
                           double deflection, int validity) {
    const double span = high - low, w = (deflection - low) / span;
    const double rise = span * over_position(s, k, 2), fall = span * over_position(s, k + 1, 2);
    const double step = table->level[k + 1] - table->level[k];
    const double c2 = 3.0 * step - 2.0 * rise - fall, c3 = rise + fall - 2.0 * step;
    table_force found;
    found.force = table->level[k] + w * (rise + w * (c2 + w * c3));
    found.stiffness = (rise + w * (2.0 * c2 + 3.0 * w * c3)) / span;
    found.validity = validity;
    return found;
}

table_force look_up(const mesh_table *table, double position, double deflection, double misalignment,
                    double distance) {
    table_force found = {0.0, 0.0, 0};
    size_t low = 0, high = table->levels - 1; /* deflection lies from level `low` to level `high` */
    double below, above;
    const section s = cut(table, position, misalignment, distance, &found.validity);
    below = over_position(&s, low, 0);
    if (deflection < below) return found;
    above = over_position(&s, high, 0);
    if (deflection >= above) {
        found.stiffness = over_position(&s, high, 2);
        found.force = table->level[high] + found.stiffness * (deflection - above);
        found.validity |= BEYOND_FORCE;
        return found;
    }
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        const double value = over_position(&s, middle, 0);
        if (deflection < value)
            high = middle, above = value;
        else
            low = middle, below = value;
    }
    return between(table, &s, low, below, above, deflection, found.validity);
}
