#include "../../../work/main/implicit/ray_cast.h"
#include "../../../work/main/implicit/ray_cast.h"
