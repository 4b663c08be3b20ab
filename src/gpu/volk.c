// Debian's libvulkan-volk-dev is source only: this unit compiles it into our library.
#define VOLK_IMPLEMENTATION
#include <volk.h>
