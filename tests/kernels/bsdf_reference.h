// A reference of the BSDFs in double precision, written from the papers and from
// docs/materials*.md, not from the kernels. It gives the expected density and value of a sample.
//
// The frame and eta are those of shaders/lib/bsdf_types.glsl.
#ifndef LAMPYRIS_TESTS_BSDF_REFERENCE_H
#define LAMPYRIS_TESTS_BSDF_REFERENCE_H

#include "bsdf_optics.h"
#include "scene/core/scene_material.h"
#include "shared/methods.h"

enum { REFERENCE_MAX_DELTAS = 4 };

// A direction with a probability instead of a density.
struct reference_delta {
    double wi[3];
    double probability;
    double weight[3]; // weight of a sample in this direction
    bool transmitted;
};

// Settings of a render that change the sampling or the definition of a BSDF.
struct bsdf_choices {
    uint32_t normals; // NORMALS_*
    bool unscaled;    // refraction does not scale radiance
};

struct reference {
    const struct material *material;
    struct bsdf_choices choices;
    double wo[3], eta;
    // The probability that an attempt to sample the interface survives masking and shadowing,
    // according to the tables; 0 if the interface is sampled only once.
    double survival;
    struct principled_state *principled; // on the heap; NULL for other models
};

// wo and eta are the kernel's inputs. They were rounded, so directions stand for the unit vectors
// parallel to them. `material` must outlive the reference.
bool reference_init(struct reference *reference, const struct material *material,
                    struct bsdf_choices choices, const float wo[3], float eta);
void reference_finish(struct reference *reference);
// Computes BSDF * |wi.z| of everything except deltas in f. Returns the density.
double reference_eval(const struct reference *reference, const double wi[3], double f[3]);
// Fills `out` and returns the number of deltas.
int reference_deltas(const struct reference *reference,
                     struct reference_delta out[REFERENCE_MAX_DELTAS]);
// Returns whether transmission counts as specular although it has an extent, or weights that
// differ: because it is too narrow for single precision, or goes straight on. Its density is then
// 0.
bool reference_hides_refraction(const struct reference *reference);
// Returns the density with which microfacet normals are sampled in this case.
double reference_hidden_normal(const struct reference *reference, const double h[3]);

// Returns the true probability that an attempt survives, by quadrature.
double reference_true_survival(const struct reference *reference);

// Returns the density of sampled GGX normals; the other function that of the directions that they
// reflect.
double reference_normal_density(const struct reference *reference, const double wo[3],
                                const double h[3], const double alpha[2]);
double reference_reflected_density(const struct reference *reference, const double wo[3],
                                   const double h[3], const double alpha[2]);
// Returns the number by which refraction divides radiance.
double reference_divisor(const struct reference *reference, double eta);

// --- by model ------------------------------------------------------------------------------------

double classical_eval(const struct reference *reference, const double wi[3], double f[3]);
int classical_deltas(const struct reference *reference, struct reference_delta *out);
double dielectric_eval(const struct reference *reference, const double wi[3], double f[3]);
int dielectric_deltas(const struct reference *reference, struct reference_delta *out);
bool dielectric_hides_refraction(const struct reference *reference);
double dielectric_through_normal(const struct reference *reference, const double h[3]);
// Returns the mean of dielectric_unshadowed() over the normals visible from wo, for wo in the frame
// of alpha. reflects() is the probability of reflection for the cosine wo.h.
double dielectric_survival(const struct reference *reference, const double wo[3],
                           const double alpha[2], bool thin,
                           double (*reflects)(const struct reference *, double cosine));
double dielectric_true_survival(const struct reference *reference);
// Returns the density with repeated attempts, from that of visible normals, of which the fraction
// `unshadowed` survives.
double dielectric_tried(const struct reference *reference, double density, double unshadowed);
// Returns the fraction of a microfacet's light that survives: reflection with the probability
// `reflects`, or refraction.
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
