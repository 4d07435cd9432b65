/* The binary interface of FMI 2.0 for co-simulation, as far as this unit has it (FMI 2.0.4, sections 2.1 and 4.2). */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#define fmi2TypesPlatform "default"
#define fmi2Version "2.0"

enum { fmi2False, fmi2True };

typedef void *fmi2Component, *fmi2ComponentEnvironment, *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer, fmi2Boolean;
typedef char fmi2Byte;
typedef const char *fmi2String;

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;

typedef struct {
    void (*logger)(fmi2ComponentEnvironment, fmi2String instance, fmi2Status, fmi2String category,
                   fmi2String message, ...);
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

#if defined _WIN32 || defined __CYGWIN__
#define EXPORTED __declspec(dllexport)
#elif defined __GNUC__
#define EXPORTED __attribute__((visibility("default")))
#else
#define EXPORTED
#endif

typedef const fmi2ValueReference references[];

EXPORTED const char *fmi2GetTypesPlatform(void);
EXPORTED const char *fmi2GetVersion(void);
EXPORTED fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, size_t, const fmi2String[]);

EXPORTED fmi2Component fmi2Instantiate(fmi2String, fmi2Type, fmi2String, fmi2String,
                                       const fmi2CallbackFunctions *, fmi2Boolean, fmi2Boolean);
EXPORTED void fmi2FreeInstance(fmi2Component);
EXPORTED fmi2Status fmi2SetupExperiment(fmi2Component, fmi2Boolean, fmi2Real, fmi2Real, fmi2Boolean, fmi2Real);
EXPORTED fmi2Status fmi2EnterInitializationMode(fmi2Component);
EXPORTED fmi2Status fmi2ExitInitializationMode(fmi2Component);
EXPORTED fmi2Status fmi2Terminate(fmi2Component);
EXPORTED fmi2Status fmi2Reset(fmi2Component);

EXPORTED fmi2Status fmi2GetReal(fmi2Component, references, size_t, fmi2Real[]);
EXPORTED fmi2Status fmi2GetInteger(fmi2Component, references, size_t, fmi2Integer[]);
EXPORTED fmi2Status fmi2GetBoolean(fmi2Component, references, size_t, fmi2Boolean[]);
EXPORTED fmi2Status fmi2GetString(fmi2Component, references, size_t, fmi2String[]);
EXPORTED fmi2Status fmi2SetReal(fmi2Component, references, size_t, const fmi2Real[]);
EXPORTED fmi2Status fmi2SetInteger(fmi2Component, references, size_t, const fmi2Integer[]);
EXPORTED fmi2Status fmi2SetBoolean(fmi2Component, references, size_t, const fmi2Boolean[]);
EXPORTED fmi2Status fmi2SetString(fmi2Component, references, size_t, const fmi2String[]);

EXPORTED fmi2Status fmi2GetFMUstate(fmi2Component, fmi2FMUstate *);
EXPORTED fmi2Status fmi2SetFMUstate(fmi2Component, fmi2FMUstate);
EXPORTED fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate *);
EXPORTED fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, size_t *);
EXPORTED fmi2Status fmi2SerializeFMUstate(fmi2Component, fmi2FMUstate, fmi2Byte[], size_t);
EXPORTED fmi2Status fmi2DeSerializeFMUstate(fmi2Component, const fmi2Byte[], size_t, fmi2FMUstate *);

EXPORTED fmi2Status fmi2GetDirectionalDerivative(fmi2Component, references, size_t, references, size_t,
                                                 const fmi2Real[], fmi2Real[]);
EXPORTED fmi2Status fmi2SetRealInputDerivatives(fmi2Component, references, size_t, const fmi2Integer[],
                                                const fmi2Real[]);
EXPORTED fmi2Status fmi2GetRealOutputDerivatives(fmi2Component, references, size_t, const fmi2Integer[],
                                                 fmi2Real[]);
EXPORTED fmi2Status fmi2DoStep(fmi2Component, fmi2Real time, fmi2Real step, fmi2Boolean);
EXPORTED fmi2Status fmi2CancelStep(fmi2Component);
EXPORTED fmi2Status fmi2GetStatus(fmi2Component, const fmi2StatusKind, fmi2Status *);
EXPORTED fmi2Status fmi2GetRealStatus(fmi2Component, const fmi2StatusKind, fmi2Real *);
EXPORTED fmi2Status fmi2GetIntegerStatus(fmi2Component, const fmi2StatusKind, fmi2Integer *);
EXPORTED fmi2Status fmi2GetBooleanStatus(fmi2Component, const fmi2StatusKind, fmi2Boolean *);
EXPORTED fmi2Status fmi2GetStringStatus(fmi2Component, const fmi2StatusKind, fmi2String *);

#endif
