// The choice between the integrators path and bidir, for INTEGRATOR_AUTO.
#ifndef LAMPYRIS_JOB_CHOICE_H
#define LAMPYRIS_JOB_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

// The measurements of the pilot by one of the two integrators.
struct choice_trial {
    double error; // local relMSE
    double rays;
};

struct integrator_choice {
    bool is_made;       // the setting was auto, and the scene's settings now have the integrator
    bool is_unfinished; // a stop ended the pilot, so that a later run must choose again
    const char *reason; // owned by the job
    // The pilot's picture and samples per pixel; 0: there was no pilot.
    uint32_t width, height, samples;
    double seconds; // time that the pilot took
    struct choice_trial path, bidir;
};

#endif
