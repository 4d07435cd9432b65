/* The FMI 2.0 co-simulation interface of a gear mesh. The element has no states of its own: its outputs follow
   from its inputs at once, so that reading them after setting inputs needs no step. */
#include "fmi2.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gear_mesh.h"
#include "resource_path.h"

enum { NAME_LENGTH = 128, PATH_LENGTH = 4096 };
typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED } phase;

/* What a state is: everything but the table and the host's callbacks. */
typedef struct {
    phase phase;
    int stale; /* outputs are behind their inputs */
    double time;
    mesh_values values;
} state;

typedef struct {
    state state;
    mesh_table table;
    char name[NAME_LENGTH];
    const fmi2CallbackFunctions *host;
} unit;

static fmi2Status fail(const unit *u, const char *text, ...) {
    char message[MESSAGE_LENGTH + NAME_LENGTH];
    va_list arguments;
    va_start(arguments, text);
    vsnprintf(message, sizeof message, text, arguments);
    va_end(arguments);
    if (u->host != NULL && u->host->logger != NULL)
        u->host->logger(u->host->componentEnvironment, u->name, fmi2Error, "error", "%s", message);
    return fmi2Error;
}

/* ---- life ---- */

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    (void)c, (void)on, (void)count, (void)categories;
    return fmi2OK; /* errors are always reported, and there is nothing else to say */
}

static int load(unit *u, fmi2String guid, fmi2String location) {
    char path[PATH_LENGTH], message[MESSAGE_LENGTH] = "";
    if (guid == NULL || strcmp(guid, GUID) != 0)
        return fail(u, "the GUID is not that of the model description, " GUID);
    if (location == NULL || resource_path(location, TABLE_FILE, path, sizeof path) != 0)
        return fail(u, "no usable address of the resources");
    if (read_mesh_table(path, TABLE_IDENTITY, &u->table, message) != 0) return fail(u, "%s", message);
    return 0;
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String location,
                              const fmi2CallbackFunctions *host, fmi2Boolean visible, fmi2Boolean logging) {
    unit *u = calloc(1, sizeof *u);
    (void)visible, (void)logging;
    if (u == NULL) return NULL;
    u->host = host;
    snprintf(u->name, sizeof u->name, "%s", name == NULL ? "" : name);
    if (type != fmi2CoSimulation) {
        fail(u, "this unit is for co-simulation");
    } else if (load(u, guid, location) == 0) {
        fmi2Reset(u);
        return u;
    }
    free(u);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) {
    unit *u = c;
    if (u == NULL) return;
    free_mesh_table(&u->table);
    free(u);
}

fmi2Status fmi2Reset(fmi2Component c) {
    unit *u = c;
    memset(&u->state, 0, sizeof u->state);
    u->state.phase = INSTANTIATED;
    u->state.stale = 1;
    start_values(&u->state.values);
    return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start,
                               fmi2Boolean stops, fmi2Real stop) {
    unit *u = c;
    (void)tolerant, (void)tolerance, (void)stops, (void)stop;
    u->state.time = start;
    return fmi2OK;
}

static fmi2Status move(unit *u, phase from, phase to, const char *call) {
    if (u->state.phase != from) return fail(u, "%s is out of order", call);
    u->state.phase = to;
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    return move(c, INSTANTIATED, INITIALIZING, "fmi2EnterInitializationMode");
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return move(c, INITIALIZING, STEPPING, "fmi2ExitInitializationMode");
}

fmi2Status fmi2Terminate(fmi2Component c) { return move(c, STEPPING, TERMINATED, "fmi2Terminate"); }

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_earlier_state) {
    unit *u = c;
    (void)no_earlier_state;
    if (u->state.phase != STEPPING) return fail(u, "fmi2DoStep is out of order");
    if (!isfinite(time) || !isfinite(step) || step < 0.0) return fail(u, "step = %g s: must be 0 or above", step);
    u->state.time = time + step;
    return fmi2OK;
}

/* ---- values ---- */

static void refresh(unit *u) {
    if (u->state.stale) evaluate(&u->table, &u->state.values);
    u->state.stale = 0;
}

static fmi2Status unknown(const unit *u, fmi2ValueReference reference) {
    return fail(u, "value reference %u does not exist or cannot be set", reference);
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    unit *u = c;
    refresh(u);
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= REAL_COUNT) return unknown(u, vr[i]);
        value[i] = u->state.values.real[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Integer value[]) {
    unit *u = c;
    refresh(u);
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= INTEGER_COUNT) return unknown(u, vr[i]);
        value[i] = u->state.values.integer[vr[i]];
    }
    return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Boolean value[]) {
    unit *u = c;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= BOOLEAN_COUNT) return unknown(u, vr[i]);
        value[i] = u->state.values.boolean[vr[i]];
    }
    return fmi2OK;
}

static fmi2Status refused(const unit *u, fmi2ValueReference reference, double value) {
    if (!isfinite(value)) return fail(u, "%s = %g: must be a finite number", REAL_NAMES[reference], value);
    if (reference == DAMPING && value < 0.0) return fail(u, "damping = %g N s/m: must be 0 or above", value);
    if (reference == DAMPING_REACH && value <= 0.0) return fail(u, "damping_reach = %g N: must be above 0", value);
    if (reference == BACKLASH && value < 0.0) return fail(u, "backlash = %g m: must be 0 or above", value);
    return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[]) {
    unit *u = c;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= REAL_SETTABLE) return unknown(u, vr[i]);
        if (refused(u, vr[i], value[i]) != fmi2OK) return fmi2Error;
        u->state.values.real[vr[i]] = value[i];
    }
    u->state.stale = 1;
    return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Integer value[]) {
    unit *u = c;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= INTEGER_SETTABLE) return unknown(u, vr[i]);
        u->state.values.integer[vr[i]] = value[i];
    }
    u->state.stale = 1;
    return fmi2OK;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                          const fmi2Boolean value[]) {
    unit *u = c;
    for (size_t i = 0; i < count; i++) {
        if (vr[i] >= BOOLEAN_COUNT) return unknown(u, vr[i]);
        u->state.values.boolean[vr[i]] = value[i] != fmi2False;
    }
    u->state.stale = 1;
    return fmi2OK;
}

/* There are no strings. */
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2String value[]) {
    (void)value;
    return count == 0 ? fmi2OK : unknown(c, vr[0]);
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2String value[]) {
    (void)value;
    return count == 0 ? fmi2OK : unknown(c, vr[0]);
}

/* ---- states: copies of plain memory ---- */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    unit *u = c;
    if (*kept == NULL) *kept = malloc(sizeof(state));
    if (*kept == NULL) return fail(u, "no memory for a state");
    memcpy(*kept, &u->state, sizeof(state));
    return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate kept) {
    unit *u = c;
    if (kept == NULL) return fail(u, "there is no such state");
    memcpy(&u->state, kept, sizeof(state));
    return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *kept) {
    (void)c;
    if (kept != NULL) {
        free(*kept);
        *kept = NULL;
    }
    return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate kept, size_t *size) {
    (void)c, (void)kept;
    *size = sizeof(state);
    return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate kept, fmi2Byte bytes[], size_t size) {
    if (kept == NULL || size < sizeof(state)) return fail(c, "a state takes %zu bytes", sizeof(state));
    memcpy(bytes, kept, sizeof(state));
    return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *kept) {
    if (size != sizeof(state)) return fail(c, "a state takes %zu bytes", sizeof(state));
    if (*kept == NULL) *kept = malloc(sizeof(state));
    if (*kept == NULL) return fail(c, "no memory for a state");
    memcpy(*kept, bytes, sizeof(state));
    return fmi2OK;
}

/* ---- what the model description says this unit does not do ---- */

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t n,
                                        const fmi2ValueReference knowns[], size_t m, const fmi2Real seed[],
                                        fmi2Real found[]) {
    (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)found;
    return fail(c, "no directional derivatives: read stiffness and viscosity");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                       const fmi2Integer order[], const fmi2Real value[]) {
    (void)vr, (void)count, (void)order, (void)value;
    return fail(c, "inputs are not extrapolated");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                        const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)count, (void)order, (void)value;
    return fail(c, "no derivatives of outputs");
}

fmi2Status fmi2CancelStep(fmi2Component c) { return fail(c, "steps end at once"); }

fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Status *value) {
    (void)c, (void)kind;
    *value = fmi2OK;
    return fmi2Discard;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    const unit *u = c;
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = u->state.time;
    return fmi2OK;
}

fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value) {
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    const unit *u = c;
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = u->state.phase == TERMINATED;
    return fmi2OK;
}

fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind kind, fmi2String *value) {
    (void)c, (void)kind, (void)value;
    return fmi2Discard;
}
