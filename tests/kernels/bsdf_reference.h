// The BSDFs once more in double precision, written from the papers and from docs/materials*.md
// rather than from the kernels: what a sample's density and value ought to be.
//
// The frame and eta are those of shaders/lib/bsdf_types.glsl.
#ifndef LAMPYRIS_TESTS_BSDF_REFERENCE_H
#define LAMPYRIS_TESTS_BSDF_REFERENCE_H

#include "bsdf_optics.h"
#include "scene/core/scene_material.h"
#include "shared/methods.h"

enum { REFERENCE_MAX_DELTAS = 4 };

// A direction that has a probability rather than a density.
struct reference_delta {
    double wi[3];
    double probability;
    double weight[3]; // weight of a sample of it
    bool transmitted;
};

// Settings of a render that change how a BSDF is drawn or what it is.
struct bsdf_choices {
    uint32_t normals; // NORMALS_*
    bool unscaled;    // refraction leaves radiance as it is
};

struct reference {
    const struct material *material;
    struct bsdf_choices choices;
    double wo[3], eta;
    // The chance that a try to draw the interface survives other microfacets, as its tables say; 0
    // where it is drawn once and not asked to.
    double survival;
    struct principled_state *principled; // heap; NULL for other models
};

// wo and eta are what the kernel gets. Directions were rounded: they are taken to stand for the
// unit vectors that are parallel to them. `material` must outlive it.
bool reference_init(struct reference *reference, const struct material *material,
                    struct bsdf_choices choices, const float wo[3], float eta);
void reference_finish(struct reference *reference);
// BSDF * |wi.z| of all that is not a delta in f; returns the density.
double reference_eval(const struct reference *reference, const double wi[3], double f[3]);
// Fills out; returns how many there are.
int reference_deltas(const struct reference *reference,
                     struct reference_delta out[REFERENCE_MAX_DELTAS]);
// Returns whether what goes through is called specular although it has an extent (or weights that
// differ): so narrow that single precision does not resolve it, or straight on. The density is 0
// there.
bool reference_hides_refraction(const struct reference *reference);
// The density of microfacets' normals with which that is drawn.
double reference_hidden_normal(const struct reference *reference, const double h[3]);

// The true chance that a try survives, by quadrature.
double reference_true_survival(const struct reference *reference);

// The density with which a normal of GGX is drawn, and with which what it reflects is.
double reference_normal_density(const struct reference *reference, const double wo[3],
                                const double h[3], const double alpha[2]);
double reference_reflected_density(const struct reference *reference, const double wo[3],
                                   const double h[3], const double alpha[2]);
// Refraction divides radiance by this.
double reference_divisor(const struct reference *reference, double eta);

// --- by model ------------------------------------------------------------------------------------

double classical_eval(const struct reference *reference, const double wi[3], double f[3]);
int classical_deltas(const struct reference *reference, struct reference_delta *out);
double dielectric_eval(const struct reference *reference, const double wi[3], double f[3]);
int dielectric_deltas(const struct reference *reference, struct reference_delta *out);
bool dielectric_hides_refraction(const struct reference *reference);
double dielectric_through_normal(const struct reference *reference, const double h[3]);
// The mean of dielectric_unshadowed() over the normals that wo sees, for wo in the frame of alpha.
// reflects() is the probability of reflection at the cosine wo.h.
double dielectric_survival(const struct reference *reference, const double wo[3],
                           const double alpha[2], bool thin,
                           double (*reflects)(const struct reference *, double cosine));
double dielectric_true_survival(const struct reference *reference);
// Returns the density that drawing again makes of one of visible normals of which `unshadowed`
// survives.
double dielectric_tried(const struct reference *reference, double density, double unshadowed);
// The part of a microfacet that survives: reflection with the probability `reflects`, or
// refraction.
double dielectric_unshadowed(const double wo[3], const double h[3], const double alpha[2],
                             double eta, bool thin, double reflects);
double conductor_eval(const struct reference *reference, const double wi[3], double f[3]);
int conductor_deltas(const struct reference *reference, struct reference_delta *out);
void dielectric_prepare(struct reference *reference);
bool principled_prepare(struct reference *reference);
double principled_eval(const struct reference *reference, const double wi[3], double f[3]);
double principled_true_survival(const struct reference *reference);
int principled_deltas(const struct reference *reference, struct reference_delta *out);
bool principled_hides_refraction(const struct reference *reference);
double principled_through_normal(const struct reference *reference, const double h[3]);

#endif
