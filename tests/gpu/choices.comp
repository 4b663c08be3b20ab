// target[i] = source[i] after the steps that CHOICES asks for: what constants choose in every form
// that control flow has. One thread an element.
#version 460
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint CHOICES = 0;

layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Target { uint target[]; };
layout(push_constant) uniform Push { uint count, addend; };

#define CHOSEN(bit) ((CHOICES & (bit)) != 0)

uint sum_of_digits(uint x)
{
    uint sum = 0;
    for (; x > 0; x /= 10)
        sum += x % 10;
    return sum;
}

uint by_case(uint x)
{
    switch (x % 4) {
    case 0:
        return CHOSEN(32) ? x + 1 : x + 2;
    case 1:
    case 2:
        if (CHOSEN(32))
            break;
        return x + 3;
    default:
        x = sum_of_digits(x);
    }
    return x + 4;
}

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count)
        return;
    uint x = source[i];
    if (CHOSEN(1))
        x = sum_of_digits(x);
    if (CHOSEN(2) && x % 2 == 1)
        x += 100;
    if (x % 3 == 0 || CHOSEN(4))
        x ^= 0x55;
    while (CHOSEN(8) && x > 1000)
        x = x / 2 + sum_of_digits(x) % 7;
    if (!CHOSEN(16) || (CHOICES & 3u) == 3u)
        x = by_case(x);
    else if (CHOICES > 60)
        x += 5;
    target[i] = x + addend;
}
