// Defines cases of dielectrics, media and metals whose radiance has a closed form (numbers as in
// docs/verification.md, B and C): slabs, absorption, total reflection, nested glass, rough plates.
#include "check/case_list.h"
#include "check/closed_form.h"
#include <math.h>

#include <complex.h>

// --- the forms ----------------------------------------------------------------------------------

static double radians(double degrees)
{
    return degrees * M_PI / 180.0;
}

static double cos_refracted(double cos_i, double n)
{
    double sine = sqrt(1.0 - cos_i * cos_i) / n;
    return sqrt(1.0 - sine * sine);
}

// Returns the Fresnel reflectance for unpolarised light at an interface with the relative index of
// refraction n, which may be complex.
static double reflectance(double degrees, double complex n)
{
    double cos_i = cos(radians(degrees));
    double complex sine = sqrt(1.0 - cos_i * cos_i) / n;
    double complex cos_t = csqrt(1.0 - sine * sine);
    double complex s = (cos_i - n * cos_t) / (cos_i + n * cos_t);
    double complex p = (n * cos_i - cos_t) / (n * cos_i + cos_t);
    return 0.5 * (creal(s * conj(s)) + creal(p * conj(p)));
}

static double all(double rho, double le, double part)
{
    (void)rho;
    return part * le;
}
static const char all_is[] = "Le times a known factor";

static double colored(double rho, double le, double part)
{
    return part * rho * le;
}
static const char colored_is[] = "rho Le";

// Returns the transmittance of n glass interfaces in a row. It includes all orders of reflection
// between them, and takes the light at each interface to be unpolarised: T = (1 - R) / (1 + (n - 1)
// R).
static double through_interfaces(double degrees, double count)
{
    double r = reflectance(degrees, 1.5);
    return (1.0 - r) / (1.0 + (count - 1.0) * r);
}

static double through_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * through_interfaces(degrees, 2.0);
}
static const char through_slab_is[] = "Le (1 - R) / (1 + R)";

static double from_slab(double rho, double le, double degrees)
{
    (void)rho;
    return le * (1.0 - through_interfaces(degrees, 2.0));
}
static const char from_slab_is[] = "Le (1 - (1 - R) / (1 + R))";

// Returns the radiance through two walls of a box, each of which is a thin sheet with two
// interfaces.
static double through_sheets(double rho, double le, double degrees)
{
    (void)rho;
    return le * through_interfaces(degrees, 4.0);
}
static const char through_sheets_is[] = "Le (1 - R) / (1 + 3 R)";

// Returns the radiance through a slab of thickness 1 and index of refraction 1, whose medium has
// the transmittance rho at distance 1.
static double through_fog(double rho, double le, double degrees)
{
    return le * pow(rho, 1.0 / cos(radians(degrees)));
}
static const char through_fog_is[] = "Le exp(-sigma d / cos)";

static double through_tinted_slab(double rho, double le, double degrees)
{
    double r = reflectance(degrees, 1.5);
    double tau = pow(rho, 1.0 / cos_refracted(cos(radians(degrees)), 1.5));
    return le * (1.0 - r) * (1.0 - r) * tau / (1.0 - r * r * tau * tau);
}
static const char through_tinted_slab_is[] = "Le (1 - R)^2 tau / (1 - R^2 tau^2)";

// Returns the radiance through a ball of radius 1 along a line that passes its centre at the
// distance b.
static double through_ball_of_fog(double rho, double le, double b)
{
    return le * pow(rho, 2.0 * sqrt(1.0 - b * b));
}
static const char through_ball_of_fog_is[] = "Le exp(-2 sigma sqrt(r^2 - b^2))";

// docs/verification.md, C43: the channels have transmittance 0, 1/2 and 1 at distance 1.
static double through_extremes(double rho, double le, double unused)
{
    (void)unused;
    return rho > 0.6 ? 0.0 : rho > 0.3 ? 0.5 * le : le;
}
static const char through_extremes_is[] = "0, Le / 2 and Le";

// Returns the radiance that the metal METAL, defined below, reflects. rho identifies the channel.
static double metal(double rho, double le, double degrees)
{
    double complex n = rho > 0.6 ? 0.2 + 3.9 * I : rho > 0.3 ? 0.9 + 2.4 * I : 1.5 + 1.9 * I;
    return le * reflectance(degrees, n);
}
static const char metal_is[] = "Le R, with Fresnel's R for a complex index";

static double reflected(double rho, double le, double degrees)
{
    (void)rho;
    return le * reflectance(degrees, 1.5);
}
static const char reflected_is[] = "Le R, with Fresnel's R";

static double half_reflected(double rho, double le, double degrees)
{
    return 0.5 * reflected(rho, le, degrees);
}
static const char half_reflected_is[] = "Le R / 2, with Fresnel's R";

#define GLASS                                                                                      \
    {                                                                                              \
        "slab", JSON({"type" : "dielectric", "ior" : 1.5})                                         \
    }
#define TINTED(n)                                                                                  \
    JSON({                                                                                         \
        "type" : "dielectric",                                                                     \
        "ior" : n,                                                                                 \
        "absorption" : {"color" : [ 0.8, 0.5, 0.2 ], "distance" : 1}                               \
    })
#define METAL                                                                                      \
    JSON({                                                                                         \
        "type" : "conductor",                                                                      \
        "conductor_eta" : [ 0.2, 0.9, 1.5 ],                                                       \
        "conductor_k" : [ 3.9, 2.4, 1.9 ]                                                          \
    })
// GGX with Fresnel reflectance 1; roughness is the square root of alpha.
#define WHITE(roughness)                                                                           \
    {                                                                                              \
        "plate",                                                                                   \
            "{\"type\": \"microfacet\", \"base_color\": [0, 0, 0], \"roughness\": " roughness "}"  \
    }
#define ALPHA_1(choice)                                                                            \
    {                                                                                              \
        "plate",                                                                                   \
            "{\"type\": \"microfacet\", \"base_color\": [0, 0, 0], \"roughness\": 1, " choice "}"  \
    }
#define BY_D                                                                                       \
    {                                                                                              \
        "settings", "{\"normals\": \"ndf\"}"                                                       \
    }
#define MIXED(choice)                                                                              \
    "{\"type\": \"principled\", \"roughness\": 0, \"specular_color\": [0.5, 0.5, 0.5], "           \
    "\"specular_fresnel\": \"mixed\", " choice "}"
// A white base below a mirror with Schlick's reflectance, which is 0 at normal incidence.
#define UNCOUPLED                                                                                  \
    {                                                                                              \
        "plate", "{\"type\": \"microfacet\", \"base_color\": [1, 1, 1], \"roughness\": 0, "        \
                 "\"specular_color\": [0, 0, 0], \"diffuse\": \"uncoupled\"}"                      \
    }
#define FROM(x, z)                                                                                 \
    {                                                                                              \
        "from", "[" x ",0," z "]"                                                                  \
    }
#define AT_45 FROM("0.7071067811865476", "0.7071067811865476")
#define AT_60 FROM("0.8660254037844386", "0.5")
#define AT_80 FROM("0.984807753012208", "0.17364817766693")
#define AT_GRAZING FROM("0.99498743710662", "0.1")
#define BALL(of, x, r)                                                                             \
    "{\"type\":\"sphere\",\"material\":\"" of "\",\"center\":[" x ",0,0],\"radius\":" r "}"
#define ONE_BALL                                                                                   \
    {                                                                                              \
        "bodies", "[" BALL("body", "0", "1") "]"                                                   \
    }
#define OVERLAPPING                                                                                \
    {                                                                                              \
        "bodies", "[" BALL("glass", "0", "1") "," BALL("water", "0.7", "1") "]"                    \
    }
#define NESTED                                                                                     \
    {                                                                                              \
        "bodies", "[" BALL("water", "0", "1") "," BALL("glass", "0.1", "0.8") "," BALL(            \
                      "ice", "0.2", "0.6") "," BALL("air", "-0.4", "0.2") "]"                      \
    }
#define ROUND_ICE_IN_A_BLOCK                                                                       \
    {                                                                                              \
        "bodies", "[{\"type\":\"box\",\"material\":\"water\",\"min\":[-1,-0.7,-0.6],"              \
                  "\"max\":[0.9,0.8,0.7]}," BALL("ice", "0.5", "0.7") "]"                          \
    }

// All estimators give the same results here, because only delta lobes reflect emitters.
// clang-format off
static const struct check_case forms[] = {
    FORM("B16 slab", "slab.json", through_slab, 0, BY_STATISTICS, 0, {GLASS}),
    FORM("B16 slab at 60", "slab.json", through_slab, 60, BY_STATISTICS, 0, {GLASS, AT_60}),
    FORM("B16 slab at 80, reflected", "slab.json", from_slab, 80, BY_STATISTICS, 0,
     {GLASS, AT_80, {"light", "[0, 0, 5]"}}),
    LONG_FORM("B16 two thin sheets at 60", "slab.json", through_sheets, 60, BY_STATISTICS, 0,
     {{"slab", JSON({"type": "dielectric", "ior": 1.5, "thin": true})}, AT_60}),

    FORM("B17 fog", "slab.json", through_fog, 0, WITHOUT_VARIANCE, 0, {{"slab", TINTED(1)}}),
    FORM("B17 fog at 60", "slab.json", through_fog, 60, WITHOUT_VARIANCE, 0,
     {{"slab", TINTED(1)}, AT_60}),
    FORM("B18 tinted slab", "slab.json", through_tinted_slab, 0, BY_STATISTICS, 0,
     {{"slab", TINTED(1.5)}}),
    FORM("B18 tinted slab at 60", "slab.json", through_tinted_slab, 60, BY_STATISTICS, 0,
     {{"slab", TINTED(1.5)}, AT_60}),
    FORM("B19 ball of fog", "media.json", through_ball_of_fog, 0, WITHOUT_VARIANCE, 0,
     {{"body", TINTED(1)}, ONE_BALL, {"fov", "1e-5"}}),
    FORM("B19 ball of fog, at 0.6", "media.json", through_ball_of_fog, 0.6, WITHOUT_VARIANCE, 0,
     {{"body", TINTED(1)}, ONE_BALL, {"fov", "1e-5"}, {"from", "[0.6, 0, 4]"}}),
    FORM("B19 ball of fog, at 0.9", "media.json", through_ball_of_fog, 0.9, WITHOUT_VARIANCE, 0,
     {{"body", TINTED(1)}, ONE_BALL, {"fov", "1e-5"}, {"from", "[0.9, 0, 4]"}}),

    FORM("B20 total reflection, behind", "slab.json", all, 0, EXACT, 0,
     {{"slab", JSON({"type": "dielectric", "ior": 0.5})}, AT_60}),
    FORM("B20 total reflection, in front", "slab.json", all, 1, EXACT, 0,
     {{"slab", JSON({"type": "dielectric", "ior": 0.5})}, AT_60, {"light", "[0, 0, 5]"}}),
    FORM("B20 glass ball", "media.json", all, 1, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, ONE_BALL}),

    // The radiance inside glass of index n is n^2 times that outside.
    FORM("B21 camera in glass", "media.json", all, 2.25, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, ONE_BALL, {"from", "[0.2, 0.1, 0.1]"},
      {"fov", "120"}}),

    // docs/verification.md, A6: 1 - ln 2 for alpha = 1 and normal incidence. The other values are
    // computed by quadrature.
    FORM("B22 GGX, alpha 0.1", "plate.json", all, .98831, BY_STATISTICS, 0,
     {WHITE("0.31622776601683794")}),
    FORM("B22 GGX, alpha 0.1, at 45", "plate.json", all, .98169, BY_STATISTICS, 0,
     {WHITE("0.31622776601683794"), AT_45}),
    FORM("B22 GGX, alpha 0.1, grazing", "plate.json", all, .88345, BY_STATISTICS, 0,
     {WHITE("0.31622776601683794"), AT_GRAZING}),
    FORM("B22 GGX, alpha 0.25, at 60", "plate.json", all, .85726, BY_STATISTICS, 0,
     {WHITE("0.5"), AT_60}),
    FORM("B22 GGX, alpha 0.5", "plate.json", all, .68785, BY_STATISTICS, 0,
     {WHITE("0.7071067811865476")}),
    FORM("B22 GGX, alpha 0.5, grazing", "plate.json", all, .86011, BY_STATISTICS, 0,
     {WHITE("0.7071067811865476"), AT_GRAZING}),
    FORM("B22 GGX, alpha 1", "plate.json", all, .3068528194400547, BY_STATISTICS, 0, {WHITE("1")}),
    FORM("B22 GGX, alpha 1, at 45", "plate.json", all, .37677, BY_STATISTICS, 0,
     {WHITE("1"), AT_45}),
    FORM("B22 GGX, alpha 1, at 60", "plate.json", all, .45069, BY_STATISTICS, 0,
     {WHITE("1"), AT_60}),

    // A thin sheet transmits all light that it does not reflect, about the same microfacet normals,
    // so the total is that of the white plate.
    FORM("B22 thin rough sheet, alpha 0.5", "plate.json", all, .68785, BY_STATISTICS, 0,
     {{"plate", JSON({"type": "dielectric", "thin": true, "roughness": 0.7071067811865476,
                      "compensate": false})}}),
    // For alpha = 1 all microfacet normals are equally likely, with Phong's distribution too: D = 1
    // / pi. At normal incidence the directional albedo is the integral of c / (1 + c) dc = 1 - ln
    // 2, with the masking functions of these cases too.
    FORM("A6a Phong microfacets, alpha 1", "plate.json", all, .3068528194400547, BY_STATISTICS, 0,
     {ALPHA_1(JSON("distribution": "phong"))}),
    FORM("A6a GGX and l.h, alpha 1", "plate.json", all, .3068528194400547, BY_STATISTICS, 0,
     {ALPHA_1(JSON("masking": "lh"))}),
    FORM("A6a GGX and Schlick's masking, alpha 1", "plate.json", all, .3068528194400547,
     BY_STATISTICS, 0, {ALPHA_1(JSON("masking": "schlick_ggx"))}),
    // These lobes are normalised to reflect specular_color at normal incidence.
    FORM("A6a Phong", "plate.json", colored, 1, BY_STATISTICS, 0,
     {{"plate", JSON({"type": "phong", "base_color": [0, 0, 0], "exponent": 10,
                      "specular_color": [0.8, 0.5, 0.2]})}}),
    FORM("A6a Blinn-Phong", "plate.json", colored, 1, BY_STATISTICS, 0,
     {{"plate", JSON({"type": "blinn_phong", "base_color": [0, 0, 0], "exponent": 10,
                      "specular_color": [0.8, 0.5, 0.2]})}}),

    FORM("C20 smooth metal", "plate.json", metal, 0, WITHOUT_VARIANCE, 0, {{"plate", METAL}}),
    FORM("C20 smooth metal at 60", "plate.json", metal, 60, WITHOUT_VARIANCE, 0,
     {{"plate", METAL}, AT_60}),
    FORM("C21 index 1", "media.json", all, 1, EXACT, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1})}, ONE_BALL}),
    FORM("C21 index 1, rough", "media.json", all, 1, EXACT, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1, "roughness": 0.7})}, ONE_BALL}),
    FORM("C21 index 1.0001", "media.json", all, 1, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.0001})}, ONE_BALL}),
    FORM("C21 index 0.67", "media.json", all, 1, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 0.67})}, ONE_BALL}),

    FORM("C22 overlapping balls", "media.json", all, 1, WITHOUT_VARIANCE, 0, {OVERLAPPING}),
    FORM("C22 balls in balls", "media.json", all, 1, WITHOUT_VARIANCE, 0, {NESTED}),
    FORM("C22 ball and block", "media.json", all, 1, WITHOUT_VARIANCE, 0, {ROUND_ICE_IN_A_BLOCK}),
    FORM("C22 camera where both are", "media.json", all, 2.25, WITHOUT_VARIANCE, 0,
     {OVERLAPPING, {"from", "[0.4, 0, 0]"}, {"towards", "[-1, 0, 0]"}, {"fov", "20"}}),
    FORM("C22 camera in the water", "media.json", all, 1.33 * 1.33, WITHOUT_VARIANCE, 0,
     {OVERLAPPING, {"from", "[1.2, 0, 0]"}, {"towards", "[1, 0, 0]"}, {"fov", "20"}}),

    FORM("C43 black, half and clear", "slab.json", through_extremes, 0, WITHOUT_VARIANCE, 0,
     {{"slab", JSON({"type": "dielectric", "ior": 1,
                     "absorption": {"color": [0, 0.5, 1], "distance": 1}})}}),
    FORM("C43 sigma 1e6, ln 2, 1e-9", "slab.json", through_extremes, 0, WITHOUT_VARIANCE, 0,
     {{"slab", JSON({"type": "dielectric", "ior": 1,
                     "extinction": [1e6, 0.6931471805599453, 1e-9]})}}),

    // These cases choose methods other than the defaults.
    LONG_FORM("A6a Phong's exponent 0 is alpha 1", "plate.json", all, .3068528194400547, BY_STATISTICS, 0,
     {{"plate", JSON({"type": "microfacet", "base_color": [0, 0, 0], "distribution": "phong",
                      "phong_exponent": 0})}}),
    // The value is half of the integral of c / (c (1 - k) + k) dc, which is (1 / (1 - k) + k ln(k)
    // / (1 - k)^2) / 2 with k = sqrt(2 / pi).
    LONG_FORM("A6a GGX and Schlick's own masking, alpha 1", "plate.json", all, .2687840285229841,
     BY_STATISTICS, 0, {ALPHA_1(JSON("masking": "schlick"))}),
    // The value is half of the integral, over the cosine, of the rational approximation of G1 at
    // cot(theta), by quadrature. With the bounded G1 the result is at most 1 - ln 2.
    LONG_FORM("A6a GGX and unbounded rational masking, alpha 1", "plate.json", all, .3792765160930264,
     BY_STATISTICS, 0, {ALPHA_1(JSON("masking": "rational_unbounded"))}),
    // At normal incidence the value is 1 - 2 times the integral of (1 - x)^5 (2 x^2 - 1) 4 x dx
    // over the cosine x of the half angle. At a cosine of .1 it is .97900, by quadrature, plus the
    // mirror's .9^5.
    FORM("A6a uncoupled base", "plate.json", all, .9999181118594366, BY_STATISTICS, 0, {UNCOUPLED}),
    FORM("A6a uncoupled base, grazing", "plate.json", all, 1.5694851171966855, BY_STATISTICS, 0,
     {UNCOUPLED, AT_GRAZING}),
    LONG_FORM("B22 GGX, alpha 0.5, normals by D", "plate.json", all, .68785, BY_STATISTICS, 0,
     {WHITE("0.7071067811865476"), BY_D}),
    LONG_FORM("B22 GGX, alpha 0.5, grazing, normals by D", "plate.json", all, .86011, BY_STATISTICS, 0,
     {WHITE("0.7071067811865476"), AT_GRAZING, BY_D}),
    // A dielectric has the specular colour times the exact Fresnel curve; a metal has its colour
    // times Schlick's curve.
    FORM("A6a mixed Fresnel at 60", "plate.json", half_reflected, 60, WITHOUT_VARIANCE, 0,
     {{"plate", MIXED(JSON("base_color": [0, 0, 0]))}, AT_60}),
    FORM("A6a mixed Fresnel of a metal at 60", "plate.json", all, .403125, WITHOUT_VARIANCE, 0,
     {{"plate", MIXED(JSON("base_color": [0.8, 0.8, 0.8], "metallic": 1))}, AT_60}),
    FORM("A6a exact coat at 60", "plate.json", reflected, 60, WITHOUT_VARIANCE, 0,
     {{"plate", JSON({"type": "principled", "base_color": [0, 0, 0], "specular_weight": 0,
                      "clearcoat": 1, "clearcoat_roughness": 0, "coat_fresnel": "exact"})}, AT_60}),

    // Without the factor for refraction, radiance is the same inside and outside, and light that
    // enters leaves unchanged.
    FORM("A6a camera in glass, not scaled", "media.json", all, 1, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, ONE_BALL, {"from", "[0.2, 0.1, 0.1]"},
      {"fov", "120"}, {"settings.radiance_scaling", "false"}}),
    FORM("A6a camera in rough glass, not scaled", "media.json", all, 1, BY_STATISTICS, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5, "roughness": 0.5})}, ONE_BALL,
      {"from", "[0.2, 0.1, 0.1]"}, {"settings.radiance_scaling", "false"}}),
    LONG_FORM("A6a camera in principled glass, not scaled", "media.json", all, 1, BY_STATISTICS, 0,
     {{"body", JSON({"type": "principled", "base_color": [1, 1, 1], "transmission": 1,
                     "roughness": 0.5})}, ONE_BALL,
      {"from", "[0.2, 0.1, 0.1]"}, {"settings.radiance_scaling", "false"}}),
    FORM("A6a glass ball, not scaled", "media.json", all, 1, WITHOUT_VARIANCE, 0,
     {{"body", JSON({"type": "dielectric", "ior": 1.5})}, ONE_BALL,
      {"settings.radiance_scaling", "false"}}),
};
// clang-format on

CHECK_GROUP(check_media, "media", "glass, fog and metals whose radiance is known", forms);
