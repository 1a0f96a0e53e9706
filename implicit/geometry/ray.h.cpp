#include "../../../work/main/implicit/geometry/ray.h"
#include "../../../work/main/implicit/geometry/ray.h"
