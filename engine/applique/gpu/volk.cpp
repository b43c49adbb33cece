// The one place where volk's functions live.
#define VOLK_IMPLEMENTATION
#include <volk.h>
