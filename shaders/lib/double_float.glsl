// Computes sums and products with their rounding errors. A result is an unevaluated sum of two
// floats; x is the float nearest to the value (Dekker 1971; Ogita, Rump and Oishi 2005). All
// functions are pure. `precise` forbids contraction and reordering; together with Vulkan's
// correctly rounded +, - and * the results are exact. Products must stay below 1e34, because
// factors are multiplied by 4097 to split them.
#ifndef DOUBLE_FLOAT_GLSL
#define DOUBLE_FLOAT_GLSL

// Returns a + b and its rounding error (Knuth 1969, theorem B of section 4.2.2).
vec2 exact_sum(float a, float b)
{
    precise float sum = a + b;
    precise float b_part = sum - a;
    precise float lost = (a - (sum - b_part)) + (b - b_part);
    return vec2(sum, lost);
}

// Splits a float into halves of at most 12 bits, whose products are exact (Dekker 1971, section 5).
vec2 split_float(float a)
{
    precise float scaled = 4097.0 * a;
    precise float high = scaled - (scaled - a);
    precise float low = a - high;
    return vec2(high, low);
}

vec2 exact_product(float a, float b)
{
    precise float product = a * b;
    vec2 p = split_float(a);
    vec2 q = split_float(b);
    precise float lost = ((p.x * q.x - product) + p.x * q.y + p.y * q.x) + p.y * q.y;
    return vec2(product, lost);
}

// Adds a term to a sum of several terms (Ogita, Rump and Oishi 2005, algorithm 4.4, without the
// final rounding).
vec2 add_exactly(vec2 sum, vec2 term)
{
    vec2 s = exact_sum(sum.x, term.x);
    precise float lost = s.y + (sum.y + term.y);
    return vec2(s.x, lost);
}

vec2 renormalise(vec2 a)
{
    return exact_sum(a.x, a.y);
}

vec2 multiply(vec2 a, vec2 b)
{
    vec2 p = exact_product(a.x, b.x);
    precise float lost = p.y + (a.x * b.y + a.y * b.x);
    return renormalise(vec2(p.x, lost));
}

// Returns the dot product, with an error of about 2^-46 of its terms.
vec2 dot_exactly(vec3 a, vec3 b)
{
    vec2 sum = exact_product(a.x, b.x);
    sum = add_exactly(sum, exact_product(a.y, b.y));
    return renormalise(add_exactly(sum, exact_product(a.z, b.z)));
}

#endif
