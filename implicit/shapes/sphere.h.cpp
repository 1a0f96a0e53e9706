#include "../../../work/main/implicit/shapes/sphere.h"
#include "../../../work/main/implicit/shapes/sphere.h"
