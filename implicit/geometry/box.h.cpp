#include "../../../work/main/implicit/geometry/box.h"
#include "../../../work/main/implicit/geometry/box.h"
