// Debian's libvulkan-volk-dev contains source code only; this file compiles it.
#define VOLK_IMPLEMENTATION
#include <volk.h>
