// Defines the parameters, flags and textures of materials, for C and GLSL.
#ifndef LAMPYRIS_SHARED_MATERIAL_H
#define LAMPYRIS_SHARED_MATERIAL_H

// The models of materials.
#define MATERIAL_LAMBERT 0u     // two-sided
#define MATERIAL_MIRROR 1u      // perfect mirror of reflectance base_color, two-sided
#define MATERIAL_PRINCIPLED 2u  // Burley 2012 and 2015, with the layers of glTF's extensions
#define MATERIAL_DIELECTRIC 3u  // smooth, rough or thin, with one index of refraction
#define MATERIAL_CONDUCTOR 4u   // smooth or rough, with a complex index (eta, k) for each channel
#define MATERIAL_PHONG 5u       // Lambert + modified Phong (Lafortune and Willems 1994)
#define MATERIAL_BLINN_PHONG 6u // Lambert + normalised Blinn-Phong
// Lambert + Cook-Torrance / Torrance-Sparrow with selectable D, G and F.
#define MATERIAL_MICROFACET 7u
#define MATERIAL_MODEL_COUNT 8u
#define MATERIAL_MODEL_MASK 0xfu

// Flags, in the same word as the model.
#define MATERIAL_ALPHA_MASK (1u << 4)  // opaque if opacity >= alpha_cutoff, else absent
#define MATERIAL_ALPHA_BLEND (1u << 5) // exists with probability `opacity`
#define MATERIAL_THIN (1u << 6)        // thin-walled: a sheet without an inside
// The clearcoat is GGX with clearcoat_roughness and full strength (glTF), not GTR1 with
// clearcoat_gloss and a quarter of the strength (Burley).
#define MATERIAL_COAT_GGX (1u << 7)
#define MATERIAL_UNLIT (1u << 8) // emits to rays that hit it; no shadow rays are sent to it
// Reflection is compensated for the energy of multiple scattering.
#define MATERIAL_COMPENSATE (1u << 9)
// Smith's masking-shadowing is separable instead of height-correlated.
#define MATERIAL_SEPARABLE (1u << 10)
#define MATERIAL_NORMAL_MAP (1u << 11) // one of the material's textures is a normal map
#define MATERIAL_MEDIUM (1u << 12)     // encloses a medium: closed, refracting or absorbing
#define MATERIAL_EMITS (1u << 13)      // emission may be above zero somewhere
// Every crossing tints by base_color (glTF), not by its square root.
#define MATERIAL_TINT_EACH (1u << 14)
// Layers are combined as in glTF's appendix B, not as by Burley: a Lambertian base, no colour in
// the light below the interface, coat over fibres.
#define MATERIAL_GLTF_LAYERS (1u << 15)
// Options of MATERIAL_MICROFACET.
#define MATERIAL_DISTRIBUTION_SHIFT 16 // 2 bits
#define DISTRIBUTION_GGX 0u
#define DISTRIBUTION_BECKMANN 1u
#define DISTRIBUTION_PHONG 2u
#define DISTRIBUTION_COUNT 3u
#define MATERIAL_MASKING_SHIFT 18 // 3 bits
#define MASKING_SMITH                                                                              \
    0u                         // Smith's masking of the distribution (exact for GGX and
                               // Beckmann)
#define MASKING_SCHLICK_GGX 1u // k = alpha / 2
#define MASKING_LH 2u          // G / (4 n.l n.v) ~ 1 / (4 (l.h)^2), Kelemen and Szirmay-Kalos 2001
// Walter et al. 2007: Beckmann's rational G1; Phong's through a = sqrt(alpha_p / 2 + 1) /
// tan(theta).
#define MASKING_RATIONAL 3u
#define MASKING_SCHLICK 4u            // k = alpha sqrt(2 / pi), Schlick 1994
#define MASKING_SCHLICK_REMAPPED 5u   // k = (roughness + 1)^2 / 8, Karis 2013
#define MASKING_RATIONAL_UNBOUNDED 6u // the rational G1 for any distribution; may gain energy
#define MASKING_COUNT 7u
// The reflectance follows from Fresnel's equations and ior instead of Schlick's approximation.
#define MATERIAL_EXACT_FRESNEL (1u << 21)
// The base is weighted by 1 - F(wo.h) instead of 1 - F of both directions.
#define MATERIAL_UNCOUPLED (1u << 22)
// The reflectance mixes Fresnel's equations and Schlick's approximation by metallic, times the
// specular colour.
#define MATERIAL_MIXED_FRESNEL (1u << 23)
// The coat's Fresnel reflectance is exact for index 1.5, not Schlick's.
#define MATERIAL_EXACT_COAT (1u << 24)
// Kernels set these to restrict a material to a part of its lobes: see lib/split.glsl.
#define MATERIAL_DIFFUSE_PART (1u << 30)
#define MATERIAL_SPECULAR_PART (1u << 31)

// Parameters are in groups of four, so that the RGBA of one texture can scale one group. The number
// of a parameter is 4 * group + component. scene/core/scene_material.h documents ranges, units and
// defaults.
#define GROUP_BASE 0         // base colour; opacity
#define GROUP_EMISSION 1     // radiance, W/(sr m^2); pick density (see PARAMETER_PICK_DENSITY)
#define GROUP_METAL 2        // anisotropic, roughness, metallic, anisotropic rotation (turns)
#define GROUP_SPECULAR 3     // specular colour; specular weight
#define GROUP_INTERFACE 4    // transmission, ior, specular, specular tint
#define GROUP_CLEARCOAT 5    // clearcoat, clearcoat roughness, clearcoat gloss, normal scale
#define GROUP_SHEEN 6        // sheen colour; sheen roughness (glTF, Charlie)
#define GROUP_DIFFUSE 7      // subsurface, sheen, sheen tint (Burley), diffuse transmission
#define GROUP_FILM 8         // iridescence, film thickness (nm), film ior, dispersion (20 / Abbe)
#define GROUP_CONDUCTOR 9    // eta; exponent of Phong and Blinn-Phong
#define GROUP_CONDUCTOR_K 10 // k; alpha cutoff
#define GROUP_COUNT 11

#define PARAMETER_BASE_COLOR 0
#define PARAMETER_OPACITY 3
#define PARAMETER_EMISSION 4
// Density per unit of area with which next-event estimation selects a point on an emitter of this
// material: luminance / sum over all emitters of (luminance * area), where a delta light
// contributes its power over 2 pi. 0: never selected. The density is set at upload.
#define PARAMETER_PICK_DENSITY 7
#define PARAMETER_ANISOTROPIC 8
#define PARAMETER_ROUGHNESS 9
#define PARAMETER_METALLIC 10
#define PARAMETER_ANISOTROPIC_ROTATION 11
#define PARAMETER_SPECULAR_COLOR 12
#define PARAMETER_SPECULAR_WEIGHT 15
#define PARAMETER_TRANSMISSION 16
#define PARAMETER_IOR 17
#define PARAMETER_SPECULAR 18
#define PARAMETER_SPECULAR_TINT 19
#define PARAMETER_CLEARCOAT 20
#define PARAMETER_CLEARCOAT_ROUGHNESS 21
#define PARAMETER_CLEARCOAT_GLOSS 22
#define PARAMETER_NORMAL_SCALE 23
#define PARAMETER_SHEEN_COLOR 24
#define PARAMETER_SHEEN_ROUGHNESS 27
#define PARAMETER_SUBSURFACE 28
#define PARAMETER_SHEEN 29
#define PARAMETER_SHEEN_TINT 30
#define PARAMETER_DIFFUSE_TRANSMISSION 31
#define PARAMETER_IRIDESCENCE 32
#define PARAMETER_FILM_THICKNESS 33
#define PARAMETER_FILM_IOR 34
#define PARAMETER_DISPERSION 35
#define PARAMETER_CONDUCTOR_ETA 36
#define PARAMETER_EXPONENT 39
#define PARAMETER_CONDUCTOR_K 40
#define PARAMETER_ALPHA_CUTOFF 43
#define PARAMETER_COUNT 44

// Delta lights.
#define LIGHT_POINT 0u
#define LIGHT_SPOT 1u
#define LIGHT_DIRECTIONAL 2u

// Classes of surfaces by the cost of shading; each has its own queue and kernel.
#define CLASS_DIFFUSE 0u      // Lambert, mirror
#define CLASS_PRINCIPLED 1u   // principled without transmission
#define CLASS_TRANSMISSIVE 2u // dielectrics, principled with transmission
#define CLASS_CLASSICAL 3u    // Phong, Blinn-Phong, microfacet, conductor
#define CLASS_COUNT 4u

// Lobes of lib/bsdf.glsl that a class, or all materials, need: bits of the constant LOBES.
#define LOBE_LAMBERT (1u << 0)
#define LOBE_MIRROR (1u << 1)
#define LOBE_PRINCIPLED (1u << 2) // diffuse and specular reflection
#define LOBE_METAL (1u << 3)      // metallic > 0 somewhere
#define LOBE_SUBSURFACE (1u << 4)
#define LOBE_SHEEN (1u << 5)   // Burley's sheen
#define LOBE_CHARLIE (1u << 6) // glTF's sheen
#define LOBE_CLEARCOAT (1u << 7)
#define LOBE_TRANSMISSION (1u << 8) // transmission of the principled model
#define LOBE_DIELECTRIC (1u << 9)
#define LOBE_CONDUCTOR (1u << 10)
#define LOBE_PHONG (1u << 11)
#define LOBE_BLINN_PHONG (1u << 12)
#define LOBE_MICROFACET (1u << 13)
#define LOBE_ROUGH (1u << 14) // some specular lobe is not a delta lobe
#define LOBE_DELTA (1u << 15) // some specular lobe is a delta lobe
#define LOBE_ANISOTROPIC (1u << 16)
#define LOBE_COMPENSATE (1u << 17)
#define LOBE_THIN (1u << 18)
#define LOBE_IRIDESCENCE (1u << 19)
#define LOBE_DISPERSION (1u << 20)
#define LOBE_DIFFUSE_TRANSMISSION (1u << 21)
#define LOBE_SEPARABLE (1u << 22)
#define LOBE_BURLEY (1u << 23)    // principled, with layers combined as by Burley
#define LOBE_GLTF (1u << 24)      // principled, with layers combined as in glTF
#define LOBE_MASKINGS (1u << 25)  // microfacets with MASKING_SCHLICK or a greater MASKING_*
#define LOBE_UNCOUPLED (1u << 26) // microfacets with MATERIAL_UNCOUPLED
#define LOBE_MIXED_FRESNEL (1u << 27)
#define LOBE_EXACT_COAT (1u << 28)
#define LOBE_END (1u << 29)
// Models that have both diffuse and specular lobes.
#define LOBES_OF_TWO_PARTS (LOBE_PRINCIPLED | LOBE_PHONG | LOBE_BLINN_PHONG | LOBE_MICROFACET)
// Lobes that may transmit light through a surface.
#define LOBES_THROUGH (LOBE_TRANSMISSION | LOBE_DIELECTRIC | LOBE_DIFFUSE_TRANSMISSION)

// The values of 8-bit codes: see lib/texture.glsl.
#define CODE_UNIT (1.0f / 255.0f)
#define SRGB_TOE (1.0f / (255.0f * 12.92f)) // for codes below SRGB_CURVE_FROM
#define SRGB_CURVE_FROM 11.0f
#define SRGB_CURVE_0 8.619871805422008e-4f
#define SRGB_CURVE_1 1.3757377746514976e-4f
#define SRGB_CURVE_2 7.501581421820447e-6f
#define SRGB_CURVE_3 5.110105760763872e-8f
#define SRGB_CURVE_4 -1.898783630327472e-10f
#define SRGB_CURVE_5 7.232788044701788e-13f
#define SRGB_CURVE_6 -1.7231145717973317e-15f
#define SRGB_CURVE_7 1.7945776447156848e-18f

// The way in which a texture is read: bits of gpu_texture.flags.
#define TEXTURE_WRAP_REPEAT 0u
#define TEXTURE_WRAP_CLAMP 1u
#define TEXTURE_WRAP_MIRROR 2u
#define TEXTURE_WRAP_S_SHIFT 0 // 2 bits
#define TEXTURE_WRAP_T_SHIFT 2 // 2 bits
#define TEXTURE_NEAREST (1u << 4)
#define TEXTURE_UV1 (1u << 5)   // the second UV set
#define TEXTURE_FLOAT (1u << 6) // texels of four floats, else of four 8-bit codes
// For images of codes. TEXTURE_SRGB: red, green and blue are sRGB-encoded. TEXTURE_GREEN: green is
// replaced by transform[0][3] + transform[1][3] * green.
#define TEXTURE_SRGB (1u << 7)
#define TEXTURE_GREEN (1u << 10)
// The texture's use.
#define TEXTURE_USE_SHIFT 8       // 2 bits
#define TEXTURE_USE_SCALE 0u      // scales the parameters of a group
#define TEXTURE_USE_NORMAL 1u     // tangent-space normal map, (rgb * 2 - 1), scaled by normal_scale
#define TEXTURE_USE_ANISOTROPY 2u // glTF: (rg * 2 - 1) is the direction, b the strength
#define TEXTURE_GROUP_SHIFT 12    // 4 bits
#define TEXTURE_MASK_SHIFT 16     // 4 bits: which parameters of the group are scaled
#define TEXTURE_INVERT_SHIFT 20   // 4 bits: scales 1 - parameter instead
// 4 x 2 bits: the channel of the texture that scales each parameter.
#define TEXTURE_CHANNELS_SHIFT 24

#endif
