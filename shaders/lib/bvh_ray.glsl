// Prepares a ray for box tests.
#ifndef BVH_RAY_GLSL
#define BVH_RAY_GLSL

struct bvh_ray {
    vec3 origin;
    vec3 inverse; // 1 / direction, finite
    bvec3 negative;
};

bvh_ray bvh_ray_create(vec3 origin, vec3 direction)
{
    // The minimum absolute value of a direction's components. Replacing smaller ones moves the ray
    // by less than the tests' margin over any distance in a scene of floats, and the product of its
    // reciprocal and a coordinate is finite.
    const float smallest = 1e-18;
    vec3 d = mix(direction, mix(vec3(smallest), vec3(-smallest), lessThan(direction, vec3(0.0))),
                 lessThan(abs(direction), vec3(smallest)));
    return bvh_ray(origin, 1.0 / d, lessThan(d, vec3(0.0)));
}

#endif
