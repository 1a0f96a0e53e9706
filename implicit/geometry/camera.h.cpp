#include "../../../work/main/implicit/geometry/camera.h"
#include "../../../work/main/implicit/geometry/camera.h"
