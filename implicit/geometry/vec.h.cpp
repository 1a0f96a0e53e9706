#include "../../../work/main/implicit/geometry/vec.h"
#include "../../../work/main/implicit/geometry/vec.h"
