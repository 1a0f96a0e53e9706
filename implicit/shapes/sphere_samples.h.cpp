#include "../../../work/main/implicit/shapes/sphere_samples.h"
#include "../../../work/main/implicit/shapes/sphere_samples.h"
