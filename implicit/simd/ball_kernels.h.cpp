#include "../../../work/main/implicit/simd/ball_kernels.h"
#include "../../../work/main/implicit/simd/ball_kernels.h"
